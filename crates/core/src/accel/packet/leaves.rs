//! Leaves, as the rays of a tile meet them.

use super::children::LeafVisit;
use super::groups::Open;
use super::tile::{GROUPS, Tile, WIDTH, number_of};
use super::{Batch, TILE};
use crate::accel::arena::{Kind, Patch, Ref, View};
use crate::accel::geometry::PreparedRay;
use crate::accel::query::Query;
use crate::accel::stream::Found;
use crate::accel::{Hit, TestCounts, leaf};
use crate::kernels::precision::Arithmetic;
use crate::kernels::triangle::fast;
use crate::math::simd::{LANES, Lanes, outlined};

/// So many rays, or fewer, are tested each for itself.
const ALONE: u32 = 5;

/// So many rays on average in the groups of a tile that meet a leaf are tested as they lie.
const WHOLE: u32 = 11;

/// How many groups of a tile have some of `rays`.
#[inline(always)]
fn groups_in(rays: u64) -> u32 {
    let has = |g: usize| u32::from(rays >> (g * WIDTH) & 0xFFFF != 0);
    has(0) + has(1) + has(2) + has(3)
}

/// A ray of a tile that is to be tested alone with a patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct SingleTest {
    place: Ref,
    tile: u8,
    ray: u8,
}

