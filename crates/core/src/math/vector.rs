//! Vectors in space, of any width: one, or one in each lane.

use std::ops::{Add, Mul, Neg, Sub};

use glam::{DVec3, Vec3};

use super::bounds::{DOUBLE_ROUNDINGS, STEEPEST_CREASE, gamma};
use super::{Mask, Ray, Real, Single};

/// 2^-100 and 2^100: squared lengths in this range have not overflowed, and their loss to underflow
/// is far less than half an ulp.
const SQUARES_IN_SINGLE: [f32; 2] =
    [f32::from_bits((127 - 100) << 23), f32::from_bits((127 + 100) << 23)];

/// 2^-600 and 2^600: the same in double precision; every nonzero cross product of `f32` vectors is
/// in this range.
const SQUARES_IN_DOUBLE: [f64; 2] =
    [f64::from_bits((1023 - 600) << 52), f64::from_bits((1023 + 600) << 52)];

/// A vector, or a vector in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<F> {
    /// The x coordinate.
    pub x: F,
    /// The y coordinate.
    pub y: F,
    /// The z coordinate.
    pub z: F,
}

impl<F: Real> Vector<F> {
    /// The vector with these coordinates.
    #[inline(always)]
    pub fn new(x: F, y: F, z: F) -> Self {
        Self { x, y, z }
    }

    /// Each vector times a scalar of its lane.
    #[inline(always)]
    pub fn scale(self, by: F) -> Self {
        Self::new(self.x * by, self.y * by, self.z * by)
    }

    /// Each vector divided by a scalar of its lane.
    #[inline(always)]
    pub fn over(self, by: F) -> Self {
        Self::new(self.x / by, self.y / by, self.z / by)
    }

    /// The magnitudes of the components.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }

    /// The sum of the components, with the same bits in any order: no axis is special.
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

    /// The cross product.
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

    /// The lanes in which any component is not zero.
    #[inline(always)]
    pub fn is_not_zero(self) -> F::Mask {
        let zero = self.x.zero();
        self.x.ne(zero) | self.y.ne(zero) | self.z.ne(zero)
    }

    /// `a` in the lanes of `mask`, `b` in the others.
    #[inline(always)]
    pub fn select(mask: F::Mask, a: Self, b: Self) -> Self {
        Self::new(F::select(mask, a.x, b.x), F::select(mask, a.y, b.y), F::select(mask, a.z, b.z))
    }
}

impl<F: Real<Element = f64>> Vector<F> {
    /// The same vector in each lane, as many as `like` has.
    #[inline(always)]
    pub fn alike(like: F, v: DVec3) -> Self {
        Self::new(like.same(v.x), like.same(v.y), like.same(v.z))
    }

    /// The vectors at length 1; zero vectors stay zero.
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

    /// Divided by a scalar of its lane, with one division for three components: two roundings for
    /// each coordinate.
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

    /// Loads a row for each axis.
    #[inline(always)]
    pub fn load(token: F::Token, [x, y, z]: &[F::Row; 3]) -> Self {
        Self::new(F::load(token, x), F::load(token, y), F::load(token, z))
    }

    /// The `vector` of each lane.
    #[inline(always)]
    pub fn lanes(token: F::Token, vector: impl Fn(usize) -> Vec3) -> Self {
        let mut rows = <[F::Row; 3]>::default();
        for lane in 0..F::LANES {
            set::<F>(&mut rows, lane, vector(lane));
        }
        Self::load(token, &rows)
    }

