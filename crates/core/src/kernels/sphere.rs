//! The ray-sphere test of Haines, Günther and Akenine-Möller (*Precision Improvements for
//! Ray/Sphere Intersection*, Ray Tracing Gems 2019, chapter 7), in double precision and with bounds.
//!
//! A hit is the least root of |o + t d - c|^2 = r^2 within the ray's range, told rounded once. The
//! discriminant comes from the distance of the centre to the ray, which keeps its precision for
//! small and far spheres; the roots come from the stable quadratic. Single precision rejects most
//! spheres that a ray misses. What double precision leaves open is decided in exact arithmetic.
//!
//! # The bound
//!
//! With u the unit roundoff of double precision, f from the centre to the origin, and n the vector
//! from the centre to the nearest point of the line, b = -f . d / d^2 is off by at most 9 u |f| /
//! |d|, n by 21 u |f|, and the discriminant r^2 - n^2 by e = 64 u (r^2 + |n| |f|) + (64 u |f|)^2. If
//! it exceeds 4 e, its root is off by a relative (e / discriminant + 4 u); and c = (f^2 - r^2) / d^2
//! by 12 u (f^2 + r^2) / d^2. The errors of both roots follow.

use glam::Vec3;

use super::Arithmetic;
use crate::math::exact::{Comparable, Expansion, QuadraticRoot, dot, exact};
use crate::math::float::gamma;
use crate::math::{LANES, Line, Mask, Ray, Real, Single, Vector, set_bits};

/// The smallest t within the ray's range at which the ray meets the sphere, from outside or inside, in
/// exact arithmetic.
#[cold]
#[inline(never)]
pub fn intersect_exactly(ray: &Ray, center: Vec3, radius: f32) -> Option<f32> {
    let range = [ray.t_min, ray.t_max];
    let [near, far] = roots(ray, center, radius)?;
    [near, far].iter().find(|root| root.is_within(range)).map(Comparable::rounded)
}

/// Both t within the range of a ray at which it meets a sphere, the nearer first.
pub fn crossings<P: Arithmetic>(ray: &Ray, center: Vec3, radius: f32) -> [Option<f32>; 2] {
    let line = Line::from(ray);
    if !P::IS_REFERENCE {
        if passes_by(&line, center.into(), radius) {
            return [None; 2];
        }
        let Roots { near, near_error, far, far_error, known, miss } =
            Roots::of::<f32>(&line, center.into(), radius);
        if miss {
            return [None; 2];
        }
        if known
            && let Some(near) = crossed(ray, near, near_error)
            && let Some(far) = crossed(ray, far, far_error)
        {
            return [near, far];
        }
    }
    let within =
        |root: QuadraticRoot| root.is_within([ray.t_min, ray.t_max]).then(|| root.rounded());
    roots(ray, center, radius).map_or([None; 2], |roots| roots.map(within))
}

/// A root with this bound on its error, rounded, if it is within the range of the ray; `None` if the bound
/// leaves that open, or how it is rounded.
fn crossed(ray: &Ray, root: f64, error: f64) -> Option<Option<f32>> {
    let (low, high) = (root - error, root + error);
    let (start, end) = (f64::from(ray.t_min), f64::from(ray.t_max));
    if high <= start || low >= end {
        return Some(None);
    }
    let t = low as f32;
    let is_known = low > start && high < end && t == high as f32 && t.abs() < f32::MAX;
    is_known.then_some(Some(t))
}

/// The t of both meetings of the line of a ray with a sphere, if it meets it.
fn roots(ray: &Ray, center: Vec3, radius: f32) -> Option<[QuadraticRoot; 2]> {
    let (d, o, center) = (exact(ray.direction), exact(ray.origin), exact(center));
    let f = [0, 1, 2].map(|k| &o[k] - &center[k]);
    let radius = Expansion::from(radius);
    QuadraticRoot::both(dot(&d, &d), -dot(&f, &d), &dot(&f, &f) - &(&radius * &radius))
}

/// The t of both meetings of a line and a closed surface in double precision, with bounds on their
/// errors.
pub(super) struct Roots<D: Real> {
    pub(super) near: D,
    pub(super) near_error: D,
    pub(super) far: D,
    pub(super) far_error: D,
    /// The lanes whose line certainly meets the surface, with errors that are known.
    pub(super) known: D::Mask,
    /// The lanes whose line certainly misses.
    pub(super) miss: D::Mask,
}

/// See the module documentation.
const ERROR: f64 = 64.0 * (f64::EPSILON / 2.0);

