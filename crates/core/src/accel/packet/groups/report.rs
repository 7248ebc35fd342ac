//! Stores the results of groups in their tiles.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, mask32x16, u32x16};

use super::{PatchRays, Row};
use crate::accel::Hit;
use crate::accel::geometry::Geometry;
use crate::accel::packet::tile::{GROUPS, Tile, WIDTH, load, reach_of};
use crate::accel::query::Query;
use crate::accel::ties::{are_close, has_doubt};
use crate::accel::tree::Searched;
use crate::kernels::precision::Arithmetic;
use crate::math::real::Mask;
use crate::math::simd::Lanes;

/// Stores the rays that `certain`ly meet the triangle, at `t`. If rounding may swap two hits,
/// [`Geometry::comes_first`] orders them.
#[inline(always)]
pub(super) fn note<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    tile: &Tile,
    group: &mut PatchRays,
    triangle: u8,
    (t, certain): (f32x16<S>, u32),
) {
    if Q::ANY {
        group.hit |= certain;
        return;
    }
    let arena = searched.tree.arena.view();
    let leaf = arena.patch(group.place);
    let best: f32x16<S> = group.best.simd_into(simd);
    let primitive: u32x16<S> = group.primitive.simd_into(simd);
    let number = arena.number(leaf.first, usize::from(triangle));
    let close = if has_doubt::<P>() { are_close(t, best).bits() & certain } else { 0 };
    let closer = t.simd_lt(best) | (t.simd_eq(best) & primitive.simd_gt(number));
    let closer = closer & mask32x16::from_bitmask(simd, u64::from(certain & !close));
    group.best = closer.select(t, best).into();
    group.primitive = closer.select(u32x16::splat(simd, number), primitive).into();
    group.hit |= closer.to_bitmask() as u32;
    if close != 0 {
        order::<P>(searched.geometry, tile, group, (&t.into(), number), close);
    }
}

/// Gives each of the `close` rays, a bit each, its hit at `t` on triangle `number`, if that comes
/// first.
#[cold]
#[inline(never)]
fn order<P: Arithmetic>(
    geometry: &Geometry,
    tile: &Tile,
    group: &mut PatchRays,
    (t, number): (&Row, u32),
    mut close: u32,
) {
    while close != 0 {
        let lane = close.trailing_zeros() as usize % WIDTH;
        close &= close - 1;
        let new = Hit { t: t[lane], primitive: number };
        let best = Hit { t: group.best[lane], primitive: group.primitive[lane] };
        if geometry.comes_first::<P>(&new, &best, || tile.ray(group.positions[lane] as usize)) {
            (group.best[lane], group.primitive[lane]) = (new.t, new.primitive);
            group.hit |= 1 << lane;
        }
    }
}

/// Gives the group's results to the tile: another group may have found closer hits.
#[inline(always)]
pub(super) fn each<Q: Query, P: Arithmetic>(
    geometry: &Geometry,
    tile: &mut Tile,
    group: &PatchRays,
    mut hit: u32,
) {
    while hit != 0 {
        let lane = hit.trailing_zeros() as usize % WIDTH;
        hit &= hit - 1;
        let i = group.positions[lane] as usize;
        let new = Hit { t: group.best[lane], primitive: group.primitive[lane] };
        tile.offer::<Q, P>(geometry, i, new);
    }
}

/// As [`each`], for a whole group of the tile.
#[inline(always)]
pub(super) fn whole<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    geometry: &Geometry,
    tile: &mut Tile,
    group: &PatchRays,
) {
    let g = group.positions[0] as usize / WIDTH % GROUPS;
    if Q::ANY {
        tile.done |= u64::from(group.hit) << (g * WIDTH);
        return;
    }
    let (old, new) = (load(simd, &tile.best, g), f32x16::from_slice(simd, &group.best));
    let old_primitive: u32x16<S> = tile.primitive[g].simd_into(simd);
    let primitive: u32x16<S> = group.primitive.simd_into(simd);
    let close = if has_doubt::<P>() { are_close(new, old).bits() & group.hit } else { 0 };
    let closer = new.simd_lt(old) | (new.simd_eq(old) & primitive.simd_lt(old_primitive));
    let closer = closer & mask32x16::from_bitmask(simd, u64::from(group.hit & !close));
    let reach = closer.select(reach_of::<S, P>(new), load(simd, &tile.reach, g));
    tile.best[g] = closer.select(new, old).into();
    tile.primitive[g] = closer.select(primitive, old_primitive).into();
    tile.reach[g] = reach.into();
    each::<Q, P>(geometry, tile, group, close);
}
