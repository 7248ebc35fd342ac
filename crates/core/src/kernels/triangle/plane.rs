//! Crossings of rays with the planes of triangles, in double precision, for pairs that single
//! precision does not decide.
//!
//! With a, b, c the corners, o and d the origin and the direction of the ray, n = (b - a) x (c - a) and
//! t = n . (a - o) / n . d.
//!
//! # The bound
//!
//! With u the unit roundoff of double precision and m the sum of magnitudes of the differences in
//! n, a component of n is off by at most 4 u m, and the two dot products by at most 9 u m . |a - o|
//! and 8 u m . |d|. So t is off by at most 10 u (m . |a - o| + |t| m . |d|) / |n . d|, including
//! the rounding of the quotient and of the bound; products of three numbers of single precision do
//! not underflow.
//!
//! If both ends of that interval round to the same number of single precision, t is that number:
//! the exact t, rounded once. It does not depend on the order of the corners, and coplanar
//! triangles are met at the same t.

use super::edges::RayRange;
use crate::math::real::{Real, Single};
use crate::math::vector::{Line, Vector};

/// See the module documentation.
const ERROR: f64 = 10.0 * (f64::EPSILON / 2.0);

/// The plane of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane<D> {
    corner: Vector<D>,
    normal: Vector<D>,
    /// For each component of the normal, the sum of the magnitudes of the terms it is the
    /// difference of.
    size: Vector<D>,
}

/// The results for rays and the planes of their triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settled<F: Single> {
    /// The exact t, rounded, in the lanes of `hit`.
    pub(crate) t: F,
    /// The lanes in which t is known and within the range of the ray.
    pub(crate) hit: F::Mask,
    /// The lanes in which t is certainly outside the range.
    pub(crate) miss: F::Mask,
}

impl Plane<f64> {
    /// The same plane in each lane of the width of `like`.
    #[inline(always)]
    pub(crate) fn splat<D: Real<Element = f64>>(&self, like: D) -> Plane<D> {
        let splat = |v: Vector<f64>| Vector::new(like.same(v.x), like.same(v.y), like.same(v.z));
        Plane { corner: splat(self.corner), normal: splat(self.normal), size: splat(self.size) }
    }
}

impl<D: Real<Element = f64>> Plane<D> {
    #[inline(always)]
    pub(crate) fn of(&[a, b, c]: &[Vector<D>; 3]) -> Self {
        let (p, q) = (b - a, c - a);
        let products = |x: D, y: D, z: D, w: D| {
            let (plus, minus) = (x * w, y * z);
            (plus - minus, plus.abs() + minus.abs())
        };
        let (nx, mx) = products(p.y, p.z, q.y, q.z);
        let (ny, my) = products(p.z, p.x, q.z, q.x);
        let (nz, mz) = products(p.x, p.y, q.x, q.y);
        Self { corner: a, normal: Vector::new(nx, ny, nz), size: Vector::new(mx, my, mz) }
    }

    /// Decides on rays with ranges from `t_min` to `t_max` that all pass through their triangles.
    #[inline(always)]
    pub(crate) fn settle<F: Single<Double = D>>(
        &self,
        line: &Line<F>,
        range: &RayRange<F>,
    ) -> Settled<F> {
        let direction = line.direction.widen();
        let from_origin = self.corner - line.origin.widen();
        let height = self.normal.dot_in_order(from_origin);
        let slope = self.normal.dot_in_order(direction);
        let t = height / slope;
        let size = self.size.dot_in_order(from_origin.abs());
        let size = size + t.abs() * self.size.dot_in_order(direction.abs());
        let error = size.times(ERROR) / slope.abs();
        // A NaN is neither a hit nor a miss.
        let (low, high) = (F::narrow(t - error), F::narrow(t + error));
        Settled {
            t: low,
            hit: low.eq(high) & low.gt(range.t_min) & high.lt(range.t_max),
            miss: high.le(range.t_min) | low.ge(range.t_max),
        }
    }
}
