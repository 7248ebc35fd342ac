//! Where rays meet the planes of triangles, in double precision: what decides where single precision does not.
//!
//! With a, b, c the corners, o and d the origin and the direction of the ray, n = (b - a) x (c - a) and
//! t = n . (a - o) / n . d.
//!
//! # The bound
//!
//! With u the unit roundoff of double precision and m the sum of magnitudes that n is the difference of, a component
//! of n is off by at most 4 u m, and the two scalar products by at most 9 u m . |a - o| and 8 u m . |d|. So t is off
//! by at most 10 u (m . |a - o| + |t| m . |d|) / |n . d|, the roundings of the quotient and of the bound included;
//! products of three numbers of single precision do not underflow.
//!
//! Where both ends of that interval round to one number of single precision, t is that number: the exact t, rounded
//! once. It does not depend on the order of the corners, and triangles of one plane are met at one t.

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
    /// What the components of the normal are differences of, their magnitudes added.
    size: Vector<D>,
}

/// What is known of rays and the planes of their triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settled<F: Single> {
    /// The exact t, rounded, where there is a `hit`.
    pub(crate) t: F,
    /// Where t is known and within the range of the ray.
    pub(crate) hit: F::Mask,
    /// Where t is certainly outside of the range.
    pub(crate) miss: F::Mask,
}

impl Plane<f64> {
    /// The same plane in each lane, as many as `like` has.
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

    /// Decides on rays with ranges from `t_min` to `t_max`, all of which pass through their triangles.
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
        // What is not a number is neither a hit nor a miss.
        let (low, high) = (F::narrow(t - error), F::narrow(t + error));
        Settled {
            t: low,
            hit: low.eq(high) & low.gt(range.t_min) & high.lt(range.t_max),
            miss: high.le(range.t_min) | low.ge(range.t_max),
        }
    }
}