impl<D: Real<Element = f64>> Roots<D> {
    #[inline(always)]
    fn of<F: Single<Double = D>>(line: &Line<F>, center: Vector<F>, radius: F) -> Self {
        const U: f64 = f64::EPSILON / 2.0;
        let d = line.direction.widen();
        let f = line.origin.widen() - center.widen();
        let r = radius.widen();
        // One division, by the squared length of the direction; the roots need the other.
        let part = r.same(1.0) / d.dot(d);
        let b = -(f.dot(d) * part);
        let nearest = f + d.scale(b);
        let (n2, f2, r2) = (nearest.dot(nearest), f.dot(f), r * r);
        let discriminant = r2 - n2;
        let error = (r2 + (n2 * f2).sqrt()).times(ERROR) + f2.times(ERROR * ERROR);
        let root = (discriminant * part).sqrt();
        let root_error = root * ((error / discriminant) + root.same(4.0 * U));
        let c = (f2 - r2) * part;
        let c_error = ((f2 + r2) * part).times(12.0 * U);
        let q = b + root.copysign(b);
        let q_error = (f2 * part).sqrt().times(9.0 * U) + root_error + q.abs().times(2.0 * U);
        let other = c / q;
        let other_error = (c_error + other.abs() * q_error).times(1.03) / q.abs();
        let other_error = other_error + other.abs().times(2.0 * U);
        let is_near = other.lt(q);
        Self {
            near: D::select(is_near, other, q),
            near_error: D::select(is_near, other_error, q_error),
            far: D::select(is_near, q, other),
            far_error: D::select(is_near, q_error, other_error),
            known: discriminant.gt(error.times(4.0)) & q_error.times(64.0).lt(q.abs()),
            miss: discriminant.lt(-error),
        }
    }
}

impl Roots<f64> {
    /// Bounds on the t of the nearer meeting; comparisons with unknown ones are false.
    pub(super) fn interval(&self) -> [f64; 2] {
        let Self { near, near_error, known, .. } = *self;
        if known { [near - near_error, near + near_error] } else { [f64::NAN; 2] }
    }
}

/// The smallest of the `roots` within the range, and the lanes that have one. What double precision
/// leaves open is decided lane by lane, by `exactly`.
#[inline(always)]
pub(super) fn settled<F: Single>(
    line: &Line<F>,
    roots: &Roots<F::Double>,
    [t_min, t_max]: [F; 2],
    exactly: impl Fn(&Ray) -> Option<f32>,
) -> (F, F::Mask) {
    let token = t_min.token();
    let (start, end) = (t_min.widen(), t_max.widen());
    let is_first = (roots.near - roots.near_error).gt(start);
    let is_second = (roots.near + roots.near_error).le(start);
    let t = Real::select(is_first, roots.near, roots.far);
    let error = Real::select(is_first, roots.near_error, roots.far_error);
    let (low, high) = (t - error, t + error);
    let (least, most) = (F::narrow(low), F::narrow(high));
    let is_known = least.eq(most) & least.abs().lt(least.same(f32::MAX));
    let known = roots.known & (is_first | is_second);
    let mut hit = (known & low.gt(start) & high.lt(end)).bits() & is_known.bits();
    let miss = (roots.miss | (known & (high.le(start) | low.ge(end)))).bits();
    let mut t = least;
    for lane in set_bits::<LANES>(!(hit | miss) & (u32::MAX >> (32 - F::LANES))) {
        let ray = Ray {
            origin: line.origin.lane(lane),
            direction: line.direction.lane(lane),
            t_min: t_min.lane(lane),
            t_max: t_max.lane(lane),
        };
        if ray.is_valid()
            && let Some(exact) = exactly(&ray)
        {
            t.set_lane(lane, exact);
            hit |= 1 << lane;
        }
    }
    (t, F::mask(token, hit))
}

/// The root nearest to `t`, in double precision; `t` itself if rounding leaves none.
#[inline(always)]
pub(super) fn near<F: Single>(line: &Line<F>, t: F, center: Vector<F>, radius: F) -> F::Double {
    let Roots { near, far, .. } = Roots::of(line, center, radius);
    let t = t.widen();
    let nearest = Real::select((t - near).abs().le((t - far).abs()), near, far);
    Real::select(nearest.eq(nearest), nearest, t)
}

