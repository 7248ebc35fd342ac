//! Solids: what the fronts of shapes enclose whose surfaces refract or absorb light.

use std::cmp::Reverse;

use glam::Vec3;
use hecs::World;

use super::visibility::Source;
use crate::components::Transparency;
use wavecrest_base::parallel;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::prepared::{Class, Shape, Solid};

/// Assigns solids to shapes. Returns them in the order of priority: as their surfaces ask, of equal ones
/// the smaller box first, so that what is nested in another solid is there. No order in the file counts:
/// at last the denser, and the one that absorbs more.
pub(crate) fn run(world: &World, classes: &[Class], geometry: &Geometry) -> Vec<Solid> {
    let transparencies = world.view::<&Transparency>();
    let mut found = Vec::new();
    let mut shapes = world.query::<(&Source, &mut Shape)>();
    for (source, shape) in shapes.iter() {
        let Some(solid) = of(&classes[shape.class as usize]) else { continue };
        let priority = transparencies.get(source.0).map_or(0.0, |through| through.priority);
        let primitives = &shape.primitives;
        let of = |i: usize| geometry.bounds(primitives.start + i as u32);
        let Aabb { low, high } = parallel::reduce(primitives.len(), Aabb::EMPTY, of, Aabb::union);
        let size = (high - low).as_dvec3().length_squared();
        let Vec3 { x, y, z } = solid.absorption;
        // Of numbers that are not negative, bits have the same order.
        let rest = [solid.ior, x, y, z].map(|value| Reverse((value + 0.0).to_bits()));
        found.push(((0.0 - priority, size), rest, &mut shape.solid, solid));
    }
    found.sort_by(|((p, s), a, ..), ((q, t), b, ..)| {
        p.total_cmp(q).then(s.total_cmp(t)).then(a.cmp(b))
    });
    let numbered = (0..).zip(found).map(|(number, (.., of_shape, solid))| {
        *of_shape = Some(number);
        solid
    });
    numbered.collect()
}

/// The solid behind the front of a surface: none behind a thin sheet, nor where nothing tells.
fn of(class: &Class) -> Option<Solid> {
    let through = class.transparency.filter(|through| !through.thin)?;
    let bends = through.kt > 0.0;
    let absorption = through.absorption;
    let ior = if bends { through.ior } else { Solid::AIR.ior };
    (bends || absorption != Vec3::ZERO).then_some(Solid { ior, absorption })
}
