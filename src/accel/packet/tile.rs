//! The rays of a tile by column, and what bounds them all.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f32x16, mask32x8};

use super::TILE;
use crate::accel::NO_PRIMITIVE;
use crate::accel::arena::Node;
use crate::accel::stream::Rays;
use crate::kernels::slab::PADDING;
use crate::kernels::triangle::T_TOLERANCE;
use crate::kernels::triangle::lanes::ORDERS;
use crate::math::float::{max, min};
use crate::math::simd::{LANES, Lanes};

/// Rays tested at a time.
pub(super) const WIDTH: usize = 16;

/// Groups of [`WIDTH`] rays in a tile.
pub(super) const GROUPS: usize = TILE / WIDTH;

/// A number for each ray of a tile.
pub(super) type Column = [[f32; WIDTH]; GROUPS];

/// A tile's rays, by column.
#[derive(Clone, Debug)]
#[repr(align(64))]
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
    /// For triangles, once one is met: how far the direction leans, and 1 over its longest.
    pub(super) shear: [Column; 3],
    /// The axis along which every direction is longest.
    pub(super) longest: Option<usize>,
    pub(super) is_sheared: bool,
}

/// What bounds all rays of a tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    pub(super) negative: [bool; 3],
    /// Least and greatest.
    pub(super) reciprocal: [[f32; 2]; 3],
    /// The origins from which planes are met earliest, and latest.
    pub(super) near_origin: [f32; 3],
    pub(super) far_origin: [f32; 3],
    pub(super) t_min: f32,
    pub(super) reach: f32,
}

impl Tile {
    /// A tile to be loaded.
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
            longest: None,
            is_sheared: false,
        }
    };

    /// Takes the rays of `range`, at least one; `None` where they are not fit for a packet: not all
    /// valid, or not of one sign along each axis.
    #[inline(always)]
    pub(super) fn load<S: Lanes>(
        &mut self,
        simd: S,
        rays: &(impl Rays + ?Sized),
        range: Range<usize>,
    ) -> Option<Beam> {
        let mut valid = true;
        for g in 0..GROUPS {
            for l in 0..WIDTH {
                // Unused places repeat the last ray.
                let ray = rays.ray((range.start + g * WIDTH + l).min(range.end - 1));
                self.origin[0][g][l] = ray.origin.x;
                self.origin[1][g][l] = ray.origin.y;
                self.origin[2][g][l] = ray.origin.z;
                self.direction[0][g][l] = ray.direction.x;
                self.direction[1][g][l] = ray.direction.y;
                self.direction[2][g][l] = ray.direction.z;
                self.t_min[g][l] = ray.t_min;
                self.t_max[g][l] = ray.t_max;
                valid &= ray.is_valid();
            }
        }
        let x = extent(simd, &self.direction[0]);
        let y = extent(simd, &self.direction[1]);
        let z = extent(simd, &self.direction[2]);
        if !(valid && is_one_sign(x) && is_one_sign(y) && is_one_sign(z)) {
            return None;
        }
        let negative = [x[1] < 0.0, y[1] < 0.0, z[1] < 0.0];
        self.prepare(simd, negative);
        self.longest = longest([x, y, z]);
        self.is_sheared = false;
        let mut beam = Beam {
            negative,
            reciprocal: [
                [1.0 / x[1], 1.0 / x[0]],
                [1.0 / y[1], 1.0 / y[0]],
                [1.0 / z[1], 1.0 / z[0]],
            ],
            near_origin: [0.0; 3],
            far_origin: [0.0; 3],
            t_min: extent(simd, &self.t_min)[0],
            reach: extent(simd, &self.reach)[1],
        };
        for k in 0..3 {
            let near = extent(simd, &self.near_origin[k]);
            let far = extent(simd, &self.far_origin[k]);
            beam.near_origin[k] = near[usize::from(!negative[k])];
            beam.far_origin[k] = far[usize::from(negative[k])];
        }
        Some(beam)
    }

    /// Fills what follows from origins, directions and ranges, as
    /// [`crate::kernels::slab::SlabRay::new`] does for one ray.
    #[inline(always)]
    fn prepare<S: Lanes>(&mut self, simd: S, negative: [bool; 3]) {
        for g in 0..GROUPS {
            let x = load(simd, &self.origin[0], g);
            let y = load(simd, &self.origin[1], g);
            let z = load(simd, &self.origin[2], g);
            let pad = (x.abs().max(y.abs().max(z.abs())) * PADDING).max(f32::MIN_POSITIVE);
            let axes = [x, y, z];
            for k in 0..3 {
                let one = f32x16::splat(simd, 1.0);
                self.reciprocal[k][g] = (one / load(simd, &self.direction[k], g)).into();
                let shift = if negative[k] { -pad } else { pad };
                self.near_origin[k][g] = (axes[k] + shift).into();
                self.far_origin[k][g] = (axes[k] - shift).into();
            }
            let t_max = load(simd, &self.t_max, g);
            self.best[g] = t_max.into();
            self.reach[g] = (t_max + t_max.abs() * (4.0 * T_TOLERANCE)).into();
            self.primitive[g] = [NO_PRIMITIVE; WIDTH];
        }
    }

    /// Fills `shear`, for directions that are longest along the axis of `longest`, as
    /// [`crate::kernels::triangle::ShearedSpace::new`] does for one ray.
    #[inline(always)]
    pub(super) fn shear<S: Lanes>(&mut self, simd: S, longest: usize) {
        let [x, y, z] = ORDERS[longest.min(2)];
        for g in 0..GROUPS {
            let depth = load(simd, &self.direction[z.min(2)], g);
            self.shear[0][g] = (load(simd, &self.direction[x.min(2)], g) / depth).into();
            self.shear[1][g] = (load(simd, &self.direction[y.min(2)], g) / depth).into();
            self.shear[2][g] = (f32x16::splat(simd, 1.0) / depth).into();
        }
        self.is_sheared = true;
    }
}

