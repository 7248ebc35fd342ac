//! What the rays of groups have found, as their tiles keep it.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, mask32x16, u32x16};

use super::PatchRays;
use crate::accel::Hit;
use crate::accel::arena::View;
use crate::accel::geometry::Geometry;
use crate::accel::packet::tile::{GROUPS, Tile, WIDTH, load, reach_of};
use crate::accel::query::Query;
use crate::accel::ties::{are_close, has_doubt};
use crate::kernels::precision::Arithmetic;
use crate::math::real::Mask;
use crate::math::simd::{LANES, Lanes};

/// Notes the rays that `certain`ly meet the triangle, at `t`; those that may meet another at the same are left to the
/// test of one.
#[inline(always)]
pub(super) fn note<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    arena: View<'_>,
    group: &mut PatchRays,
    triangle: u8,
    (t, certain): (f32x16<S>, u32),
) {
    if Q::ANY {
        group.hit |= certain;
        return;
    }
    let leaf = arena.patch(group.place);
    let best: f32x16<S> = group.best.simd_into(simd);
    let primitive: u32x16<S> = group.primitive.simd_into(simd);
    let number = arena.number(leaf.first, usize::from(triangle));
    let (closer, certain) = if has_doubt::<P>() {
        let close = are_close(t, best).bits() & certain;
        group.open |= close;
        group.left[usize::from(triangle) % LANES] |= close;
        (t.simd_lt(best), certain & !close)
    } else {
        (t.simd_lt(best) | (t.simd_eq(best) & primitive.simd_gt(number)), certain)
    };
    let closer = closer & mask32x16::from_bitmask(simd, u64::from(certain));
    group.best = closer.select(t, best).into();
    group.primitive = closer.select(u32x16::splat(simd, number), primitive).into();
    group.hit |= closer.to_bitmask() as u32;
}

/// Gives the tile what the group's rays have found: another group may have found more.
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

/// As [`each`], for a group of the tile itself.
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
