//! The rays of a tile, in columns.

mod gather;

use std::ops::Range;

use fearless_simd::f32x16;
use fearless_simd::prelude::*;
use glam::Vec3;

use super::beam::{Beam, Extents, longest};
use super::{TILE, Visit};
use crate::accel::geometry::Geometry;
use crate::accel::query::Query;
use crate::accel::rays::{BLOCK_EDGE, Rays};
use crate::accel::tree::{BEYOND, reach};
use crate::accel::{Hit, NO_PRIMITIVE};
use crate::kernels::precision::Arithmetic;
use crate::kernels::slab::PADDING;
use crate::kernels::triangle::lanes::ORDERS;
use crate::kernels::triangle::{Axis, ShearedSpace};
use crate::math::ray::Ray;
use crate::math::simd::Lanes;

/// Rays tested at a time.
pub(super) const WIDTH: usize = 16;

/// Groups of [`WIDTH`] rays in a tile.
pub(super) const GROUPS: usize = TILE / WIDTH;

/// A number for each ray of a tile.
pub(super) type Column = [[f32; WIDTH]; GROUPS];

/// A tile's rays, in columns. The order of fields keeps vectors within cache lines.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Tile {
    pub(super) origin: [Column; 3],
    pub(super) direction: [Column; 3],
    pub(super) t_min: Column,
    pub(super) t_max: Column,
    pub(super) reciprocal: [Column; 3],
    pub(super) near_origin: [Column; 3],
    pub(super) far_origin: [Column; 3],
    pub(super) reach: Column,
    pub(super) best: Column,
    pub(super) primitive: [[u32; WIDTH]; GROUPS],
    /// For triangles, once one is met: the shear of the direction, and 1 over its longest
    /// component.
    pub(super) shear: [Column; 3],
    /// The axis along which every direction is longest.
    pub(super) longest: usize,
    pub(super) is_sheared: bool,
    /// Whether the beam's reach is older than the rays'.
    pub(super) is_reach_stale: bool,
    pub(super) beam: Beam,
    /// The number of its first ray.
    pub(super) start: usize,
    /// How many rays it has.
    count: usize,
    /// Rays that are done.
    pub(super) done: u64,
    /// Places still to visit, the next one last, and their number.
    pub(super) visits: Vec<Visit>,
    height: usize,
}

/// Rays along an edge of a tile.
const TILE_EDGE: usize = 8;

/// The index in a tile's row of groups of ray number `number`, counted row by row: each group is a
/// block of 4 by 4, which meets less than one of 8 by 2.
#[inline(always)]
pub(super) fn index_of(number: usize) -> usize {
    number & 0b100011 | (number & 0b011000) >> 1 | (number & 0b000100) << 2
}

/// The inverse of [`index_of`].
#[inline(always)]
pub(super) fn number_of(index: usize) -> usize {
    index & 0b100011 | (index & 0b001100) << 1 | (index & 0b010000) >> 2
}

impl Tile {
    /// An empty tile.
    pub(super) const EMPTY: Self = {
        let column = [[0.0; WIDTH]; GROUPS];
        Self {
            origin: [column; 3],
            direction: [column; 3],
            t_min: column,
            t_max: column,
            reciprocal: [column; 3],
            near_origin: [column; 3],
            far_origin: [column; 3],
            reach: column,
            best: column,
            primitive: [[NO_PRIMITIVE; WIDTH]; GROUPS],
            shear: [column; 3],
            longest: 0,
            is_sheared: false,
            is_reach_stale: false,
            beam: Beam::EMPTY,
            start: 0,
            count: 0,
            done: 0,
            visits: Vec::new(),
            height: 0,
        }
    };

