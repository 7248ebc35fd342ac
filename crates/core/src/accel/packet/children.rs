//! Tests the children of nodes against the rays of tiles.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, u32x8};

use super::beam::Met;
use super::tile::{Column, GROUPS, Tile, WIDTH, load};
use super::{TILES_ON_THEIR_WAY, Visit};
use crate::accel::arena::{Kind, Node, Ref, View, child_of};
use crate::accel::node::{distance, place};
use crate::accel::query::Query;
use crate::math::simd::{LANES, Lanes, entry};

/// A child that the beam of a tile meets.
#[derive(Clone, Copy, Debug)]
struct Child {
    /// Its distance, with its number in the lowest bits.
    entry: u64,
    /// The rays that may meet the child.
    rays: u64,
    /// The parent.
    parent: Ref,
    tile: u32,
    /// Whether all of the rays meet it.
    by_all: bool,
}

/// The children met at the current nodes of all tiles: those of each tile from far to near, or for
/// any-hit queries from small to large.
#[derive(Clone, Debug)]
pub(super) struct Children {
    children: [Child; MOST_CHILDREN],
    count: usize,
    leaves: [LeafVisit; MOST_LEAVES],
    leaf_count: usize,
}

/// Largest number of children at a time.
const MOST_CHILDREN: usize = TILES_ON_THEIR_WAY * LANES;

/// Largest number of leaves: children, and as many that waited.
const MOST_LEAVES: usize = 2 * MOST_CHILDREN;

/// Rays of a tile that meet a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafVisit {
    pub(super) place: Ref,
    pub(super) tile: u32,
    pub(super) rays: u64,
}

impl Children {
    const NO_LEAF: LeafVisit = LeafVisit { place: Ref::ROOT, tile: 0, rays: 0 };

    const NO_CHILD: Child = Child { entry: 0, rays: 0, parent: Ref::ROOT, tile: 0, by_all: true };

    pub(super) const NONE: Self = Self {
        children: [Self::NO_CHILD; MOST_CHILDREN],
        count: 0,
        leaves: [Self::NO_LEAF; MOST_LEAVES],
        leaf_count: 0,
    };

    /// Adds the children of a node that the beam of the `k`th tile meets.
    #[inline(always)]
    pub(super) fn add<S: Lanes, Q: Query>(
        &mut self,
        simd: S,
        (tile, k): (&Tile, usize),
        (node, parent): (&Node, Ref),
        rays: u64,
    ) {
        let Met { near, some, all } = tile.beam.children(simd, node);
        let lanes: u32x8<S> = [0, 1, 2, 3, 4, 5, 6, 7].simd_into(simd);
        let mut met = [0; LANES];
        let some = some.to_bitmask() as u8;
        let entries = simd.entries(near, lanes);
        if Q::ANY {
            simd.compress(&entries, some, &mut met);
        } else {
            simd.far_to_near(&entries, some, &mut met);
        }
        let all = all.to_bitmask();
        // Write all eight, so that the processor has no branch to predict.
        if let Some(room) = self.children[self.count..].first_chunk_mut::<LANES>() {
            for (child, entry) in room.iter_mut().zip(met) {
                let by_all = all >> (entry & 7) & 1 == 1;
                *child = Child { entry, rays, parent, tile: k as u32, by_all };
            }
            self.count += some.count_ones() as usize;
        }
    }

    /// Whether there is room for another leaf, not counting those of nodes.
    #[inline(always)]
    pub(super) fn has_room(&self) -> bool {
        self.leaf_count < MOST_LEAVES - MOST_CHILDREN
    }

    /// Adds a leaf that rays of the `k`th tile meet.
    #[inline(always)]
    pub(super) fn add_leaf(&mut self, place: Ref, k: usize, rays: u64) {
        self.leaves[self.leaf_count % MOST_LEAVES] = LeafVisit { place, tile: k as u32, rays };
        self.leaf_count += 1;
    }