impl<Q: Query, P: Arithmetic> Batch<'_, Q, P> {
    /// Visits the leaves that tiles have met.
    #[inline(always)]
    pub(super) fn visit_leaves<S: Lanes>(
        &mut self,
        simd: S,
        tiles: &mut [Tile],
        tests: &mut TestCounts,
    ) {
        let arena = self.tree.arena.view();
        let mut next = 0;
        while let Some(LeafVisit { place, tile, rays }) = self.children.take_leaf(next) {
            next += 1;
            self.visit_leaf(simd, (tiles, tile as usize), arena, place, rays, tests);
        }
        self.test_groups(simd, tiles, tests);
        self.test_alone(simd, tiles, tests);
    }

    /// Tests the leaf with each of `rays`.
    #[inline(always)]
    pub(super) fn visit_leaf<S: Lanes>(
        &mut self,
        simd: S,
        (tiles, k): (&mut [Tile], usize),
        arena: View<'_>,
        at: Ref,
        rays: u64,
        tests: &mut TestCounts,
    ) {
        outlined(
            simd,
            #[inline(always)]
            || {
                let tile = &mut tiles[k];
                match at.kind() {
                    Kind::Patch => {
                        tests.leaves += u64::from(rays.count_ones());
                        if !P::IS_FAST && !tile.is_sheared {
                            tile.shear(simd);
                        }
                        let mut rest = rays;
                        if rest.count_ones() > ALONE && rest.count_ones() > WHOLE * groups_in(rest)
                        {
                            for g in 0..GROUPS {
                                let used = (rest >> (g * WIDTH)) as u32 & 0xFFFF;
                                if used != 0 {
                                    if self.groups.is_full() {
                                        self.test_groups(simd, tiles, tests);
                                    }
                                    self.groups.add_whole(k, at, g, used);
                                }
                            }
                            rest = 0;
                        }
                        while rest.count_ones() > ALONE {
                            if self.groups.is_full() {
                                self.test_groups(simd, tiles, tests);
                            }
                            let used = rest.count_ones().min(WIDTH as u32);
                            let positions = simd.positions(rest);
                            self.groups.add(k, at, positions, (1 << used) - 1);
                            let last = positions[used as usize - 1];
                            rest &= (u64::MAX << (last % u64::BITS)) << 1;
                        }
                        while rest != 0 {
                            let ray = rest.trailing_zeros() as u8;
                            rest &= rest - 1;
                            self.singles.push(SingleTest { place: at, tile: k as u8, ray });
                        }
                    }
                    _ => {
                        let mut rest = rays;
                        while rest != 0 {
                            let i = rest.trailing_zeros() as usize & (TILE - 1);
                            rest &= rest - 1;
                            let ray =
                                PreparedRay::of::<P>(&self.rays.ray(tile.start + number_of(i)));
                            let mut best = tile.best(i);
                            if leaf::visit::<S, Q, P>(
                                simd,
                                arena,
                                self.geometry,
                                &ray,
                                at,
                                &mut best,
                                tests,
                            ) {
                                if Q::ANY {
                                    tile.set_done(i);
                                } else {
                                    tile.set_best::<P>(i, best);
                                }
                            }
                        }
                    }
                }
                tiles[k].is_reach_stale = true;
            },
        )
    }

    /// Tests all triangles of patches at once with each ray that waits alone.
    #[inline(always)]
    fn test_alone<S: Lanes>(&mut self, simd: S, tiles: &mut [Tile], tests: &mut TestCounts) {
        let arena = self.tree.arena.view();
        // Two loops: the first has no branches that depend on what is found.
        self.found.resize(self.singles.len().max(self.found.len()), Found::default());
        for (single, found) in self.singles.iter().zip(self.found.iter_mut()) {
            let tile = &tiles[single.tile as usize];
            let leaf = arena.patch(single.place);
            arena.prefetch_numbers(leaf.first);
            tests.triangles += u64::from(leaf.count);
            let used = (1 << (leaf.count & 15)) - 1;
            let i = single.ray as usize;
            let (positions, corners) = (&leaf.positions, leaf.corners);
            found.hits = if P::IS_FAST {
                fast::intersect_patch(simd, &tile.ray(i), positions, corners, used)
            } else {
                tile.space(i).intersect_patch(simd, positions, corners, used)
            };
            found.first = leaf.first;
        }
        for n in 0..self.singles.len() {
            let (SingleTest { place, tile, ray }, Found { hits, first }) =
                (self.singles[n], self.found[n]);
            let (tile, i) = (&mut tiles[tile as usize], ray as usize);
            if Q::ANY {
                tile.done |= u64::from(hits.certain != 0) << i;
            } else {
                let mut certain = hits.certain;
                let mut best = tile.best(i);
                let before = best;
                while certain != 0 {
                    let lane = certain.trailing_zeros() as usize & (LANES - 1);
                    certain &= certain - 1;
                    let t = hits.t[lane];
                    if t <= before.t {
                        let number = arena.number(first, lane);
                        if t < best.t || (t == best.t && number < best.primitive) {
                            best = Hit { t, primitive: number };
                        }
                    }
                }
                if best != before {
                    tile.set_best::<P>(i, best);
                }
            }
            if hits.open != 0 {
                self.ask_again(tile, arena, arena.patch(place), hits.open, i);
            }
        }
        self.singles.clear();
    }

    /// Tests all groups of rays that wait.
    #[inline(always)]
    fn test_groups<S: Lanes>(&mut self, simd: S, tiles: &mut [Tile], tests: &mut TestCounts) {
        outlined(
            simd,
            #[inline(always)]
            || {
                let arena = self.tree.arena.view();
                self.groups.test::<S, Q, P>(simd, arena, tiles, self.asks, tests);
                while let Some(Open { tile, place, triangles, ray }) = self.asks.pop() {
                    self.ask_again(&mut tiles[tile], arena, arena.patch(place), triangles, ray);
                }
            },
        );
    }

    /// Tests those of a patch's `triangles`, a bit each, with the `i`th ray, each alone.
    #[cold]
    #[inline(never)]
    fn ask_again(
        &mut self,
        tile: &mut Tile,
        arena: View<'_>,
        leaf: &Patch,
        mut triangles: u32,
        i: usize,
    ) {
        let ray = PreparedRay::of::<P>(&self.rays.ray(tile.start + number_of(i)));
        while triangles != 0 {
            let number = arena.number(leaf.first, triangles.trailing_zeros() as usize);
            triangles &= triangles - 1;
            let Some(t) = self.geometry.hit_again::<P>(number, &ray) else { continue };
            if Q::ANY {
                tile.set_done(i);
                return;
            }
            let best = tile.best(i);
            if t < best.t || (t == best.t && number < best.primitive) {
                tile.set_best::<P>(i, Hit { t, primitive: number });
            }
        }
    }
}