/// Whether a component between these has one sign, and a finite reciprocal.
#[inline(always)]
fn is_one_sign([low, high]: [f32; 2]) -> bool {
    low > f32::MIN_POSITIVE || high < -f32::MIN_POSITIVE
}

/// The axis along which every direction is longest, given the components' extents of one sign.
#[inline(always)]
fn longest([x, y, z]: [[f32; 2]; 3]) -> Option<usize> {
    let least = |c: [f32; 2]| min(c[0].abs(), c[1].abs());
    let greatest = |c: [f32; 2]| max(c[0].abs(), c[1].abs());
    if least(x) > max(greatest(y), greatest(z)) {
        Some(0)
    } else if least(y) > max(greatest(x), greatest(z)) {
        Some(1)
    } else if least(z) > max(greatest(x), greatest(y)) {
        Some(2)
    } else {
        None
    }
}

/// The least and the greatest.
#[inline(always)]
pub(super) fn extent<S: Lanes>(simd: S, column: &Column) -> [f32; 2] {
    let (a, b) = (load(simd, column, 0), load(simd, column, 1));
    let (c, d) = (load(simd, column, 2), load(simd, column, 3));
    let low = a.min(b).min(c.min(d));
    let high = a.max(b).max(c.max(d));
    [low.reduce_min(), high.reduce_max()]
}

impl Beam {
    /// The least t at which a ray can enter each child's box, and the children that rays can meet.
    #[inline(always)]
    pub(super) fn children<S: Lanes>(&self, simd: S, node: &Node) -> (f32x8<S>, mask32x8<S>) {
        let (x0, x1) = self.axis(simd, &node.planes[0], 0);
        let (y0, y1) = self.axis(simd, &node.planes[1], 1);
        let (z0, z1) = self.axis(simd, &node.planes[2], 2);
        let near = x0.max(y0).max(z0.max(f32x8::splat(simd, self.t_min)));
        let far = x1.min(y1).min(z1.min(f32x8::splat(simd, self.reach)));
        (near, near.simd_le(far))
    }

    /// The least t at which a ray can meet the children's first planes across an axis, and the
    /// greatest at which one can meet the last.
    #[inline(always)]
    fn axis<S: Lanes>(
        &self,
        simd: S,
        planes: &[[f32; LANES]; 2],
        k: usize,
    ) -> (f32x8<S>, f32x8<S>) {
        let first: f32x8<S> = planes[usize::from(self.negative[k])].simd_into(simd);
        let last: f32x8<S> = planes[usize::from(!self.negative[k])].simd_into(simd);
        let (first, last) = (first - self.near_origin[k], last - self.far_origin[k]);
        let [low, high] = self.reciprocal[k];
        // Which of the two is earlier depends on the side of the plane that rays start on.
        ((first * low).min(first * high), (last * low).max(last * high))
    }
}

/// A group's part of a column.
#[inline(always)]
pub(super) fn load<S: Lanes>(simd: S, column: &Column, g: usize) -> f32x16<S> {
    column[g].simd_into(simd)
}
