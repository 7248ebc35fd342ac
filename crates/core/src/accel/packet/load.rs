//! Loads the rays of a tile: those of a block whose directions have one sign along each axis.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, mask32x16};

use super::beam::Extents;
use super::columns::first;
use super::{Beam, GROUPS, RayTile, TILE, TileColumn, WIDTH, load, number_of};
use crate::accel::Rays;
use crate::accel::rays::{BLOCK_EDGE, RayLanes};
use crate::math::Lanes;

/// A tile has at least this many rays: fewer share too little. With 12, 28 and 36, mirror rays in
/// rooms took 2 to 14 per cent longer.
pub(super) const FEWEST: u32 = 20;

/// Rays along an edge of a tile.
const TILE_EDGE: usize = 8;

impl RayTile {
    /// Loads rays of the block that starts at `block`, of which some are `left`, a bit each: all, or
    /// those with the signs of the first. Returns them, and whether they are fit for a packet: many,
    /// all valid, with one sign along each axis.
    #[inline(always)]
    pub(super) fn load<S: Lanes>(
        &mut self,
        simd: S,
        rays: &Rays<'_>,
        block: usize,
        left: u64,
    ) -> (u64, bool) {
        let count = rays.count() - block;
        let mut extents = Extents::new(simd);
        for g in 0..GROUPS {
            let first = block + number_of(g * WIDTH);
            let lanes = if count >= TILE {
                rays.block(simd, first, TILE_EDGE)
            } else {
                // Unused lanes repeat the last ray.
                let mut lanes = [rays.ray(block + count - 1); WIDTH];
                for (i, ray) in lanes.iter_mut().enumerate() {
                    *ray = rays.ray(block + number_of(g * WIDTH + i).min(count - 1));
                }
                Rays::Rows(&lanes).block(simd, 0, BLOCK_EDGE)
            };
            self.set(g, &lanes);
            extents.add(&lanes);
        }
        self.has_frame = false;
        self.has_space = 0;
        self.done = 0;
        self.is_left = false;
        self.height = 0;
        self.block = block;
        self.rays = left;
        let mut beam = if left == first(count) { extents.beam() } else { None };
        if beam.is_none() {
            self.rays = self.alike(simd, left);
            if self.rays.count_ones() < FEWEST {
                return (self.rays, false);
            }
            beam = self.repeat(simd);
        }
        self.beam = beam.unwrap_or_default();
        (self.rays, beam.is_some())
    }

    #[inline(always)]
    fn set<S: Lanes>(&mut self, g: usize, lanes: &RayLanes<S>) {
        let &[ox, oy, oz, t_min, dx, dy, dz, t_max] = lanes;
        let (origin, direction) = ([ox, oy, oz], [dx, dy, dz]);
        for k in 0..3 {
            self.origin[k][g] = origin[k].into();
            self.direction[k][g] = direction[k].into();
        }
        self.t_min[g] = t_min.into();
        self.t_max[g] = t_max.into();
    }

    /// Those of `rays` whose directions have the signs of the first one's.
    #[inline(always)]
    fn alike<S: Lanes>(&self, simd: S, rays: u64) -> u64 {
        let mut alike = rays;
        for column in &self.direction {
            let mut negative = 0;
            for g in 0..GROUPS {
                negative |= load(simd, column, g).simd_lt(0.0).to_bitmask() << (g * WIDTH);
            }
            let is_first_negative = negative >> (rays.trailing_zeros() % 64) & 1 == 1;
            alike &= if is_first_negative { negative } else { !negative };
        }
        alike
    }

    /// Puts the first of its rays in the place of those that it has not. Returns the beam of its
    /// rays.
    #[inline(always)]
    fn repeat<S: Lanes>(&mut self, simd: S) -> Option<Beam> {
        let ray = self.ray(self.rays.trailing_zeros() as usize % TILE);
        let mut extents = Extents::new(simd);
        for g in 0..GROUPS {
            let own = mask32x16::from_bitmask(simd, self.rays >> (g * WIDTH) & 0xFFFF);
            let pick = |column: &TileColumn, other: f32| {
                own.select(load(simd, column, g), f32x16::splat(simd, other))
            };
            let ([ox, oy, oz], [dx, dy, dz]) = (&self.origin, &self.direction);
            let (o, d) = (ray.origin, ray.direction);
            let (t_min, t_max) = (pick(&self.t_min, ray.t_min), pick(&self.t_max, ray.t_max));
            let [ox, oy, oz] = [pick(ox, o.x), pick(oy, o.y), pick(oz, o.z)];
            let [dx, dy, dz] = [pick(dx, d.x), pick(dy, d.y), pick(dz, d.z)];
            let lanes = [ox, oy, oz, t_min, dx, dy, dz, t_max];
            self.set(g, &lanes);
            extents.add(&lanes);
        }
        extents.beam()
    }
}
