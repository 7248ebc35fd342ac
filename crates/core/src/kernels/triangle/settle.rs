//! Rays and triangles in double precision, with bounds: decides nearly all pairs that a filter in
//! single precision leaves open, and computes the t of hits.
//!
//! With A = a - o and so on for the corners and the origin, and d the direction, the ray passes the
//! edge from a to b on the side given by the sign of det(A, B, d) = (A x B) . d. With n the cross
//! product of two edges from the corner a, t = n . A / n . d.
//!
//! # The bound
//!
//! With u the unit roundoff of double precision and m the sum of the magnitudes of the terms that a
//! component of a cross product is the difference of, that component is off by at most 5 u m: two
//! differences, a product and the difference of the products, the rounded sizes included. A scalar
//! product with d is then off by at most 8 u m . |d|, one with A by 9 u m . |A|. So t, if n . d is
//! known to six bits, is off by at most 12 u (m . |A| + |t| m . |d|) / |n . d|, with the roundings
//! of the reciprocal, the product and the bound. Products of three differences do not underflow: the least
//! difference is 2^-149.
//!
//! If both ends of the interval of t round to the same number of single precision, t is that
//! number: the exact t, rounded once.

use glam::Vec3;

use crate::math::{Line, Mask, Ray, Real, Single, Vector};

/// The unit roundoff of double precision.
const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// See the module documentation.
const SIDE_ERROR: f64 = 8.0 * UNIT_ROUNDOFF;

/// See the module documentation.
const T_ERROR: f64 = 12.0 * UNIT_ROUNDOFF;

/// The slope is known to six bits if it is larger than this times the size of its terms.
const KNOWN: f64 = 64.0 * SIDE_ERROR;

/// The results for rays and triangles, one each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settled<F: Single> {
    /// The exact t, rounded, in the lanes of `hit`.
    pub(crate) t: F,
    /// The rays that certainly meet their triangle, at a known t within their range, a bit each.
    pub(crate) hit: u32,
    /// The rays that certainly miss, or meet their triangle outside their range.
    pub(crate) miss: u32,
}

/// A cross product, with the magnitudes of the terms of each component.
#[derive(Clone, Copy)]
pub(in crate::kernels) struct Cross<D> {
    value: Vector<D>,
    size: Vector<D>,
}

impl<D: Real<Element = f64>> Cross<D> {
    #[inline(always)]
    pub(in crate::kernels) fn of(p: Vector<D>, q: Vector<D>) -> Self {
        let plus = Vector::new(p.y * q.z, p.z * q.x, p.x * q.y);
        let minus = Vector::new(p.z * q.y, p.x * q.z, p.y * q.x);
        Self { value: plus - minus, size: plus.abs() + minus.abs() }
    }

    /// The scalar product with `v`, and the sum of the magnitudes of its terms.
    #[inline(always)]
    fn dot(&self, v: Vector<D>) -> (D, D) {
        (self.value.dot_in_order(v), self.size.dot_in_order(v.abs()))
    }

    /// The lanes in which the determinant with `d` is certainly positive, and negative.
    #[inline(always)]
    pub(in crate::kernels) fn signs(&self, d: Vector<D>) -> (D::Mask, D::Mask) {
        let (value, size) = self.dot(d);
        let error = size.times(SIDE_ERROR);
        (value.gt(error), value.lt(-error))
    }
}

/// A ray and a triangle: the corners as seen from the origins, and the directions.
struct ShiftedPair<D> {
    corners: [Vector<D>; 3],
    /// The edges from the first corner.
    edges: [Vector<D>; 2],
    direction: Vector<D>,
}

impl<D: Real<Element = f64>> ShiftedPair<D> {
    #[inline(always)]
    fn new<F: Single<Double = D>>(line: &Line<F>, [a, b, c]: &[Vector<F>; 3]) -> Self {
        let (a, b, c) = (a.widen(), b.widen(), c.widen());
        let (o, direction) = (line.origin.widen(), line.direction.widen());
        Self { corners: [a - o, b - o, c - o], edges: [b - a, c - a], direction }
    }

    /// The lanes that certainly pass through, and those that certainly do not.
    #[inline(always)]
    fn sides(&self) -> (D::Mask, D::Mask) {
        let [a, b, c] = self.corners;
        let (p, n) = Cross::of(b, c).signs(self.direction);
        let (q, m) = Cross::of(c, a).signs(self.direction);
        let (r, l) = Cross::of(a, b).signs(self.direction);
        ((p & q & r) | (n & m & l), (p | q | r) & (n | m | l))
    }

