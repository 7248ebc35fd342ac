//! The ray-sphere test of Haines, Günther and Akenine-Möller (*Precision Improvements for
//! Ray/Sphere Intersection*, Ray Tracing Gems 2019, chapter 7).
//!
//! The discriminant comes from the distance of the centre to the ray, which keeps its precision for
//! small and far spheres; the roots come from the stable quadratic. Both are in double precision: a
//! sphere needs one test where a mesh needs many, and the rounded result is within one ulp of `f32`
//! even if the origin lies on a huge sphere.

use glam::Vec3;

use super::precision::Arithmetic;
use crate::math::float::{gamma, stable_roots};
use crate::math::ray::Ray;
use crate::math::real::{Mask, Real, Single};
use crate::math::vector::{Line, Vector};

/// The smallest t > t_min at which the ray meets the sphere, from outside or inside.
#[inline]
pub fn intersect(ray: &Ray, center: Vec3, radius: f32) -> Option<f32> {
    let (t, is_hit) = distance(&Line::from(ray), center.into(), radius, ray.t_min);
    is_hit.then_some(t as f32)
}

/// As [`intersect`], before rounding; with the lanes that hit.
#[inline(always)]
pub fn distance<F: Single>(
    line: &Line<F>,
    center: Vector<F>,
    radius: F,
    t_min: F,
) -> (F::Double, <F::Double as Real>::Mask) {
    let d = line.direction.widen();
    let f = line.origin.widen() - center.widen();
    let r = radius.widen();
    // One division, by the squared length of the direction; the roots need the other.
    let part = r.same(1.0) / d.dot(d);
    let b = -(f.dot(d) * part);
    let nearest = f + d.scale(b);
    let discriminant = r * r - nearest.dot(nearest);
    let c = f.dot(f) - r * r;
    let (near, far) = stable_roots(b, c * part, (discriminant * part).sqrt());
    // t_min as compared after rounding: the near root must not round to t_min and hide the far
    // one.
    let t_min = t_min.widen();
    let counts = |t: F::Double| F::narrow(t).widen().gt(t_min);
    let t = Real::select(counts(near), near, far);
    (t, counts(t) & !discriminant.lt(discriminant.zero()))
}

/// The lanes whose rays certainly miss, so that [`distance`] finds no t: most of them, rejected in
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
fn passes_by<F: Single>(line: &Line<F>, center: Vector<F>, radius: F) -> F::Mask {
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

/// As [`intersect`], by the textbook quadratic in single precision, as in most renderers. Small and
/// far spheres suffer cancellation.
#[inline]
pub fn intersect_fast(ray: &Ray, center: Vec3, radius: f32) -> Option<f32> {
    let (t, is_hit) = distance_fast(&Line::from(ray), center.into(), radius, ray.t_min);
    is_hit.then_some(t)
}

/// As [`distance`], with the method of [`intersect_fast`].
#[inline(always)]
fn distance_fast<F: Single>(
    line: &Line<F>,
    center: Vector<F>,
    radius: F,
    t_min: F,
) -> (F, F::Mask) {
    let (d, f) = (line.direction, line.origin - center);
    let (a, half_b, c) =
        (d.dot_in_order(d), f.dot_in_order(d), f.dot_in_order(f) - radius * radius);
    let discriminant = half_b * half_b - a * c;
    let root = discriminant.sqrt();
    let (near, far) = ((-half_b - root) / a, (-half_b + root) / a);
    let t = F::select(near.gt(t_min), near, far);
    (t, t.gt(t_min) & discriminant.ge(discriminant.zero()))
}

/// The smallest t within (`t_min`, `t_max`) at which each ray meets the sphere, and the lanes that
/// hit.
#[inline(always)]
pub(crate) fn meet<F: Single, P: Arithmetic>(
    line: &Line<F>,
    center: Vec3,
    radius: f32,
    [t_min, t_max]: [F; 2],
) -> (F, F::Mask) {
    let token = t_min.token();
    let (center, radius) = (Vector::splat(token, center), F::splat(token, radius));
    if P::IS_FAST {
        let (t, is_hit) = distance_fast(line, center, radius, t_min);
        return (t, is_hit & t.lt(t_max));
    }
    let open = !passes_by(line, center, radius);
    if !open.any() {
        return (t_max, open);
    }
    let (t, is_hit) = distance(line, center, radius, t_min);
    // Masks of the two widths are converted through bits.
    let (t, is_hit) = (F::narrow(t), F::mask(token, is_hit.bits()));
    (t, is_hit & t.lt(t_max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Stream;

    #[test]
    fn both_sides_are_met_at_the_right_distance() {
        let from_outside = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z);
        assert_eq!(intersect(&from_outside, Vec3::ZERO, 1.5), Some(3.5));
        let from_centre = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
        assert_eq!(intersect(&from_centre, Vec3::ZERO, 1.5), Some(1.5));
        let leaving = Ray::new(Vec3::new(0.0, 0.0, 1.5), Vec3::Z);
        assert_eq!(intersect(&leaving, Vec3::ZERO, 1.5), None);
        let beside = Ray::new(Vec3::new(1.6, 0.0, 5.0), Vec3::NEG_Z);
        assert_eq!(intersect(&beside, Vec3::ZERO, 1.5), None);
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
            counts[usize::from(passes)][usize::from(intersect(&ray, center, radius).is_some())] +=
                1;
        }
        let [[open, hits], [passes, lost]] = counts;
        assert!(lost == 0 && hits > 20_000 && open.min(passes) > 10_000, "{counts:?}");
    }

    #[test]
    fn hc13_a_far_sphere_is_not_missed() {
        for distance in [1e3_f32, 1e4, 1e5, 1e6] {
            for i in 0..1000 {
                let impact = 0.99 * i as f32 / 1000.0;
                let ray = Ray::new(Vec3::new(impact, 0.0, distance), Vec3::NEG_Z);
                let t = intersect(&ray, Vec3::ZERO, 1.0).expect("a hit");
                let exact = f64::from(distance) - (1.0 - f64::from(impact).powi(2)).sqrt();
                assert!((f64::from(t) - exact).abs() <= f64::from(distance.next_up() - distance));
            }
        }
    }

    #[test]
    fn hc14_a_huge_sphere_is_met_from_just_above() {
        for radius in [1.0_f32, 1e3, 1e6] {
            let origin = Vec3::new(0.0, 0.0, radius.next_up());
            let height = f64::from(origin.z) - f64::from(radius);
            let t = intersect(&Ray::new(origin, Vec3::NEG_Z), Vec3::ZERO, radius).expect("a hit");
            assert!((f64::from(t) / height - 1.0).abs() < 1e-6, "{radius}: {t} {height}");
        }
    }

    #[test]
    fn a_near_hit_before_t_min_does_not_hide_the_far_one() {
        let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z);
        for (t_min, expected) in [(0.0, Some(3.5)), (3.5, Some(6.5)), (5.0, Some(6.5)), (6.5, None)]
        {
            assert_eq!(intersect(&Ray { t_min, ..ray }, Vec3::ZERO, 1.5), expected);
        }
    }
}
