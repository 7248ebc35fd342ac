//! Tests the leaves that the rays of a tile meet.

use super::children::LeafVisit;
use super::groups::Open;
use super::tile::{GROUPS, Tile, WIDTH, number_of};
use super::{Batch, TILE};
use crate::accel::arena::{Kind, Ref};
use crate::accel::geometry::{PreparedRay, Primitive};
use crate::accel::query::Query;
use crate::accel::stream::Found;
use crate::accel::tree::{Searched, reach};
use crate::accel::{Hit, TestCounts, leaf};
use crate::kernels::precision::Arithmetic;
use crate::math::simd::{LANES, Lanes, outlined};

/// Up to this many rays are tested one by one.
const ALONE: u32 = 3;

/// From this average number of rays in the tile's groups on, groups are tested without regrouping.
const WHOLE: u32 = 11;

/// The number of groups of a tile with some of `rays`.
#[inline(always)]
fn groups_in(rays: u64) -> u32 {
    let has = |g: usize| u32::from(rays >> (g * WIDTH) & 0xFFFF != 0);
    has(0) + has(1) + has(2) + has(3)
}

/// A ray of a tile to test alone with a patch.
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
        let mut next = 0;
        while let Some(visit) = self.children.take_leaf(next) {
            next += 1;
            if visit.place.kind() == Kind::List {
                self.visit_list(simd, &mut tiles[visit.tile as usize], visit, tests);
            } else {
                self.visit_triangles(simd, tiles, visit, tests);
            }
            tiles[visit.tile as usize].is_reach_stale = true;
        }
        self.test_groups(simd, tiles, tests);
        self.test_singles(simd, tiles, tests);
    }

    /// Queues each of a tile's rays for the triangles of a leaf: in whole groups, regrouped, or
    /// alone.
    #[inline(always)]
    fn visit_triangles<S: Lanes>(
        &mut self,
        simd: S,
        tiles: &mut [Tile],
        LeafVisit { place, tile: k, rays }: LeafVisit,
        tests: &mut TestCounts,
    ) {
        let k = k as usize;
        tests.leaves += u64::from(rays.count_ones());
        if !P::IS_FAST && !tiles[k].is_sheared {
            tiles[k].shear(simd);
        }
        let mut rest = rays;
        // Triangles without shared vertices are sheared separately: eight triangles at a time is
        // as good.
        let alone = if place.kind() == Kind::Patch { ALONE } else { u64::BITS };
        if rest.count_ones() > alone && rest.count_ones() > WHOLE * groups_in(rest) {
            for g in 0..GROUPS {
                let used = (rest >> (g * WIDTH)) as u32 & 0xFFFF;
                if used != 0 {
                    if self.groups.is_full() {
                        self.test_groups(simd, tiles, tests);
                    }
                    self.groups.add_whole(k, place, g, used);
                }
            }
            rest = 0;
        }
        while rest.count_ones() > alone {
            if self.groups.is_full() {
                self.test_groups(simd, tiles, tests);
            }
            let used = rest.count_ones().min(WIDTH as u32);
            let positions = simd.positions(rest);
            self.groups.add(k, place, positions, (1 << used) - 1);
            let last = positions[used as usize - 1];
            rest &= (u64::MAX << (last % u64::BITS)) << 1;
        }
        while rest != 0 {
            let ray = rest.trailing_zeros() as u8;
            rest &= rest - 1;
            self.singles.push(SingleTest { place, tile: k as u8, ray });
        }
    }

    /// Tests the primitives of a list with the rays.
    #[inline(always)]
    fn visit_list<S: Lanes>(
        &mut self,
        simd: S,
        tile: &mut Tile,
        LeafVisit { place, rays, .. }: LeafVisit,
        tests: &mut TestCounts,
    ) {
        outlined(
            simd,
            #[inline(always)]
            || {
                let Searched { tree, geometry, .. } = self.searched;
                tests.leaves += u64::from(rays.count_ones());
                for &number in tree.arena.view().list(place) {
                    if Q::ANY && geometry.is_light(number) {
                        continue;
                    }
                    match geometry.primitive(number) {
                        Primitive::Sphere(_) if !geometry.cutouts.contains(number) => {
                            tests.spheres += u64::from(rays.count_ones());
                            tile.meet_sphere::<S, Q, P>(simd, geometry, number, rays);
                        }
                        _ => self.ask_each(tile, number, rays, tests),
                    }
                }
            },
        );
    }

    /// Tests a primitive with the rays, one by one.
    #[cold]
    #[inline(never)]
    fn ask_each(&self, tile: &mut Tile, number: u32, rays: u64, tests: &mut TestCounts) {
        let mut rest = rays;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize & (TILE - 1);
            rest &= rest - 1;
            let ray = PreparedRay::of::<P>(&self.rays.ray(tile.start + number_of(i)));
            if let Some(t) = self.searched.hit::<P>(number, &ray, tests) {
                tile.offer::<Q, P>(self.searched.geometry, i, Hit { t, primitive: number });
            }
        }
    }

    /// Tests each ray that waits alone with all triangles of its leaf at once.
    #[inline(always)]
    fn test_singles<S: Lanes>(&mut self, simd: S, tiles: &mut [Tile], tests: &mut TestCounts) {
        let arena = self.searched.tree.arena.view();
        // Two loops: the first has no data-dependent branches.
        self.found.resize(self.singles.len().max(self.found.len()), Found::default());
        for (single, found) in self.singles.iter().zip(self.found.iter_mut()) {
            let tile = &tiles[single.tile as usize];
            let i = single.ray as usize;
            let (ray, space) = (tile.ray(i), tile.space(i));
            *found = if single.place.kind() == Kind::Patch {
                let leaf = arena.patch(single.place);
                arena.prefetch_numbers(leaf.first);
                tests.count_triangles(leaf.count, leaf.quads, 1);
                let hits = leaf::test_patch::<S, Q, P>(simd, leaf, &ray, &space);
                Found { hits, first: leaf.first }
            } else {
                let leaf = arena.soup(single.place);
                tests.count_triangles(leaf.count, leaf.quads, 1);
                let hits = leaf::test_soup::<S, Q, P>(simd, leaf, &ray, &space);
                Found { hits, first: leaf.first }
            };
        }
        for n in 0..self.singles.len() {
            let (SingleTest { tile, ray, .. }, found) = (self.singles[n], self.found[n]);
            let (tile, i) = (&mut tiles[tile as usize], ray as usize);
            if Q::ANY {
                let certain = self.searched.without_lights(found.first, found.hits.certain);
                tile.done |= u64::from(certain != 0) << i;
            } else {
                self.take_closest(tile, i, &found);
            }
            if found.hits.open != 0 {
                self.ask_again(tile, (found.first, found.hits.open), i, tests);
            }
        }
        self.singles.clear();
    }

    /// Tests all waiting groups of rays.
    #[inline(always)]
    fn test_groups<S: Lanes>(&mut self, simd: S, tiles: &mut [Tile], tests: &mut TestCounts) {
        outlined(
            simd,
            #[inline(always)]
            || {
                let arena = self.searched.tree.arena.view();
                self.groups.test::<S, Q, P>(simd, self.searched, tiles, self.asks, tests);
                while let Some(Open { tile, place, triangles, ray }) = self.asks.pop() {
                    let first = arena.patch(place).first;
                    self.ask_again(&mut tiles[tile], (first, triangles), ray, tests);
                }
            },
        );
    }

    /// Tests the `i`th ray one by one with the triangles of a leaf whose bits are set in `triangles`;
    /// their numbers start at `first`.
    #[cold]
    #[inline(never)]
    fn ask_again(
        &mut self,
        tile: &mut Tile,
        (first, mut triangles): (u32, u32),
        i: usize,
        tests: &mut TestCounts,
    ) {
        let ray = PreparedRay::of::<P>(&self.rays.ray(tile.start + number_of(i)));
        if Q::ANY {
            triangles = self.searched.without_lights(first, triangles);
        }
        while triangles != 0 {
            let arena = self.searched.tree.arena.view();
            let number = arena.number(first, triangles.trailing_zeros() as usize);
            triangles &= triangles - 1;
            let Some(t) = self.searched.hit_again::<P>(number, &ray, tests) else { continue };
            tile.offer::<Q, P>(self.searched.geometry, i, Hit { t, primitive: number });
            if Q::ANY {
                return;
            }
        }
    }

    /// Gives the tile the closest certain hit of its `i`th ray, if it is closer.
    #[inline(always)]
    fn take_closest(&self, tile: &mut Tile, i: usize, found: &Found) {
        let Found { hits, first } = found;
        let Searched { tree, geometry, .. } = self.searched;
        let arena = tree.arena.view();
        let mut certain = hits.certain;
        let before = tile.best(i);
        let mut best = before;
        while certain != 0 {
            let lane = certain.trailing_zeros() as usize & (LANES - 1);
            certain &= certain - 1;
            let t = hits.t[lane];
            if t <= reach::<P>(before.t) {
                let hit = Hit { t, primitive: arena.number(*first, lane) };
                if geometry.comes_first::<P>(&hit, &best, || tile.ray(i)) {
                    best = hit;
                }
            }
        }
        if best != before {
            tile.set_best::<P>(i, best);
        }
    }
}
