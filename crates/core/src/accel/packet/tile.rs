//! The rays of a tile, in columns.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f32x16, mask32x16, u32x8, u32x16};
use glam::Vec3;

use super::columns::{half, numbers};
use super::frame::Frame;
use super::{Beam, GROUPS, TILE, TileColumn, Visit, WIDTH, load, number_of};
use crate::accel::best::exact_t;
use crate::accel::query::ANY_HIT;
use crate::accel::{ArenaView, Best, Hit, NO_PRIMITIVE, Query, Ref, Searched, widened};
use crate::counters::TestCounts;
use crate::geometry::{Geometry, Primitive, Quadric};
use crate::kernels::triangle::settle;
use crate::kernels::{Arithmetic, ShearedSpace};
use crate::math::{LANES, Lanes, Line, Mask, Ray, Real, Single, Vector, set_bits};

/// A tile's rays, in columns. The order of fields keeps vectors within cache lines.
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub(super) struct RayTile {
    pub(super) origin: [TileColumn; 3],
    pub(super) direction: [TileColumn; 3],
    pub(super) t_min: TileColumn,
    pub(super) t_max: TileColumn,
    pub(super) reciprocal: [TileColumn; 3],
    /// The best hits: see [`Best`].
    pub(super) low: TileColumn,
    pub(super) high: TileColumn,
    pub(super) leaf: [[u32; WIDTH]; GROUPS],
    pub(super) entry: [[u32; WIDTH]; GROUPS],
    /// For triangles, once many rays meet one.
    pub(super) frame: Frame,
    pub(super) has_frame: bool,
    /// For triangles that few rays meet: the space of each ray, once needed, which a bit tells.
    spaces: [[ShearedSpace; WIDTH]; GROUPS],
    pub(super) has_space: u64,
    pub(super) beam: Beam,
    /// Pairs that single precision leaves open, and their number: double precision takes eight at a time.
    pub(super) open: [OpenPair; LANES],
    pub(super) open_count: usize,
    /// The number of the first ray of its block.
    pub(super) block: usize,
    /// The rays of the block that it has, a bit each. The others' columns repeat one of them.
    pub(super) rays: u64,
    /// Rays that are done.
    pub(super) done: u64,
    /// Whether rays continue elsewhere, which takes their t.
    pub(super) is_left: bool,
    /// Places still to visit, the next one last, and their number.
    pub(super) visits: Vec<Visit>,
    pub(super) height: usize,
}

/// A ray of the tile and a triangle of a leaf.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OpenPair {
    pub(super) ray: usize,
    pub(super) leaf: Ref,
    pub(super) entry: usize,
}