    /// The interval of t at the planes; in lanes where it is unknown, comparisons with it are false.
    #[inline(always)]
    fn t(&self) -> [D; 2] {
        let normal = Cross::of(self.edges[0], self.edges[1]);
        let (height, height_size) = normal.dot(self.corners[0]);
        let (slope, slope_size) = normal.dot(self.direction);
        let part = slope.same(1.0) / slope;
        let t = height * part;
        let error = (height_size + t.abs() * slope_size).times(T_ERROR) * part.abs();
        let is_known = slope.abs().gt(slope_size.times(KNOWN));
        let error = D::select(is_known, error, error.same(f64::NAN));
        [t - error, t + error]
    }
}

/// The exact t in an interval, rounded, and the lanes in which it is known.
#[inline(always)]
fn rounded<F: Single>([low, high]: [F::Double; 2]) -> (F, F::Mask) {
    let (low, high) = (F::narrow(low), F::narrow(high));
    // Not for magnitudes that single precision does not hold.
    // Without a negative zero.
    let low = low + low.zero();
    (low, low.eq(high) & low.abs().lt(low.same(f32::MAX)))
}

/// Decides where rays with ranges from `t_min` to `t_max` meet their triangles.
#[inline(always)]
pub(crate) fn settle<F: Single>(
    line: &Line<F>,
    corners: &[Vector<F>; 3],
    [t_min, t_max]: [F; 2],
) -> Settled<F> {
    let pair = ShiftedPair::new(line, corners);
    let (inside, outside) = pair.sides();
    let [low, high] = pair.t();
    let (t, is_known) = rounded::<F>([low, high]);
    let (t_min, t_max) = (t_min.widen(), t_max.widen());
    let within = low.gt(t_min) & high.lt(t_max);
    let beyond = high.le(t_min) | low.ge(t_max);
    Settled {
        t,
        hit: inside.bits() & within.bits() & is_known.bits(),
        miss: outside.bits() | beyond.bits(),
    }
}

/// The exact t, rounded, at which rays meet the planes of their triangles, and the lanes in which
/// it is known.
#[inline(always)]
pub(crate) fn t_of<F: Single>(line: &Line<F>, corners: &[Vector<F>; 3]) -> (F, F::Mask) {
    rounded(ShiftedPair::new(line, corners).t())
}

/// Bounds on the t at which a ray meets the plane of a triangle; comparisons with unknown ones are
/// false.
pub(crate) fn interval(ray: &Ray, triangle: &[Vec3; 3]) -> [f64; 2] {
    ShiftedPair::new(&Line::from(ray), &triangle.map(Vector::from)).t()
}

/// What double precision says of a ray and a triangle.
pub(crate) enum Verdict {
    /// They meet within the ray's range, at this t, which is the exact one rounded once.
    Hit(f32),
    /// They do not.
    Miss,
    /// Exact arithmetic has to decide.
    Open,
}

/// As [`settle`], for one pair: most of those that miss need no t.
#[inline]
pub(crate) fn settled(ray: &Ray, triangle: &[Vec3; 3]) -> Verdict {
    let pair = ShiftedPair::new(&Line::from(ray), &triangle.map(Vector::from));
    let (inside, outside) = pair.sides();
    if outside {
        return Verdict::Miss;
    }
    let [low, high] = pair.t();
    let [t_min, t_max] = [ray.t_min, ray.t_max].map(f64::from);
    if high <= t_min || low >= t_max {
        return Verdict::Miss;
    }
    let (t, is_known) = rounded::<f32>([low, high]);
    if inside && is_known && low > t_min && high < t_max {
        return Verdict::Hit(t);
    }
    Verdict::Open
}

/// The t at which `ray` meets the closed `triangle` within its range, from either side: the exact
/// t, rounded once.
#[inline]
pub fn meet(ray: &Ray, triangle: &[Vec3; 3]) -> Option<f32> {
    match settled(ray, triangle) {
        Verdict::Hit(t) => Some(t),
        Verdict::Miss => None,
        Verdict::Open => super::exact::meet(ray, triangle),
    }
}

/// The t at which `ray` crosses `triangle` within its range, rounded once: see
/// [`crossing`](super::exact::crossing).
#[inline]
pub fn crossing(ray: &Ray, triangle: &[Vec3; 3]) -> Option<f32> {
    match settled(ray, triangle) {
        // It passes beside every edge.
        Verdict::Hit(t) => Some(t),
        Verdict::Miss => None,
        Verdict::Open => super::exact::crossing(ray, triangle),
    }
}
