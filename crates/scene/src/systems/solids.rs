//! Solids: what the fronts of shapes enclose whose surfaces refract or absorb light.

use std::cmp::Reverse;

use glam::Vec3;
use rayon::prelude::*;

use super::geometry::ShapeOutput;
use crate::components::SurfaceComponents;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::prepared::{Class, Solid};

/// Assigns solids to shapes. Returns them in the order of priority: as their surfaces ask, of equal ones
/// the smaller box first, so that what is nested in another solid is there. No order in the file counts:
/// at last the denser, and the one that absorbs more.
pub(crate) fn run(
    surfaces: &[SurfaceComponents<'_>],
    classes: &[Class],
    geometry: &Geometry,
    shapes: &mut [ShapeOutput],
) -> Vec<Solid> {
    let mut found = Vec::new();
    for (number, ShapeOutput { shape, .. }) in shapes.iter().enumerate() {
        let Some(solid) = of(&classes[shape.class as usize]) else { continue };
        let priority = surfaces[number].transparency.map_or(0.0, |through| through.priority);
        let boxes = shape.primitives.clone().into_par_iter().map(|i| geometry.bounds(i));
        let Aabb { low, high } = boxes.reduce(|| Aabb::EMPTY, Aabb::union);
        let size = (high - low).as_dvec3().length_squared();
        let Vec3 { x, y, z } = solid.absorption;
        // Of numbers that are not negative, bits have the same order.
        let rest = [solid.ior, x, y, z].map(|value| Reverse((value + 0.0).to_bits()));
        found.push(((0.0 - priority, size), rest, number, solid));
    }
    found.sort_by(|((p, s), a, ..), ((q, t), b, ..)| {
        p.total_cmp(q).then(s.total_cmp(t)).then(a.cmp(b))
    });
    for (index, &(_, _, number, _)) in (0..).zip(&found) {
        shapes[number].shape.solid = Some(index);
    }
    found.into_iter().map(|(.., solid)| solid).collect()
}

/// The solid behind the front of a surface: none behind a thin sheet, nor where nothing tells.
fn of(class: &Class) -> Option<Solid> {
    let through = class.transparency.filter(|through| !through.thin)?;
    let bends = through.kt > 0.0;
    let absorption = through.absorption;
    let ior = if bends { through.ior } else { Solid::AIR.ior };
    (bends || absorption != Vec3::ZERO).then_some(Solid { ior, absorption })
}
