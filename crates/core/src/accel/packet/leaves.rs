//! A tile at a leaf.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f32x16};
use glam::Vec3;

use super::frame::GroupTest;
use super::tile::OpenPair;
use super::{GROUPS, RayTile, TILE, TileBatch, WIDTH, load, number_of};
use crate::accel::arena::LeafHead;
use crate::accel::{Best, Kind, Query, Ref, Searched, leaf};
use crate::counters::TestCounts;
use crate::geometry::Primitive;
use crate::kernels::Arithmetic;
use crate::kernels::triangle::exact;
use crate::kernels::triangle::settle::{self, Settled};
use crate::math::{LANES, Lanes, Line, Mask, Real, Vector, outlined, set_bits};

/// Up to this many rays are tested one by one, each with eight triangles.
const ALONE: u32 = 6;

impl<S: Lanes, Q: Query, P: Arithmetic> TileBatch<'_, S, Q, P> {
    /// Tests the primitives of the leaf at `place` with `rays` of the tile.
    #[inline(always)]
    pub(super) fn visit_leaf(&mut self, tile: &mut RayTile, place: Ref, rays: u64) {
        self.tests.leaves += u64::from(rays.count_ones());
        let is_closer = if place.kind() == Kind::List {
            self.visit_list(tile, place, rays);
            true
        } else if rays.count_ones() <= ALONE {
            self.test_alone(tile, place, rays)
        } else {
            self.test_together(tile, place, rays)
        };
        if is_closer && Q::NEAREST {
            tile.tighten(self.simd);
        }
    }

    /// Tests the rays one by one. Returns whether any has a closer hit.
    #[inline(always)]
    fn test_alone(&mut self, tile: &mut RayTile, place: Ref, rays: u64) -> bool {
        let arena = self.searched.arena;
        let mut is_closer = false;
        for i in set_bits::<TILE>(rays) {
            let (ray, space) = (tile.ray(i), tile.space(i));
            let mut best = tile.best(i);
            let hits =
                leaf::test::<S, P>(self.simd, arena, (&ray, &space), place, best.high, self.tests);
            let met = hits.certain | hits.open;
            if met == 0 {
                continue;
            }
            let (ray, found) = ((&ray, tile.block + number_of(i)), (place, hits));
            let memory = (&mut *self.tests, &mut *self.query);
            if leaf::take::<S, Q, P>(self.simd, self.searched, ray, found, &mut best, memory) {
                is_closer = true;
                if Q::ANY {
                    tile.done |= 1 << i;
                } else {
                    tile.set_best(i, best);
                }
            }
        }
        is_closer
    }

    /// Tests the rays together. Returns whether any has a closer hit.
    #[inline(always)]
    fn test_together(&mut self, tile: &mut RayTile, place: Ref, rays: u64) -> bool {
        let arena = self.searched.arena;
        let &LeafHead { first, count, quads, .. } = arena.head(place);
        if Q::NEAREST {
            arena.prefetch_numbers(first);
        }
        self.tests.primitives.count_triangles(count, quads, rays.count_ones());
        tile.frame(self.simd);
        let used = leaf::first_lanes(count);
        let prepared = tile.frame.prepare::<S, P>(self.simd, arena, place, used);
        let mut is_closer = false;
        for triangle in set_bits::<LANES>(prepared.some) {
            for g in 0..GROUPS {
                let mut active = rays;
                if Q::ANY {
                    active &= !tile.done;
                }
                let active = (active >> (g * WIDTH)) as u32 & 0xFFFF;
                if active == 0 {
                    continue;
                }
                let group = (g, active);
                let Some(met) = tile.frame.meet::<S, P>(self.simd, &prepared, triangle, group)
                else {
                    continue;
                };
                let at = (g, (place, triangle));
                if Q::ALL {
                    self.cross(tile, at, &met);
                    continue;
                }
                let (has_hits, open) =
                    tile.take::<S, Q, P>(self.simd, self.searched, at, &met, self.tests);
                is_closer |= has_hits;
                for lane in set_bits::<WIDTH>(open) {
                    let ray = g * WIDTH + lane;
                    is_closer |= self.leave_open(tile, ray, (place, triangle));
                }
            }
        }
        is_closer
    }

    /// Gives the query what the rays of the `g`th group cross.
    #[inline(always)]
    fn cross(&mut self, tile: &RayTile, (g, at): (usize, (Ref, usize)), met: &GroupTest<S>) {
        let [certain, open] = tile.within(self.simd, g, met);
        let open = if P::IS_FAST { 0 } else { open };
        let [low, high]: [[f32; WIDTH]; 2] = met.t.map(Into::into);
        for lane in set_bits::<WIDTH>(certain | open) {
            let i = g * WIDTH + lane;
            let ray = (&tile.ray(i), tile.block + number_of(i));
            let t = (certain >> lane & 1 == 1).then_some([low[lane], high[lane]]);
            leaf::cross::<Q, P>(self.searched, ray, (at, t), (self.tests, self.query));
        }
    }

    /// Notes a pair of a ray and a triangle of a leaf that single precision leaves open, and settles
    /// all such pairs once there are enough. Returns whether it did.
    #[inline(always)]
    fn leave_open(&mut self, tile: &mut RayTile, ray: usize, (leaf, entry): (Ref, usize)) -> bool {
        tile.open[tile.open_count % LANES] = OpenPair { ray, leaf, entry };
        tile.open_count += 1;
        tile.open_count == LANES && {
            self.settle(tile);
            true
        }
    }

    /// Decides on the open pairs in double precision, and where that does not suffice in exact
    /// arithmetic.
    #[inline(always)]
    pub(super) fn settle(&mut self, tile: &mut RayTile) {
        let Self { simd, searched, .. } = *self;
        if tile.open_count == 0 {
            return;
        }
        let tests = &mut *self.tests;
        outlined(
            simd,
            #[inline(always)]
            || {
                let pairs = tile.open;
                let pairs = &pairs[..tile.open_count.min(LANES)];
                tests.settled += pairs.len() as u64;
                let arena = searched.arena;
                let zeros = Vector::<f32x8<S>>::splat(simd, Vec3::ZERO);
                let mut line = Line { origin: zeros, direction: zeros };
                let (mut corners, mut range) = ([zeros; 3], [zeros.x; 2]);
                for (lane, &OpenPair { ray, leaf, entry }) in pairs.iter().enumerate().take(LANES) {
                    let ray = tile.ray(ray);
                    line.origin.set_lane(lane, ray.origin);
                    line.direction.set_lane(lane, ray.direction);
                    for (corners, corner) in corners.iter_mut().zip(arena.triangle(leaf, entry)) {
                        corners.set_lane(lane, corner);
                    }
                    range[0].set_lane(lane, ray.t_min);
                    range[1].set_lane(lane, ray.t_max);
                }
                let Settled { t, hit, miss } = settle::settle(&line, &corners, range);
                for (lane, &OpenPair { ray, leaf, entry }) in pairs.iter().enumerate().take(LANES) {
                    let t = if hit >> lane & 1 == 1 {
                        Some(t.lane(lane))
                    } else if miss >> lane & 1 == 1 {
                        None
                    } else {
                        tests.exact += 1;
                        exact::meet(&tile.ray(ray), &arena.triangle(leaf, entry))
                    };
                    if let Some(t) = t {
                        let hit = Best::in_leaf(leaf, entry, [t, t]);
                        tile.offer::<Q, P>(searched, ray, hit, tests);
                    }
                }
                tile.open_count = 0;
            },
        );
    }

    /// Tests the primitives of a list with the rays.
    #[inline(always)]
    fn visit_list(&mut self, tile: &mut RayTile, place: Ref, rays: u64) {
        let Self { simd, searched, tests, query, .. } = self;
        outlined(
            *simd,
            #[inline(always)]
            || {
                let Searched { arena, geometry, .. } = *searched;
                for (entry, &number) in arena.list(place).iter().enumerate() {
                    let at = (place, entry);
                    if Q::ALL {
                        for i in
                            set_bits::<TILE>(tile.meeting::<S, P>(*simd, geometry, number, rays))
                        {
                            let ray = (&tile.ray(i), tile.block + number_of(i));
                            leaf::cross_listed::<Q, P>(searched, ray, (at, number), (tests, query));
                        }
                        continue;
                    }
                    match geometry.primitive(number) {
                        Primitive::Quadric(i) => {
                            let quadric = &geometry.quadrics[i];
                            tile.meet_quadric::<S, Q, P>(*simd, searched, quadric, at, rays, tests);
                        }
                        _ => meet_each::<Q, P>(searched, tile, number, at, rays, tests),
                    }
                }
            },
        );
    }
}