    /// The vector in lane `i`.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> Vec3 {
        Vec3::new(self.x.lane(i), self.y.lane(i), self.z.lane(i))
    }

    /// Replaces the vector in lane `i`.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, v: Vec3) {
        self.x.set_lane(i, v.x);
        self.y.set_lane(i, v.y);
        self.z.set_lane(i, v.z);
    }

    /// Converts to double precision.
    #[inline(always)]
    pub fn widen(self) -> Vector<F::Double> {
        Vector { x: self.x.widen(), y: self.y.widen(), z: self.z.widen() }
    }

    /// Rounds to single precision.
    #[inline(always)]
    pub fn narrow(wide: Vector<F::Double>) -> Self {
        Self::new(F::narrow(wide.x), F::narrow(wide.y), F::narrow(wide.z))
    }

    /// The lanes in which all components are finite.
    #[inline(always)]
    pub fn is_finite(self) -> F::Mask {
        let infinity = self.x.same(f32::INFINITY);
        let Self { x, y, z } = self.abs();
        x.lt(infinity) & y.lt(infinity) & z.lt(infinity)
    }

    /// The vectors at length 1; zero vectors stay zero.
    ///
    /// The length is computed in double precision, where no square of a finite `f32` overflows and
    /// only that of zero vanishes. Tiny and huge vectors keep their precision.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        let wide = self.widen();
        let unit = Self::narrow(wide.times_reciprocal(wide.dot(wide).sqrt()));
        let zero = self.x.zero();
        Self::select(self.is_not_zero() & self.is_finite(), unit, Self::new(zero, zero, zero))
    }

    /// As [`Self::normalize`], in single precision unless the vector is tiny or huge: each
    /// coordinate is within gamma(5) of its exact value. Not for highlights, whose exponent
    /// amplifies the error.
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

    /// Moves a point off its surface along `normal`, to the side that `direction` points to, just
    /// far enough that the exact surface stays behind.
    ///
    /// `error` bounds the rounding error of each coordinate of the point. To clear its own surface,
    /// the point must move by the extent of that error box along the normal (Pharr et al.,
    /// `OffsetRayOrigin`). At an edge, error along the surface can also carry the point behind a
    /// neighbour that rises there; moving by [`STEEPEST_CREASE`] times the size of the box clears
    /// that one too. Each coordinate is then rounded away from the surface.
    #[inline(always)]
    pub fn offset_origin(self, error: Self, normal: Self, direction: Self) -> Self {
        self.move_along(normal, direction, error.element_sum().times(STEEPEST_CREASE))
    }

    /// As [`Self::offset_origin`], for the end of a ray: its own surface must stay behind, but
    /// neighbours that rise there may be met, so the extent of the error box along the normal is
    /// enough.
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

    /// Bound on the error of each coordinate of this point, computed in double precision from
    /// coordinates up to `size` and then rounded.
    #[inline(always)]
    pub fn rounding_error(self, size: F) -> Self {
        let constant = size.times(DOUBLE_ROUNDINGS);
        self.abs().scale(size.same(gamma(2))) + Self::new(constant, constant, constant)
    }
}

/// Origins and directions: one ray, or a ray in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Line<F> {
    /// The origins.
    pub origin: Vector<F>,
    /// The directions, of any length.
    pub direction: Vector<F>,
}

impl<F: Single> Line<F> {
    /// The ray in lane `i`, from 0 to infinity.
    pub fn ray(&self, i: usize) -> Ray {
        Ray::new(self.origin.lane(i), self.direction.lane(i))
    }

    /// The point at `t`.
    #[inline(always)]
    pub fn at(&self, t: F) -> Vector<F> {
        self.origin + self.direction.scale(t)
    }

    /// The lanes whose ray can be traced: it is finite, and its direction is not zero.
    #[inline(always)]
    pub fn is_valid(&self) -> F::Mask {
        self.origin.is_finite() & self.direction.is_finite() & self.direction.is_not_zero()
    }
}

impl From<&Ray> for Line<f32> {
    #[inline(always)]
    fn from(ray: &Ray) -> Self {
        Self { origin: ray.origin.into(), direction: ray.direction.into() }
    }
}

macro_rules! by_component {
    ($($operator:ident: $apply:ident),+) => {$(impl<F: Real> $operator for Vector<F> {
        type Output = Self;

        #[inline(always)]
        fn $apply(self, other: Self) -> Self {
            Self::new(self.x.$apply(other.x), self.y.$apply(other.y), self.z.$apply(other.z))
        }
    })+};
}

by_component!(Add: add, Sub: sub, Mul: mul);

impl<F: Real> Neg for Vector<F> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

/// Replaces the vector of a lane in a row for each axis.
#[inline(always)]
pub fn set<F: Single>([x, y, z]: &mut [F::Row; 3], lane: usize, v: Vec3) {
    (x.as_mut()[lane], y.as_mut()[lane], z.as_mut()[lane]) = (v.x, v.y, v.z);
}

macro_rules! as_glam {
    ($($number:ty: $vector:ty),+) => {$(
        impl From<$vector> for Vector<$number> {
            #[inline(always)]
            fn from(v: $vector) -> Self {
                Self { x: v.x, y: v.y, z: v.z }
            }
        }

        impl From<Vector<$number>> for $vector {
            #[inline(always)]
            fn from(v: Vector<$number>) -> Self {
                Self::new(v.x, v.y, v.z)
            }
        }
    )+};
}

as_glam!(f32: Vec3, f64: DVec3);

#[cfg(test)]
mod tests;
