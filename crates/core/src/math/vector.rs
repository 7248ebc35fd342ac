//! Vectors of space, of any width: one, or one in each lane.

use std::ops::{Add, Mul, Neg, Sub};

use glam::{DVec3, Vec3};

use super::bounds::{DOUBLE_ROUNDINGS, STEEPEST_CREASE, gamma};
use super::real::{Mask, Real, Single};

/// 2^-100 and 2^100: squares of lengths between them have not overflowed, and what underflow takes from them is far
/// less than half an ulp.
const SQUARES_IN_SINGLE: [f32; 2] =
    [f32::from_bits((127 - 100) << 23), f32::from_bits((127 + 100) << 23)];

/// 2^-600 and 2^600: the same in double precision, and true of any vector product of `f32` but zero.
const SQUARES_IN_DOUBLE: [f64; 2] =
    [f64::from_bits((1023 - 600) << 52), f64::from_bits((1023 + 600) << 52)];

/// A vector, or a vector in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<F> {
    /// The first coordinate.
    pub x: F,
    /// The second.
    pub y: F,
    /// The third.
    pub z: F,
}

impl<F: Real> Vector<F> {
    /// From coordinates.
    #[inline(always)]
    pub fn new(x: F, y: F, z: F) -> Self {
        Self { x, y, z }
    }

    /// Each vector times its own number.
    #[inline(always)]
    pub fn scale(self, by: F) -> Self {
        Self::new(self.x * by, self.y * by, self.z * by)
    }

    /// Each vector divided by its own number.
    #[inline(always)]
    pub fn over(self, by: F) -> Self {
        Self::new(self.x / by, self.y / by, self.z / by)
    }

    /// The magnitudes of the components.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }

    /// The sum of the components, the same bits in whatever order they are: no axis of space is the first.
    #[inline(always)]
    pub fn element_sum(self) -> F {
        let Self { x, y, z } = self;
        let (low, high) = (x.min(y), x.max(y));
        (low.min(z) + low.max(high.min(z))) + high.max(z)
    }

    /// The scalar product, added by [`Self::element_sum`].
    #[inline(always)]
    pub fn dot(self, other: Self) -> F {
        (self * other).element_sum()
    }

    /// The scalar product, added in the order of the axes.
    #[inline(always)]
    pub fn dot_in_order(self, other: Self) -> F {
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

    /// The largest magnitude of a component.
    #[inline(always)]
    pub fn max_abs(self) -> F {
        let Self { x, y, z } = self.abs();
        x.max(y.max(z))
    }

    /// Where any component is not zero.
    #[inline(always)]
    pub fn is_not_zero(self) -> F::Mask {
        let zero = self.x.zero();
        self.x.ne(zero) | self.y.ne(zero) | self.z.ne(zero)
    }

    /// `a` where `mask` is true, `b` elsewhere.
    #[inline(always)]
    pub fn select(mask: F::Mask, a: Self, b: Self) -> Self {
        Self::new(F::select(mask, a.x, b.x), F::select(mask, a.y, b.y), F::select(mask, a.z, b.z))
    }
}

impl<F: Real<Element = f64>> Vector<F> {
    /// With length 1, or zero where there is no direction.
    #[inline(always)]
    pub fn normalize_wide(self) -> Self {
        let square = self.dot(self);
        let [least, most] = SQUARES_IN_DOUBLE;
        let within = square.gt(square.same(least)) & square.lt(square.same(most));
        let unit = self.times_reciprocal(square.sqrt());
        if !(!within).any() {
            return unit;
        }
        let size = self.max_abs();
        let zero = size.zero();
        let valid = size.gt(zero) & size.lt(size.same(f64::INFINITY));
        let scaled = self.over(size);
        let scaled = scaled.times_reciprocal(scaled.dot(scaled).sqrt());
        let scaled = Self::select(valid, scaled, Self::new(zero, zero, zero));
        Self::select(within, unit, scaled)
    }

    /// Divided by its own number, with one division for three: each coordinate is off by two roundings.
    #[inline(always)]
    fn times_reciprocal(self, by: F) -> Self {
        self.scale(by.same(1.0) / by)
    }
}

impl<F: Single> Vector<F> {
    /// The same vector in each lane.
    #[inline(always)]
    pub fn splat(token: F::Token, v: Vec3) -> Self {
        Self::new(F::splat(token, v.x), F::splat(token, v.y), F::splat(token, v.z))
    }

    /// From a row for each axis.
    #[inline(always)]
    pub fn load(token: F::Token, [x, y, z]: &[F::Row; 3]) -> Self {
        Self::new(F::load(token, x), F::load(token, y), F::load(token, z))
    }

    /// The vector of one lane.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> Vec3 {
        Vec3::new(self.x.lane(i), self.y.lane(i), self.z.lane(i))
    }