impl RayTile {
    /// Takes the hits of the `g`th group that certainly come first. Returns whether there are any, and the
    /// rays that are not decided, a bit each.
    #[inline(always)]
    fn take<S: Lanes, Q: Query, P: Arithmetic>(
        &mut self,
        simd: S,
        searched: &Searched<'_>,
        (g, at): (usize, (Ref, usize)),
        met: &GroupTest<S>,
        tests: &mut TestCounts,
    ) -> (bool, u32) {
        let GroupTest { t: [low, high], inside, open } = met;
        if Q::ANY {
            let [certain, open] = self.within(simd, g, met);
            let open = if P::IS_FAST { 0 } else { open };
            let certain = self.without_holes::<S, P>(searched, (g, at), certain, *low, tests);
            self.done |= u64::from(certain) << (g * WIDTH);
            return (certain != 0, open);
        }
        // A NaN is neither certain nor beyond, nor is a t that overflows.
        let size = SimdBase::max(SimdBase::abs(*low), SimdBase::abs(*high));
        let finite = size.simd_le(f32::MAX).bits();
        let (t_min, t_max) = (load(simd, &self.t_min, g), load(simd, &self.t_max, g));
        let within = (low.simd_gt(t_min) & high.simd_lt(t_max)).bits();
        let best = [load(simd, &self.low, g), load(simd, &self.high, g)];
        let beyond = (high.simd_le(t_min) | low.simd_gt(best[1])).bits() & finite;
        let closer = inside & within & high.simd_lt(best[0]).bits();
        let open = if P::IS_FAST { 0 } else { (inside | open) & !(closer | beyond) };
        let closer = self.without_holes::<S, P>(searched, (g, at), closer, *low, tests);
        if closer != 0 {
            self.set_group(simd, g, closer, at, [*low, *high]);
        }
        (closer != 0, open)
    }