/// The lanes whose rays certainly miss the ball, so that [`settled`] finds no t: most of them, rejected in
/// single precision without a division.
///
/// With f from the centre to the origin and n = f x d, the distance is |n| / |d|. Each coordinate
/// of n is off by gamma(3) |f| |d|, and n by e = sqrt(3) gamma(3) |f| |d|; so the ray misses if the
/// computed |n| > r |d| + e. As (x + y)^2 <= (1 + s) x^2 + (1 + 1 / s) y^2, this holds if n^2 > d^2
/// ((1 + s) r^2 + (1 + 1 / s) 3 gamma(3)^2 f^2). [`MARGIN`] is more than twice s, for the rounding
/// of both sides; a part s of r^2 remains for double precision's own error. Squares that underflow
/// are off by less than [`f32::MIN_POSITIVE`]. Squares that overflow on the right leave the ray
/// undecided, and if all overflow on the left the distance is indeed that large.
#[inline(always)]
pub(super) fn passes_by<F: Single>(line: &Line<F>, center: Vector<F>, radius: F) -> F::Mask {
    let (d, f) = (line.direction, line.origin - center);
    let (n, square) = (f.cross(d), d.dot_in_order(d));
    let tiny = square.same(f32::MIN_POSITIVE);
    let origin = f.dot_in_order(f).times(ORIGIN_ERROR);
    let limit = square * ((radius * radius).times(1.0 + MARGIN) + origin + tiny) + tiny;
    n.dot_in_order(n).gt(limit) & square.gt(square.same(SHORTEST))
}

/// See [`passes_by`]: 2^-9.
const MARGIN: f32 = 1.0 / 512.0;

/// See [`passes_by`]: twice (1 + 1 / s) 3 gamma(3)^2, with s = 2^-10.
const ORIGIN_ERROR: f32 = 2.0 * (1.0 + 1024.0) * 3.0 * gamma(3) * gamma(3);

/// Squares of directions longer than this, 2^-60, keep their precision.
const SHORTEST: f32 = 1.0 / (1_u64 << 60) as f32;

/// The smallest t within (`t_min`, `t_max`) at which each ray meets the sphere, and the lanes that
/// hit.
#[inline(always)]
pub fn meet<F: Single, P: Arithmetic>(
    line: &Line<F>,
    center: Vec3,
    radius: f32,
    range: [F; 2],
) -> (F, F::Mask) {
    let token = range[0].token();
    let (centers, radii) = (Vector::splat(token, center), F::splat(token, radius));
    if P::IS_FAST {
        // The textbook quadratic, as in most renderers: small and far spheres suffer cancellation.
        let (d, f) = (line.direction, line.origin - centers);
        let (a, half_b) = (d.dot_in_order(d), f.dot_in_order(d));
        let discriminant = half_b * half_b - a * (f.dot_in_order(f) - radii * radii);
        let root = discriminant.sqrt();
        let (near, far) = ((-half_b - root) / a, (-half_b + root) / a);
        let t = F::select(near.gt(range[0]), near, far);
        let is_hit = t.gt(range[0]) & discriminant.ge(discriminant.zero());
        return (t, is_hit & t.lt(range[1]));
    }
    let passes = passes_by(line, centers, radii);
    if !(!passes).any() {
        return (range[1], !passes);
    }
    let roots = Roots::of(line, centers, radii);
    settled(line, &roots, range, |ray| intersect_exactly(ray, center, radius))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    fn is_met(ray: &Ray, center: Vec3, radius: f32) -> bool {
        let (line, range) = (Line::from(ray), [ray.t_min, ray.t_max]);
        let roots = Roots::of(&line, center.into(), radius);
        settled(&line, &roots, range, |ray| intersect_exactly(ray, center, radius)).1
    }

    /// For grazing rays, from near and far, of all sizes: [`passes_by`] rejects no hit.
    #[test]
    fn what_passes_by_for_certain_is_not_hit() {
        let mut counts = [[0; 2]; 2];
        for pixel in 0..100_000 {
            let stream = Stream { seed: 13, pixel, sample: 0, bounce: 0 };
            let [[a, b, c, d], [e, f, g, h]] = [0, 1].map(|dimension| stream.uniform(dimension));
            let size = |u: f32, most: f32| libm::powf(10.0, (2.0 * u - 1.0) * most);
            let radius = size(d, 11.0);
            let center = (Vec3::new(b, c, a) - 0.5) * size(h, 11.0);
            let towards = (Vec3::new(a, b, c) - 0.5).normalize();
            let aside = towards.any_orthonormal_vector() * (radius * (0.98 + 0.04 * g));
            let origin = center - towards * (radius * size(f * 0.5 + 0.5, 5.0));
            let ray = Ray::new(origin, (center + aside - origin) * size(e, 11.0));
            let passes = passes_by(&Line::from(&ray), center.into(), radius);
            counts[usize::from(passes)][usize::from(is_met(&ray, center, radius))] += 1;
        }
        let [[open, hits], [passes, lost]] = counts;
        assert!(lost == 0 && hits > 20_000 && open.min(passes) > 10_000, "{counts:?}");
    }
}
