//! Cut-outs: a sheet with an alpha for each texel, some exactly at the threshold.

use std::ops::Range;
use std::sync::Arc;

use glam::{DAffine3, DQuat};

use super::prelude::*;
use wavecrest_core::geometry::cutouts::{Cutout, Cutouts, MeshUvs};
use wavecrest_core::kernels::corners::CornerValues;
use wavecrest_core::kernels::texture::{Filter, Image, LazyImage, PlanarMap, Texels, UvMap, Wrap};

/// Texels along each side of the sheet, whose side has this length.
const TEXELS: usize = 8;

/// Within this distance of the border of a texel, in texels, rounding decides.
const BESIDE: f64 = 1e-3;

/// Worlds of case 45: for each kind without a copy of the sheet in the same place, which has no
/// holes, and with one before or behind it by number; eight times.
pub(super) const WORLDS: usize = 8 * 9;

/// Case 45: a sheet in front of a wall.
pub(super) fn cut_out(numbers: &mut Numbers) -> World {
    // Two triangles with projected coordinates, or with coordinates at their corners, or a quad.
    let [is_mesh, is_quad] = [1, 2].map(|kind| numbers.index % 3 == kind);
    let [is_before, is_behind] = [1, 2].map(|copy| numbers.index / 3 % 3 == copy);
    let turned = DQuat::from_rotation_arc(DVec3::Z, numbers.direction());
    let scale = DVec3::splat(numbers.magnitude(1e-3, 1e3));
    let to_world = DAffine3::from_scale_rotation_translation(scale, turned, DVec3::ZERO);
    let place = move |x, y, z| to_world.transform_point3(DVec3::new(x, y, z)).as_vec3();
    let square = |low: f64, high: f64, z: f64| {
        [place(low, low, z), place(high, low, z), place(high, high, z), place(low, high, z)]
    };
    let side = TEXELS as f64;
    let positions = [square(0.0, side, 0.0), square(-1e3, 1e3, -1.0)].concat();
    let mut geometry = Geometry { positions, ..Geometry::default() };
    let mut add = |first: u32, is_there: bool| -> Range<u32> {
        let start = geometry.triangles.len() as u32;
        let halves = [[0, 1, 2], [0, 2, 3]].map(|half| half.map(|v: u32| v + first));
        geometry.triangles.extend(halves.into_iter().filter(|_| is_there));
        start..geometry.triangles.len() as u32
    };
    let before = add(0, is_before);
    let mut sheet = add(0, !is_quad);
    let behind = add(0, is_behind);
    let wall = add(4, true);
    if is_quad {
        geometry.quads.push([0, 1, 2, 3]);
        sheet = wall.end..wall.end + 1;
    }
    let [origin, u, v] = [place(0.0, 0.0, 0.0), place(side, 0.0, 0.0), place(0.0, side, 0.0)];
    let values = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let uvs = Arc::new(CornerValues { values, indices: None });
    let mesh = is_mesh.then_some(MeshUvs { first_triangle: sheet.start, first_position: 0, uvs });
    let planar = UvMap::Planar(PlanarMap::new(origin, u - origin, v - origin));
    let map = if is_mesh { UvMap::Mesh } else { planar };
    let (image, threshold, solid) = alphas(numbers);
    let (image, primitives) = (Arc::new(image), sheet.clone());
    let (filter, wrap, placing) = (Filter::Nearest, Wrap::Clamp, None);
    let cutout = Cutout { primitives, threshold, image, filter, wrap, map, placing, mesh };
    geometry.cutouts = Cutouts::new(vec![cutout]);
    let copy = [before, behind].into_iter().find(|copy| !copy.is_empty());
    World::new(geometry, move |numbers| {
        // At a texel, or at the shared edge of the sheet's triangles.
        let [x, y] = [(); 2].map(|()| side * numbers.one());
        let y = if numbers.once_in(3) { x } else { y };
        let is_inner = |at: f64| (at - at.round()).abs() > BESIDE;
        // From behind the wall is before the ray.
        let is_behind = numbers.once_in(2);
        let height = if is_behind { 0.5 + 4.0 * numbers.one() } else { -0.9 + 0.8 * numbers.one() };
        let from = place(x + 4.0 * numbers.one(), y - 4.0 * numbers.one(), height);
        // Some end between the sheet and the wall.
        let t_max = numbers.among([1.1, f32::INFINITY]);
        let ray = Ray { t_max, ..Ray::new(from, place(x, y, 0.0) - from) };
        let solid = solid[y as usize * TEXELS + x as usize].then_some(&sheet);
        let first = solid.into_iter().chain(&copy).min_by_key(|primitives| primitives.start);
        let wall = (is_behind && t_max.is_infinite()).then_some(&wall);
        let expected =
            first.or(wall).map_or(ExpectedHit::NOTHING, |all| ExpectedHit::of(all.clone()));
        (is_inner(x) && is_inner(y)).then_some((ray, expected))
    })
}

/// An alpha for each texel: the threshold, or the adjacent number below or above. Returns the
/// threshold and the opaque texels too, by row from the lowest.
fn alphas(numbers: &mut Numbers) -> (LazyImage, f32, Vec<bool>) {
    // From -1 to 1; images start at the top.
    let above: Vec<i8> = (0..TEXELS * TEXELS).map(|_| numbers.below(3) as i8 - 1).collect();
    let rows = above.chunks(TEXELS).rev().flatten();
    let level = 1 + numbers.below(254) as u8;
    let (texels, threshold) = if numbers.once_in(2) {
        let texel = |&above: &i8| [level.saturating_add_signed(above); 4];
        (Texels::Bytes(rows.map(texel).collect()), f32::from(level) / 255.0)
    } else {
        let threshold = numbers.one() as f32;
        let near = [threshold.next_down(), threshold, threshold.next_up()];
        let texel = |&above: &i8| [near[(above + 1) as usize]; 3];
        (Texels::Floats(rows.map(texel).collect()), threshold)
    };
    let decode = move || Ok(Image::new(TEXELS as u32, TEXELS as u32, texels));
    let solid = above.iter().map(|&above| above >= 0).collect();
    (LazyImage::new("alpha".to_owned(), [0; 2], decode), threshold, solid)
}