    /// The rays of the `g`th group that certainly meet a triangle within their ranges, and those that may.
    #[inline(always)]
    fn within<S: Lanes>(
        &self,
        simd: S,
        g: usize,
        GroupTest { t: [low, high], inside, open }: &GroupTest<S>,
    ) -> [u32; 2] {
        let (t_min, t_max) = (load(simd, &self.t_min, g), load(simd, &self.t_max, g));
        let certain = inside & (low.simd_gt(t_min) & high.simd_lt(t_max)).bits();
        // A NaN is not beyond, nor is a t that overflows.
        let size = SimdBase::max(SimdBase::abs(*low), SimdBase::abs(*high));
        let beyond = high.simd_le(t_min) | low.simd_ge(t_max);
        let beyond = (beyond & size.simd_le(f32::MAX)).bits();
        [certain, (inside | open) & !(certain | beyond)]
    }

    /// Those of `hits`, a bit for each ray of the `g`th group, that are not in holes.
    #[inline(always)]
    fn without_holes<S: Lanes, P: Arithmetic>(
        &self,
        searched: &Searched<'_>,
        (g, (leaf, entry)): (usize, (Ref, usize)),
        hits: u32,
        low: f32x16<S>,
        tests: &mut TestCounts,
    ) -> u32 {
        if searched.geometry.cutouts.is_empty() {
            return hits;
        }
        self.opaque::<P>(searched, (g, (leaf, entry)), hits, low.into(), tests)
    }

    /// As [`Self::without_holes`], for a scene with cut-outs.
    #[cold]
    #[inline(never)]
    fn opaque<P: Arithmetic>(
        &self,
        searched: &Searched<'_>,
        (g, (leaf, entry)): (usize, (Ref, usize)),
        hits: u32,
        low: [f32; WIDTH],
        tests: &mut TestCounts,
    ) -> u32 {
        let number = searched.arena.number_of(leaf, entry);
        let Some(cutout) = searched.geometry.cutout(number) else { return hits };
        let mut opaque = 0;
        for lane in set_bits::<WIDTH>(hits) {
            let (ray, t) = (self.ray(g * WIDTH + lane), low[lane]);
            let is_hole = searched.geometry.is_hole_of::<P>(cutout, number, &ray, t, tests);
            opaque |= u32::from(!is_hole) << lane;
        }
        opaque
    }

    /// Updates the beam after closer hits.
    #[inline(always)]
    pub(super) fn tighten<S: Lanes>(&mut self, simd: S) {
        self.beam.reach = super::beam::extent(simd, &self.high, self.rays);
    }
}

/// Tests a primitive of a list with the rays, one by one.
#[cold]
#[inline(never)]
fn meet_each<Q: Query, P: Arithmetic>(
    searched: &Searched<'_>,
    tile: &mut RayTile,
    number: u32,
    (place, entry): (Ref, usize),
    rays: u64,
    tests: &mut TestCounts,
) {
    for i in set_bits::<TILE>(rays) {
        if let Some(t) = searched.geometry.meet::<P>(number, &tile.ray(i), tests) {
            tile.offer::<Q, P>(searched, i, Best::in_leaf(place, entry, [t, t]), tests);
        }
    }
}
