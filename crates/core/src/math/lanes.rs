//! Vectors of space, eight at a time: a lane for each.
//!
//! Every function here computes in each lane what its namesake in [`super::float`] or in glam
//! computes for one vector: the same operations in the same order, and so the same bits. Vectors
//! of vectors are written out by axis, as arrays of them are not mapped in registers.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f64x8, mask32x8, u32x8};
use glam::Vec3;

use super::float::{STEEPEST_CREASE, gamma};
use super::simd::{LANES, Lanes};

/// A vector in each lane, in single precision.
#[derive(Clone, Copy, Debug)]
pub struct Vec3x8<S: Lanes> {
    /// The first coordinates.
    pub x: f32x8<S>,
    /// The second.
    pub y: f32x8<S>,
    /// The third.
    pub z: f32x8<S>,
}

/// A vector in each lane, in double precision.
#[derive(Clone, Copy, Debug)]
pub struct DVec3x8<S: Lanes> {
    /// The first coordinates.
    pub x: f64x8<S>,
    /// The second.
    pub y: f64x8<S>,
    /// The third.
    pub z: f64x8<S>,
}

/// Double precision, exactly.
#[inline(always)]
pub fn widen<S: Lanes>(v: f32x8<S>) -> f64x8<S> {
    let (low, high) = v.widen();
    low.combine(high)
}

/// Single precision, rounded.
#[inline(always)]
pub fn narrow<S: Lanes>(v: f64x8<S>) -> f32x8<S> {
    let (low, high) = v.split();
    low.narrow(high)
}

impl<S: Lanes> Vec3x8<S> {
    /// From coordinates.
    #[inline(always)]
    pub fn new(x: f32x8<S>, y: f32x8<S>, z: f32x8<S>) -> Self {
        Self { x, y, z }
    }

    /// The same vector in each lane.
    #[inline(always)]
    pub fn splat(simd: S, v: Vec3) -> Self {
        let (x, y) = (f32x8::splat(simd, v.x), f32x8::splat(simd, v.y));
        Self::new(x, y, f32x8::splat(simd, v.z))
    }

    /// From a row for each axis.
    #[inline(always)]
    pub fn load(simd: S, [x, y, z]: &[[f32; LANES]; 3]) -> Self {
        Self::new((*x).simd_into(simd), (*y).simd_into(simd), (*z).simd_into(simd))
    }

    /// The vector of one lane, below 8.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Replaces the vector of one lane, below 8.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, v: Vec3) {
        self.x[i] = v.x;
        self.y[i] = v.y;
        self.z[i] = v.z;
    }

    /// In double precision.
    #[inline(always)]
    pub fn widen(self) -> DVec3x8<S> {
        DVec3x8 { x: widen(self.x), y: widen(self.y), z: widen(self.z) }
    }

    /// Each lane's vector times its own number.
    #[inline(always)]
    pub fn scale(self, by: f32x8<S>) -> Self {
        Self::new(self.x * by, self.y * by, self.z * by)
    }

    /// The absolute values.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }

    /// See [`super::float::sum`], of the components.
    #[inline(always)]
    pub fn element_sum(self) -> f32x8<S> {
        let Self { x, y, z } = self;
        let (low, high) = (x.min(y), x.max(y));
        (low.min(z) + low.max(high.min(z))) + high.max(z)
    }

    /// See [`super::float::dot`].
    #[inline(always)]
    pub fn dot(self, other: Self) -> f32x8<S> {
        (self * other).element_sum()
    }

    /// The scalar product, added in the order of the axes.
    #[inline(always)]
    pub fn dot_in_order(self, other: Self) -> f32x8<S> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - other.y * self.z,
            self.z * other.x - other.z * self.x,
            self.x * other.y - other.x * self.y,
        )
    }

    /// The largest absolute component.
    #[inline(always)]
    pub fn max_abs(self) -> f32x8<S> {
        let Self { x, y, z } = self.abs();
        x.max(y.max(z))
    }

    /// Where any component is not zero.
    #[inline(always)]
    pub fn is_not_zero(self) -> mask32x8<S> {
        self.x.simd_ne(0.0) | self.y.simd_ne(0.0) | self.z.simd_ne(0.0)
    }

    /// Where all components are finite.
    #[inline(always)]
    pub fn is_finite(self) -> mask32x8<S> {
        let infinity = f32::INFINITY;
        let Self { x, y, z } = self.abs();
        x.simd_lt(infinity) & y.simd_lt(infinity) & z.simd_lt(infinity)
    }

    /// This where `mask` is set, `other` elsewhere.
    #[inline(always)]
    pub fn or(self, mask: mask32x8<S>, other: Self) -> Self {
        Self::new(
            mask.select(self.x, other.x),
            mask.select(self.y, other.y),
            mask.select(self.z, other.z),
        )
    }

    /// See [`super::float::normalize`].
    #[inline(always)]
    pub fn normalize(self) -> Self {
        let simd = self.x.token();
        let wide = self.widen();
        let length = wide.dot(wide).sqrt();
        // Squares neither vanish nor overflow in double precision: the length is positive and finite
        // where the vector is finite and not zero.
        let valid = self.is_not_zero() & self.is_finite();
        let unit = DVec3x8 { x: wide.x / length, y: wide.y / length, z: wide.z / length }.narrow();
        unit.or(valid, Self::splat(simd, Vec3::ZERO))
    }

    /// See [`super::float::offset_origin`].
    #[inline(always)]
    pub fn offset_origin(self, error: Self, normal: Self, direction: Self) -> Self {
        self.move_along(normal, direction, error.element_sum() * STEEPEST_CREASE)
    }

    /// See [`super::float::offset_end`].
    #[inline(always)]
    pub fn offset_end(self, error: Self, normal: Self, direction: Self) -> Self {
        self.move_along(normal, direction, normal.abs().dot(error))
    }

    #[inline(always)]
    fn move_along(self, normal: Self, direction: Self, distance: f32x8<S>) -> Self {
        let side = direction.dot(normal).simd_lt(0.0).select(-distance, distance);
        let shift = normal.scale(side);
        Self::new(
            round_away(self.x + shift.x, shift.x),
            round_away(self.y + shift.y, shift.y),
            round_away(self.z + shift.z, shift.z),
        )
    }
}