    /// Replaces the vector of one lane.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, v: Vec3) {
        self.x.set_lane(i, v.x);
        self.y.set_lane(i, v.y);
        self.z.set_lane(i, v.z);
    }

    /// In double precision.
    #[inline(always)]
    pub fn widen(self) -> Vector<F::Double> {
        Vector { x: self.x.widen(), y: self.y.widen(), z: self.z.widen() }
    }

    /// Rounded to single precision.
    #[inline(always)]
    pub fn narrow(wide: Vector<F::Double>) -> Self {
        Self::new(F::narrow(wide.x), F::narrow(wide.y), F::narrow(wide.z))
    }

    /// Where all components are finite.
    #[inline(always)]
    pub fn is_finite(self) -> F::Mask {
        let infinity = self.x.same(f32::INFINITY);
        let Self { x, y, z } = self.abs();
        x.lt(infinity) & y.lt(infinity) & z.lt(infinity)
    }

    /// With length 1, or zero where there is no direction.
    ///
    /// The length is taken in double precision, where no square of a finite number overflows and none but zero's
    /// vanishes: neither tiny nor huge vectors lose it.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        let wide = self.widen();
        let unit = Self::narrow(wide.times_reciprocal(wide.dot(wide).sqrt()));
        let zero = self.x.zero();
        Self::select(self.is_not_zero() & self.is_finite(), unit, Self::new(zero, zero, zero))
    }

    /// As [`Self::normalize`], in single precision unless the vector is tiny or huge: each coordinate is within
    /// gamma(5) of its exact value. Not for what a highlight's exponent is applied to.
    #[inline(always)]
    pub fn normalize_in_single(self) -> Self {
        let square = self.dot(self);
        let [least, most] = SQUARES_IN_SINGLE;
        let within = square.gt(square.same(least)) & square.lt(square.same(most));
        let unit = self.scale(square.same(1.0) / square.sqrt());
        if !(!within).any() {
            return unit;
        }
        let other = F::outlined(
            square.token(),
            #[inline(always)]
            || self.normalize(),
        );
        Self::select(within, unit, other)
    }

    /// Moves a point off its surface along `normal`, to the side that `direction` points to, just far enough that
    /// the exact surface stays behind.
    ///
    /// `error` bounds the rounding error of each coordinate of the point. To leave its own surface, the point
    /// would have to move by that error box's extent along the normal (Pharr et al., `OffsetRayOrigin`). But error
    /// along the surface can carry a point of an edge behind the neighbour that rises there; moving by
    /// [`STEEPEST_CREASE`] times the size of the box brings it before that one too. Each coordinate is then
    /// rounded away from the surface.
    #[inline(always)]
    pub fn offset_origin(self, error: Self, normal: Self, direction: Self) -> Self {
        self.move_along(normal, direction, error.element_sum().times(STEEPEST_CREASE))
    }

    /// As [`Self::offset_origin`], for the point where a ray ends: its own surface must stay behind, but what
    /// rises beside it may be met, so the error box's extent along the normal is enough.
    #[inline(always)]
    pub fn offset_end(self, error: Self, normal: Self, direction: Self) -> Self {
        self.move_along(normal, direction, normal.abs().dot(error))
    }

    #[inline(always)]
    fn move_along(self, normal: Self, direction: Self, distance: F) -> Self {
        let is_behind = direction.dot(normal).lt(distance.zero());
        let shift = normal.scale(F::select(is_behind, -distance, distance));
        Self::new(
            (self.x + shift.x).round_away(shift.x),
            (self.y + shift.y).round_away(shift.y),
            (self.z + shift.z).round_away(shift.z),
        )
    }

    /// Bound on the error of each coordinate of this point, which was computed in double precision from
    /// coordinates up to `size` and then rounded.
    #[inline(always)]
    pub fn rounding_error(self, size: F) -> Self {
        let constant = size.times(DOUBLE_ROUNDINGS);
        let Self { x, y, z } = self.abs();
        let bound = gamma(2);
        Self::new(x.times(bound) + constant, y.times(bound) + constant, z.times(bound) + constant)
    }
}

/// Where rays start and where they go: one ray, or a ray in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Line<F> {
    /// Where it starts.
    pub origin: Vector<F>,
    /// Where it goes, of any length.
    pub direction: Vector<F>,
}

impl<F: Single> Line<F> {
    /// The point at `t`.
    #[inline(always)]
    pub fn at(&self, t: F) -> Vector<F> {
        self.origin + self.direction.scale(t)
    }

    /// Where a ray can be traced: finite, and of a direction other than zero.
    #[inline(always)]
    pub fn is_valid(&self) -> F::Mask {
        self.origin.is_finite() & self.direction.is_finite() & self.direction.is_not_zero()
    }
}

impl<F: Real> Add for Vector<F> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<F: Real> Sub for Vector<F> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<F: Real> Mul for Vector<F> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }
}

impl<F: Real> Neg for Vector<F> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl From<Vec3> for Vector<f32> {
    #[inline(always)]
    fn from(v: Vec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Vector<f32>> for Vec3 {
    #[inline(always)]
    fn from(v: Vector<f32>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl From<DVec3> for Vector<f64> {
    #[inline(always)]
    fn from(v: DVec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Vector<f64>> for DVec3 {
    #[inline(always)]
    fn from(v: Vector<f64>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

#[cfg(test)]
mod tests;
