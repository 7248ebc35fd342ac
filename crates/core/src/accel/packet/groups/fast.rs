//! The same for the fast test, which needs no sheared space.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, u32x16};

use super::report::note;
use super::{Pair, PatchRays, Row, row};
use crate::accel::arena::Patch;
use crate::accel::packet::tile::{GROUPS, Tile, WIDTH};
use crate::accel::query::Query;
use crate::accel::tree::Searched;
use crate::kernels::precision::Arithmetic;
use crate::kernels::triangle::fast;
use crate::math::real::Mask;
use crate::math::simd::{LANES, Lanes};
use crate::math::vector::{Line, Vector};

/// As [`super::see`]: the rays themselves, with origins in place of the first vertex and directions
/// in place of the second.
#[inline(always)]
pub(super) fn see<S: Lanes>(simd: S, tile: &Tile, group: &mut PatchRays) {
    let g = group.positions[0] as usize / WIDTH;
    for k in 0..3 {
        let (origin, direction) = (&tile.origin[k], &tile.direction[k]);
        group.vertices[0][k] = row(simd, origin, group, g);
        group.vertices[1][k] = row(simd, direction, group, g);
    }
    group.t_min = row(simd, &tile.t_min, group, g);
    group.t_max = row(simd, &tile.t_max, group, g);
    group.best = row(simd, &tile.best, group, g);
    group.primitive = if group.is_whole {
        tile.primitive[g % GROUPS]
    } else {
        let primitive: u32x16<S> =
            simd.pick(bytemuck::cast_ref(&tile.primitive), group.positions).bitcast();
        primitive.into()
    };
    (group.hit, group.open, group.left) = (0, 0, [0; LANES]);
}

/// As [`super::meet`].
#[inline(always)]
pub(super) fn meet<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    tile: &Tile,
    group: &mut PatchRays,
    pair: Pair,
) {
    let leaf = searched.tree.arena.view().patch(group.place);
    let at = u32::from(4 * pair.triangle) % u32::BITS;
    let [a, b, c] = leaf.corners;
    let a = corner(simd, leaf, a >> at);
    let b = corner(simd, leaf, b >> at);
    let c = corner(simd, leaf, c >> at);
    let [origin, direction, ..] = &group.vertices;
    let line = Line { origin: vector(simd, origin), direction: vector(simd, direction) };
    let (t, inside) = fast::intersect(&line, &[a, b, c]);
    let within = t.simd_gt(group.t_min) & t.simd_lt(group.t_max);
    let hits = (inside & within).bits() & group.used;
    note::<S, Q, P>(simd, searched, tile, group, pair.triangle, (t, hits));
}

/// A vertex of the patch, in each lane.
#[inline(always)]
fn corner<S: Lanes>(simd: S, leaf: &Patch, index: u32) -> Vector<f32x16<S>> {
    let i = index as usize % LANES;
    let [x, y, z] = &leaf.positions;
    Vector::new(f32x16::splat(simd, x[i]), f32x16::splat(simd, y[i]), f32x16::splat(simd, z[i]))
}

#[inline(always)]
fn vector<S: Lanes>(simd: S, [x, y, z]: &[Row; 3]) -> Vector<f32x16<S>> {
    Vector::new((*x).simd_into(simd), (*y).simd_into(simd), (*z).simd_into(simd))
}
