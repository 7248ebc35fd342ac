//! A tile at a node: tests the boxes of its children against the rays.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, u32x8};

use super::beam::MetChildren;
use super::{GROUPS, RayTile, TileColumn, Visit, WIDTH, load};
use crate::accel::node::{entries, push};
use crate::accel::{ArenaView, Node, Query, Ref, child_of, distance, widened};
use crate::math::{LANES, Lanes, entry};

/// Queues the children of the node at `place` that `rays` of the tile meet: the nearest last, or for
/// other queries than the closest hit the largest.
#[inline(always)]
pub(super) fn visit<S: Lanes, Q: Query>(
    simd: S,
    tile: &mut RayTile,
    arena: ArenaView<'_>,
    place: Ref,
    rays: u64,
) {
    let node = arena.node(place);
    let MetChildren { near, some, all } = tile.beam.children(simd, node);
    let lanes: u32x8<S> = [0, 1, 2, 3, 4, 5, 6, 7].simd_into(simd);
    let (met_entries, some) = entries::<S, Q>(simd, (near, some), lanes);
    let mut met = [0; LANES];
    let count = push::<S, Q>(simd, (&met_entries, some), &mut met);
    let all = all.to_bitmask();
    for &child in &met[..count % (LANES + 1)] {
        let lane = child as usize & (LANES - 1);
        let rays = if all >> lane & 1 == 1 {
            rays
        } else if tile.beam.has_one_origin {
            rays_in::<S, true>(simd, tile, node, lane, rays)
        } else {
            rays_in::<S, false>(simd, tile, node, lane, rays)
        };
        let at = child_of(node, place, lane);
        let is_met = rays != 0;
        arena.prefetch(if is_met { at } else { place });
        tile.push(is_met, Visit { entry: entry(distance(child), at.bits()), rays });
    }
}

/// The `rays` that meet the child.
#[inline(always)]
fn rays_in<S: Lanes, const ONE: bool>(
    simd: S,
    tile: &RayTile,
    node: &Node,
    lane: usize,
    rays: u64,
) -> u64 {
    let [nx, ny, nz] = tile.beam.negative;
    let [x, y, z] = &node.planes;
    let (x_first, x_last) = (x[usize::from(nx)][lane], x[usize::from(!nx)][lane]);
    let (y_first, y_last) = (y[usize::from(ny)][lane], y[usize::from(!ny)][lane]);
    let (z_first, z_last) = (z[usize::from(nz)][lane], z[usize::from(!nz)][lane]);
    let mut met = 0;
    for g in 0..GROUPS {
        if rays >> (g * WIDTH) & 0xFFFF == 0 {
            continue;
        }
        let rx = load(simd, &tile.reciprocal[0], g);
        let ry = load(simd, &tile.reciprocal[1], g);
        let rz = load(simd, &tile.reciprocal[2], g);
        let x0 = beyond::<S, ONE>(simd, x_first, tile.beam.origin[0], &tile.origin[0], g);
        let y0 = beyond::<S, ONE>(simd, y_first, tile.beam.origin[1], &tile.origin[1], g);
        let z0 = beyond::<S, ONE>(simd, z_first, tile.beam.origin[2], &tile.origin[2], g);
        let x1 = beyond::<S, ONE>(simd, x_last, tile.beam.origin[0], &tile.origin[0], g);
        let y1 = beyond::<S, ONE>(simd, y_last, tile.beam.origin[1], &tile.origin[1], g);
        let z1 = beyond::<S, ONE>(simd, z_last, tile.beam.origin[2], &tile.origin[2], g);
        let near = (x0 * rx).max(y0 * ry).max((z0 * rz).max(load(simd, &tile.t_min, g)));
        let far = (x1 * rx).min(y1 * ry).min((z1 * rz).min(load(simd, &tile.high, g)));
        met |= near.simd_le(widened(simd, far, tile.beam.slack)).to_bitmask() << (g * WIDTH);
    }
    met & rays
}

/// The distance from each ray's origin to the plane, or from the `ONE` origin of all.
#[inline(always)]
fn beyond<S: Lanes, const ONE: bool>(
    simd: S,
    plane: f32,
    [one, _]: [f32; 2],
    origins: &TileColumn,
    g: usize,
) -> f32x16<S> {
    if ONE {
        return f32x16::splat(simd, plane - one);
    }
    f32x16::splat(simd, plane) - load(simd, origins, g)
}