impl RayTile {
    /// Clears earlier rays' hits. Not where rays are loaded: many tiles meet nothing.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        (self.low, self.high) = (self.t_max, self.t_max);
        self.leaf = [[Best::NUMBERED; WIDTH]; GROUPS];
        self.entry = [[NO_PRIMITIVE; WIDTH]; GROUPS];
    }

    /// Pushes a place to visit, if `it_is` one.
    #[inline(always)]
    pub(super) fn push(&mut self, it_is: bool, visit: Visit) {
        self.visits[self.height] = visit;
        self.height += usize::from(it_is);
    }

    /// Pops the next place to visit.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Visit> {
        self.height = self.height.checked_sub(1)?;
        Some(self.visits[self.height])
    }

    /// The rays without a hit nearer than `distance`.
    #[inline(always)]
    pub(super) fn reaching<S: Lanes>(&self, simd: S, distance: f32) -> u64 {
        let mut rays = 0;
        for g in 0..GROUPS {
            let high = widened(simd, load(simd, &self.high, g), self.beam.slack);
            let reaching = high.simd_ge(f32x16::splat(simd, distance));
            rays |= reaching.to_bitmask() << (g * WIDTH);
        }
        rays
    }

    /// Whether all rays are done.
    #[inline(always)]
    pub(super) fn is_done(&self) -> bool {
        self.done & self.rays == self.rays
    }

    /// The best hit of the `i`th ray.
    #[inline(always)]
    pub(super) fn best(&self, i: usize) -> Best {
        let (g, l) = (i / WIDTH % GROUPS, i % WIDTH);
        let (leaf, entry) = (self.leaf[g][l], self.entry[g][l]);
        Best { low: self.low[g][l], high: self.high[g][l], leaf, entry }
    }

    #[inline(always)]
    pub(super) fn set_best(&mut self, i: usize, best: Best) {
        let (g, l) = (i / WIDTH % GROUPS, i % WIDTH);
        (self.low[g][l], self.high[g][l]) = (best.low, best.high);
        (self.leaf[g][l], self.entry[g][l]) = (best.leaf, best.entry);
    }

    /// Gives the `i`th ray a hit, unless that is in a hole: any, or one that may come before its
    /// best.
    #[inline(always)]
    pub(super) fn offer<Q: Query, P: Arithmetic>(
        &mut self,
        searched: &Searched<'_>,
        i: usize,
        hit: Best,
        tests: &mut TestCounts,
    ) {
        let ray = self.ray(i);
        if Q::ANY {
            self.done |= u64::from(searched.behind_holes::<P>(&ray, hit, tests).is_some()) << i;
            return;
        }
        let mut best = self.best(i);
        if best.offer::<P>(searched, &ray, hit, tests) {
            self.set_best(i, best);
        }
    }

    /// Tests the quadric of an entry in a list against some `rays`, a bit each, eight at a time.
    #[inline(always)]
    pub(super) fn meet_quadric<S: Lanes, Q: Query, P: Arithmetic>(
        &mut self,
        simd: S,
        searched: &Searched<'_>,
        quadric: &Quadric,
        (place, entry): (Ref, usize),
        rays: u64,
        tests: &mut TestCounts,
    ) {
        quadric.count(tests, rays.count_ones());
        let certain = Q::ANY && searched.geometry.cutouts.is_empty();
        for first in (0..TILE).step_by(LANES) {
            let used = (rays >> first) as u32 & 0xFF;
            if used == 0 {
                continue;
            }
            let (g, l) = (first / WIDTH % GROUPS, first % WIDTH);
            let range = [half(simd, &self.t_min, g, l), half(simd, &self.t_max, g, l)];
            let (t, is_hit) = quadric.meet::<_, P>(&self.line(simd, g, l), range);
            let mut hits = is_hit.bits() & used;
            if certain {
                self.done |= u64::from(hits) << first;
                continue;
            }
            hits &= Real::le(t, half(simd, &self.high, g, l)).bits();
            for lane in set_bits::<LANES>(hits) {
                let hit = Best::in_leaf(place, entry, [t.lane(lane); 2]);
                self.offer::<Q, P>(searched, first + lane, hit, tests);
            }
        }
    }

    /// Those of the `rays` that may cross a primitive of a list, a bit each: not more than meet it.
    #[inline(always)]
    pub(super) fn meeting<S: Lanes, P: Arithmetic>(
        &self,
        simd: S,
        geometry: &Geometry,
        number: u32,
        rays: u64,
    ) -> u64 {
        let Primitive::Quadric(i) = geometry.primitive(number) else { return rays };
        let mut met = 0;
        for first in (0..TILE).step_by(LANES) {
            if (rays >> first) as u32 & 0xFF != 0 {
                let (g, l) = (first / WIDTH % GROUPS, first % WIDTH);
                let range = [half(simd, &self.t_min, g, l), half(simd, &self.t_max, g, l)];
                let (_, is_hit) = geometry.quadrics[i].meet::<_, P>(&self.line(simd, g, l), range);
                met |= u64::from(is_hit.bits()) << first;
            }
        }
        met & rays
    }

    /// Half a group's rays, from `l` on.
    #[inline(always)]
    fn line<S: Lanes>(&self, simd: S, g: usize, l: usize) -> Line<f32x8<S>> {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.origin, &self.direction);
        Line {
            origin: Vector::new(half(simd, ox, g, l), half(simd, oy, g, l), half(simd, oz, g, l)),
            direction: Vector::new(
                half(simd, dx, g, l),
                half(simd, dy, g, l),
                half(simd, dz, g, l),
            ),
        }
    }

    /// Writes one answer for `rays` of its block, a bit each.
    #[inline(always)]
    pub(super) fn fill<A: Copy>(&self, rays: u64, answers: &mut [A], answer: A) {
        if rays == u64::MAX {
            answers[self.block..self.block + TILE].fill(answer);
            return;
        }
        numbers(self.block, rays).for_each(|number| answers[number] = answer);
    }

    /// Answers that some rays of its block, a bit each, have no hit.
    #[inline(always)]
    pub(super) fn miss<Q: Query>(&self, rays: u64, answers: &mut [Q::Answer]) {
        if !Q::ALL {
            self.fill(rays, answers, Q::answer(Hit::MISS));
        }
    }

    /// Writes the answers of its rays.
    #[inline(always)]
    pub(super) fn answer<S: Lanes, Q: Query>(
        &self,
        simd: S,
        &Searched { arena, without_t, .. }: &Searched<'_>,
        answers: &mut [Q::Answer],
        tests: &mut TestCounts,
    ) {
        if Q::ALL {
            return;
        }
        if Q::ANY {
            self.fill(self.rays & self.done, answers, Q::answer(ANY_HIT));
            self.miss::<Q>(self.rays & !self.done, answers);
            return;
        }
        for first in (0..TILE).step_by(LANES) {
            let (t, finished) = if without_t && !self.is_left {
                (half(simd, &self.high, first / WIDTH % GROUPS, first % WIDTH).into(), 0)
            } else {
                self.finished(simd, arena, first)
            };
            tests.finished += u64::from(finished.count_ones());
            for (lane, &t) in t.iter().enumerate() {
                let i = first + lane;
                if self.rays >> i & 1 == 1 {
                    let hit = Hit { t, primitive: self.best(i).number(arena) };
                    let answer = if hit.is_miss() { Hit::MISS } else { hit };
                    answers[self.block + number_of(i)] = Q::answer(answer);
                }
            }
        }
    }

    /// The t of the hits of eight rays from the `first`th on, and those that lacked it, a bit each.
    #[inline(always)]
    fn finished<S: Lanes>(
        &self,
        simd: S,
        arena: ArenaView<'_>,
        first: usize,
    ) -> ([f32; LANES], u32) {
        let (g, l) = (first / WIDTH % GROUPS, first % WIDTH);
        let t = half(simd, &self.low, g, l);
        let open = t.simd_ne(half(simd, &self.high, g, l)).bits();
        if open == 0 {
            return (t.into(), 0);
        }
        // Neighbours often share a triangle.
        let leaves = u32x8::from_slice(simd, &self.leaf[g][l..l + LANES]);
        let entries = u32x8::from_slice(simd, &self.entry[g][l..l + LANES]);
        let mut corners = [Vector::<f32x8<S>>::splat(simd, Vec3::ZERO); 3];
        let mut rest = open;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            let (leaf, entry) = (self.leaf[g][l + lane], self.entry[g][l + lane]);
            let shared = leaves.simd_eq(leaf) & entries.simd_eq(entry);
            rest &= !shared.bits();
            let [a, b, c] = arena.triangle(Ref::from_bits(leaf), entry as usize);
            corners = [
                Vector::select(shared, Vector::splat(simd, a), corners[0]),
                Vector::select(shared, Vector::splat(simd, b), corners[1]),
                Vector::select(shared, Vector::splat(simd, c), corners[2]),
            ];
        }
        let (found, is_known) = settle::t_of::<f32x8<S>>(&self.line(simd, g, l), &corners);
        let mut t: [f32; LANES] = <f32x8<S> as Single>::mask(simd, open).select(found, t).into();
        for lane in set_bits::<LANES>(open & !is_known.bits()) {
            let corners = corners.map(|corner| corner.lane(lane));
            t[lane] = exact_t(&self.ray(first + lane), &corners);
        }
        (t, open)
    }

    /// Computes the reciprocals of directions.
    #[inline(always)]
    pub(super) fn prepare<S: Lanes>(&mut self, simd: S) {
        for (reciprocals, directions) in self.reciprocal.iter_mut().zip(&self.direction) {
            for (g, reciprocal) in reciprocals.iter_mut().enumerate() {
                *reciprocal = (f32x16::splat(simd, 1.0) / load(simd, directions, g)).into();
            }
        }
    }

    /// The sheared space of the `i`th ray.
    #[inline(always)]
    pub(super) fn space(&mut self, i: usize) -> ShearedSpace {
        let i = i % TILE;
        if self.has_space >> i & 1 == 0 {
            self.has_space |= 1 << i;
            self.spaces.as_flattened_mut()[i] = ShearedSpace::new(&self.ray(i));
        }
        self.spaces.as_flattened()[i]
    }

    /// The `i`th ray.
    #[inline(always)]
    pub(super) fn ray(&self, i: usize) -> Ray {
        let (g, l) = (i / WIDTH % GROUPS, i % WIDTH);
        let at = |[x, y, z]: &[TileColumn; 3]| Vec3::new(x[g][l], y[g][l], z[g][l]);
        Ray {
            origin: at(&self.origin),
            t_min: self.t_min[g][l],
            direction: at(&self.direction),
            t_max: self.t_max[g][l],
        }
    }

    /// The frame of the tile, which is computed at the first call.
    #[inline(always)]
    pub(super) fn frame<S: Lanes>(&mut self, simd: S) {
        if !self.has_frame {
            self.has_frame = true;
            self.frame.set(simd, &self.origin, &self.direction, self.beam.has_one_origin);
        }
    }

    /// Gives rays of the `g`th group, a bit each, the hit on an entry of a leaf, between `low` and
    /// `high`.
    #[inline(always)]
    pub(super) fn set_group<S: Lanes>(
        &mut self,
        simd: S,
        g: usize,
        rays: u32,
        (leaf, entry): (Ref, usize),
        [low, high]: [f32x16<S>; 2],
    ) {
        let g = g % GROUPS;
        let mask = mask32x16::from_bitmask(simd, u64::from(rays));
        let leaves: u32x16<S> = self.leaf[g].simd_into(simd);
        let entries: u32x16<S> = self.entry[g].simd_into(simd);
        self.low[g] = mask.select(low, load(simd, &self.low, g)).into();
        self.high[g] = mask.select(high, load(simd, &self.high, g)).into();
        self.leaf[g] = mask.select(u32x16::splat(simd, leaf.bits()), leaves).into();
        self.entry[g] = mask.select(u32x16::splat(simd, entry as u32), entries).into();
    }
}