    /// The met leaves, each once.
    #[inline(always)]
    pub(super) fn take_leaf(&mut self, i: usize) -> Option<LeafVisit> {
        if i < self.leaf_count {
            return Some(self.leaves[i % MOST_LEAVES]);
        }
        self.leaf_count = 0;
        None
    }

    /// Tests the rays, and queues the met children in their tiles.
    #[inline(always)]
    pub(super) fn visit<S: Lanes, Q: Query>(
        &mut self,
        simd: S,
        tiles: &mut [Tile],
        arena: View<'_>,
    ) {
        for child in &mut self.children[..self.count] {
            if !child.by_all {
                let lane = child.entry as usize & (LANES - 1);
                let node = arena.node(child.parent);
                let tile = &tiles[child.tile as usize];
                child.rays = if tile.beam.has_one_origin {
                    rays_in::<S, true>(simd, tile, node, lane, child.rays)
                } else {
                    rays_in::<S, false>(simd, tile, node, lane, child.rays)
                };
            }
        }
        // Leaves before the nearest node are visited at once, others in their turn: nearer nodes
        // may hide them.
        let mut nearest = [u64::MAX; TILES_ON_THEIR_WAY];
        for child in &mut self.children[..self.count] {
            let lane = child.entry as usize & (LANES - 1);
            let at = child_of(arena.node(child.parent), child.parent, lane);
            let is_met = child.rays != 0;
            arena.prefetch(if is_met { at } else { child.parent });
            child.entry = entry(distance(child.entry), at.bits());
            if is_met & (at.kind() == Kind::Node) {
                nearest[child.tile as usize % TILES_ON_THEIR_WAY] = child.entry;
            }
        }
        for &Child { entry, rays, tile, .. } in &self.children[..self.count] {
            let place = place(entry);
            let is_next = Q::ANY | (entry < nearest[tile as usize % TILES_ON_THEIR_WAY]);
            let is_leaf = (place.kind() != Kind::Node) & is_next;
            let is_met = rays != 0;
            tiles[tile as usize].push(is_met & !is_leaf, Visit { entry, rays });
            self.leaves[self.leaf_count % MOST_LEAVES] = LeafVisit { place, tile, rays };
            self.leaf_count += usize::from(is_met & is_leaf);
        }
        self.count = 0;
    }
}

/// The `rays` that meet the child.
#[inline(always)]
fn rays_in<S: Lanes, const ONE: bool>(
    simd: S,
    tile: &Tile,
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
        let x0 = beyond::<S, ONE>(simd, x_first, tile.beam.near_origin[0], &tile.near_origin[0], g);
        let y0 = beyond::<S, ONE>(simd, y_first, tile.beam.near_origin[1], &tile.near_origin[1], g);
        let z0 = beyond::<S, ONE>(simd, z_first, tile.beam.near_origin[2], &tile.near_origin[2], g);
        let x1 = beyond::<S, ONE>(simd, x_last, tile.beam.far_origin[0], &tile.far_origin[0], g);
        let y1 = beyond::<S, ONE>(simd, y_last, tile.beam.far_origin[1], &tile.far_origin[1], g);
        let z1 = beyond::<S, ONE>(simd, z_last, tile.beam.far_origin[2], &tile.far_origin[2], g);
        let near = (x0 * rx).max(y0 * ry).max((z0 * rz).max(load(simd, &tile.t_min, g)));
        let far = (x1 * rx).min(y1 * ry).min((z1 * rz).min(load(simd, &tile.reach, g)));
        met |= near.simd_le(far).to_bitmask() << (g * WIDTH);
    }
    met & rays
}

/// The distance from each ray's origin to the plane, or from the `ONE` origin of all.
#[inline(always)]
fn beyond<S: Lanes, const ONE: bool>(
    simd: S,
    plane: f32,
    [one, _]: [f32; 2],
    origins: &Column,
    g: usize,
) -> f32x16<S> {
    if ONE {
        return f32x16::splat(simd, plane - one);
    }
    f32x16::splat(simd, plane) - load(simd, origins, g)
}