/// The neighbour of each number on the side of the shift's sign, or the number itself where there
/// is no shift: see [`f32::next_up`] and [`f32::next_down`].
#[inline(always)]
fn round_away<S: Lanes>(value: f32x8<S>, shift: f32x8<S>) -> f32x8<S> {
    const SIGN: u32 = 1 << 31;
    let simd = value.token();
    let bits: u32x8<S> = value.bitcast();
    let sign = shift.bitcast::<u32x8<S>>() & SIGN;
    // Of numbers of the shift's sign the neighbour away from zero is the one of the next pattern.
    let outward = ((bits ^ sign) & SIGN).simd_eq(u32x8::splat(simd, 0));
    let next = outward.select(bits + 1, bits - 1);
    let from_zero = sign | 1;
    let next = value.simd_eq(0.0).select(from_zero, next);
    let moves = shift.simd_ne(0.0) & value.abs().simd_lt(f32::INFINITY);
    moves.select(next, bits).bitcast()
}

impl<S: Lanes> core::ops::Add for Vec3x8<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<S: Lanes> core::ops::Sub for Vec3x8<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<S: Lanes> core::ops::Mul for Vec3x8<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }
}

impl<S: Lanes> core::ops::Neg for Vec3x8<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<S: Lanes> DVec3x8<S> {
    /// In single precision, rounded.
    #[inline(always)]
    pub fn narrow(self) -> Vec3x8<S> {
        Vec3x8::new(narrow(self.x), narrow(self.y), narrow(self.z))
    }

    /// Each lane's vector times its own number.
    #[inline(always)]
    pub fn scale(self, by: f64x8<S>) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }

    /// See [`super::float::dot_f64`].
    #[inline(always)]
    pub fn dot(self, other: Self) -> f64x8<S> {
        let (x, y, z) = (self.x * other.x, self.y * other.y, self.z * other.z);
        let (low, high) = (x.min(y), x.max(y));
        (low.min(z) + low.max(high.min(z))) + high.max(z)
    }

    /// The vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - other.y * self.z,
            y: self.z * other.x - other.z * self.x,
            z: self.x * other.y - other.x * self.y,
        }
    }

    /// See [`super::float::normalize_f64`].
    #[inline(always)]
    pub fn normalize(self) -> Self {
        let size = self.x.abs().max(self.y.abs().max(self.z.abs()));
        let valid = size.simd_gt(0.0) & size.simd_lt(f64::INFINITY);
        let scaled = Self { x: self.x / size, y: self.y / size, z: self.z / size };
        let length = scaled.dot(scaled).sqrt();
        let zero = f64x8::splat(size.token(), 0.0);
        Self {
            x: valid.select(scaled.x / length, zero),
            y: valid.select(scaled.y / length, zero),
            z: valid.select(scaled.z / length, zero),
        }
    }
}

impl<S: Lanes> core::ops::Add for DVec3x8<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<S: Lanes> core::ops::Sub for DVec3x8<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

/// See [`super::float::rounding_error`], of a point that is rounded already.
#[inline(always)]
pub fn rounding_error<S: Lanes>(point: Vec3x8<S>, size: f32x8<S>) -> Vec3x8<S> {
    let constant = size * super::float::DOUBLE_ROUNDINGS;
    let Vec3x8 { x, y, z } = point.abs();
    let bound = gamma(2);
    Vec3x8::new(x * bound + constant, y * bound + constant, z * bound + constant)
}

#[cfg(test)]
mod tests;