    /// Loads the rays of `range`, at least one. Returns whether they are fit for a packet: all
    /// valid, with one sign along each axis, and longest along the same axis.
    #[inline(always)]
    pub(super) fn load<S: Lanes, P: Arithmetic>(
        &mut self,
        simd: S,
        rays: &Rays<'_>,
        range: Range<usize>,
    ) -> bool {
        let mut extents = Extents::new(simd);
        for g in 0..GROUPS {
            let first = range.start + number_of(g * WIDTH);
            let block = if range.len() == TILE {
                rays.block(simd, first, TILE_EDGE)
            } else {
                // Unused lanes repeat the last ray.
                let mut block = [rays.ray(range.end - 1); WIDTH];
                for (i, ray) in block.iter_mut().enumerate() {
                    let number = range.start + number_of(g * WIDTH + i);
                    *ray = rays.ray(number.min(range.end - 1));
                }
                Rays::Rows(&block).block(simd, 0, BLOCK_EDGE)
            };
            for k in 0..3 {
                self.origin[k][g] = block.origin[k].into();
                self.direction[k][g] = block.direction[k].into();
            }
            self.t_min[g] = block.t_min.into();
            self.t_max[g] = block.t_max.into();
            extents.add(&block);
        }
        self.is_sheared = false;
        self.is_reach_stale = false;
        self.done = 0;
        self.height = 0;
        (self.start, self.count) = (range.start, range.len());
        let Some(beam) = extents.beam::<P>() else { return false };
        let Some(longest) = longest(beam.reciprocal) else { return false };
        self.longest = longest;
        self.beam = beam;
        true
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
            let reaching = load(simd, &self.reach, g).simd_ge(f32x16::splat(simd, distance));
            rays |= reaching.to_bitmask() << (g * WIDTH);
        }
        rays
    }

    /// All its rays, as bits.
    #[inline(always)]
    pub(super) fn all(&self) -> u64 {
        let mut all = u64::MAX;
        for number in self.count..TILE {
            all &= !(1 << index_of(number));
        }
        all
    }

    #[inline(always)]
    pub(super) fn set_done(&mut self, i: usize) {
        self.done |= 1 << i;
    }

    /// The best hit of the `i`th ray.
    #[inline(always)]
    pub(super) fn best(&self, i: usize) -> Hit {
        let (g, l) = (i / WIDTH, i % WIDTH);
        Hit { t: self.best[g][l], primitive: self.primitive[g][l] }
    }

    #[inline(always)]
    pub(super) fn set_best<P: Arithmetic>(&mut self, i: usize, hit: Hit) {
        let (g, l) = (i / WIDTH, i % WIDTH);
        self.best[g][l] = hit.t;
        self.primitive[g][l] = hit.primitive;
        self.reach[g][l] = reach::<P>(hit.t);
    }

    /// Gives the `i`th ray a hit on `geometry`: any, or one that comes before its best.
    #[inline(always)]
    pub(super) fn offer<Q: Query, P: Arithmetic>(
        &mut self,
        geometry: &Geometry,
        i: usize,
        hit: Hit,
    ) {
        if Q::ANY {
            self.set_done(i);
        } else if geometry.comes_first::<P>(&hit, &self.best(i), || self.ray(i)) {
            self.set_best::<P>(i, hit);
        }
    }

    /// Writes the answers of its rays.
    #[inline(always)]
    pub(super) fn answer<S: Lanes, Q: Query>(&self, simd: S, answers: &mut [Q::Answer]) {
        let answers = &mut answers[self.start..self.start + self.count];
        for (number, row) in answers.chunks_mut(BLOCK_EDGE).enumerate() {
            let i = index_of(number * BLOCK_EDGE);
            let (g, l) = (i / WIDTH % GROUPS, i % WIDTH);
            let (t, primitive) = (&self.best[g][l..], &self.primitive[g][l..]);
            let (Some(t), Some(primitive)) = (t.first_chunk(), primitive.first_chunk()) else {
                continue;
            };
            let done = (self.done >> i) as u32;
            if let Some(row) = row.first_chunk_mut() {
                Q::write(simd, t, primitive, done, row);
            } else {
                let mut whole = [Q::NONE; BLOCK_EDGE];
                Q::write(simd, t, primitive, done, &mut whole);
                row.copy_from_slice(&whole[..row.len()]);
            }
        }
    }

    /// Computes the values that follow from origins, directions and ranges, as
    /// [`crate::kernels::slab::SlabRay::new`] does for one ray.
    #[inline(always)]
    pub(super) fn prepare<S: Lanes, P: Arithmetic>(&mut self, simd: S) {
        let negative = self.beam.negative;
        for g in 0..GROUPS {
            let x = load(simd, &self.origin[0], g);
            let y = load(simd, &self.origin[1], g);
            let z = load(simd, &self.origin[2], g);
            let pad = if P::IS_FAST {
                f32x16::splat(simd, 0.0)
            } else {
                (x.abs().max(y.abs().max(z.abs())) * PADDING).max(f32::MIN_POSITIVE)
            };
            let axes = [x, y, z];
            for k in 0..3 {
                let one = f32x16::splat(simd, 1.0);
                self.reciprocal[k][g] = (one / load(simd, &self.direction[k], g)).into();
                let shift = if negative[k] { -pad } else { pad };
                self.near_origin[k][g] = (axes[k] + shift).into();
                self.far_origin[k][g] = (axes[k] - shift).into();
            }
            let t_max = load(simd, &self.t_max, g);
            self.best[g] = [f32::INFINITY; WIDTH];
            self.reach[g] = reach_of::<S, P>(t_max).into();
            self.primitive[g] = [NO_PRIMITIVE; WIDTH];
        }
    }

    /// Computes `shear` for directions that are longest along the axis `longest`, as
    /// [`crate::kernels::triangle::ShearedSpace::new`] does for one ray.
    #[inline(always)]
    pub(super) fn shear<S: Lanes>(&mut self, simd: S) {
        let [x, y, z] = ORDERS[self.longest.min(2)];
        for g in 0..GROUPS {
            let depth = load(simd, &self.direction[z.min(2)], g);
            self.shear[0][g] = (load(simd, &self.direction[x.min(2)], g) / depth).into();
            self.shear[1][g] = (load(simd, &self.direction[y.min(2)], g) / depth).into();
            self.shear[2][g] = (f32x16::splat(simd, 1.0) / depth).into();
        }
        self.is_sheared = true;
    }

    /// The sheared space of the `i`th ray.
    #[inline(always)]
    pub(super) fn space(&self, i: usize) -> ShearedSpace {
        let longest = self.longest.min(2);
        let [kx, ky, kz] = ORDERS[longest];
        let [x, y, z] = [kx.min(2), ky.min(2), kz.min(2)];
        let (g, l) = (i / WIDTH % GROUPS, i % WIDTH);
        let at = |columns: &[Column; 3], k: usize| columns[k][g][l];
        ShearedSpace::from_turned(
            [Axis::X, Axis::Y, Axis::Z][longest],
            [at(&self.origin, x), at(&self.origin, y), at(&self.origin, z)],
            [at(&self.direction, x), at(&self.direction, y), at(&self.direction, z)],
            [self.shear[0][g][l], self.shear[1][g][l], self.shear[2][g][l]],
            [self.t_min[g][l], self.t_max[g][l]],
        )
    }

    /// The `i`th ray.
    #[inline(always)]
    pub(super) fn ray(&self, i: usize) -> Ray {
        let (g, l) = (i / WIDTH % GROUPS, i % WIDTH);
        let at = |[x, y, z]: &[Column; 3]| Vec3::new(x[g][l], y[g][l], z[g][l]);
        Ray {
            origin: at(&self.origin),
            t_min: self.t_min[g][l],
            direction: at(&self.direction),
            t_max: self.t_max[g][l],
        }
    }
}

/// See [`reach`].
#[inline(always)]
pub(super) fn reach_of<S: Lanes, P: Arithmetic>(t: f32x16<S>) -> f32x16<S> {
    if P::IS_FAST { t } else { t + t.abs() * BEYOND }
}

/// A group's row of a column.
#[inline(always)]
pub(super) fn load<S: Lanes>(simd: S, column: &Column, g: usize) -> f32x16<S> {
    column[g].simd_into(simd)
}
