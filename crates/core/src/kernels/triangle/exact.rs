//! The ray-triangle test without rounding: the reference.
//!
//! With o the origin and d the direction of the ray and a, b, c the corners, the ray passes the
//! edge from p to q on the side given by the sign of det(p - o, q - o, d). The three add up to
//! det(b - a, c - a, d), and t is det(a - o, b - o, c - o) over that sum. Double precision decides
//! if Shewchuk's bound on its error allows, and exact sums otherwise.

use glam::{DVec3, Vec3};

use crate::math::exact::Sum;
use crate::math::ray::Ray;

/// Bound on the error of a determinant of differences, relative to the sum of its terms'
/// magnitudes: Shewchuk's (7 + 56 u) u, rounded up.
const DETERMINANT_ERROR: f64 = 8.0 * (f64::EPSILON / 2.0);

/// Bound on the relative error of a quotient of exact sums, each rounded.
const QUOTIENT_ERROR: f64 = 8.0 * f64::EPSILON;

/// A determinant, and a bound on its error.
#[derive(Clone, Copy)]
struct Bounded {
    value: f64,
    error: f64,
}

impl Bounded {
    /// det(u, v, w).
    fn determinant(u: DVec3, v: DVec3, w: DVec3) -> Self {
        let terms = [
            [w.x * (u.y * v.z), w.x * (u.z * v.y)],
            [w.y * (u.z * v.x), w.y * (u.x * v.z)],
            [w.z * (u.x * v.y), w.z * (u.y * v.x)],
        ];
        let (mut value, mut size) = (0.0, 0.0);
        for [plus, minus] in terms {
            value += plus - minus;
            size += plus.abs() + minus.abs();
        }
        // Products of numbers this small lose bits to underflow; exact sums decide.
        Self { value, error: DETERMINANT_ERROR * size + f64::MIN_POSITIVE }
    }

    /// The value, if its sign is certain.
    fn if_signed(self) -> Option<f64> {
        (self.error < self.value.abs()).then_some(self.value)
    }

    /// The quotient, if it rounds to a single value in single precision under all errors.
    fn over(self, other: Self) -> Option<f64> {
        let quotient = self.value / other.value;
        let error = (self.error + quotient.abs() * other.error) / other.value.abs();
        let error = error + QUOTIENT_ERROR * quotient.abs();
        // The divisor's own error hardly matters if most of its digits are certain.
        let is_known = 64.0 * other.error <= other.value.abs()
            && (quotient - 2.0 * error) as f32 == (quotient + 2.0 * error) as f32;
        is_known.then_some(quotient)
    }
}

/// The ray and the corners, unrounded.
struct Question {
    origin: [f32; 3],
    direction: [f32; 3],
    corners: [[f32; 3]; 3],
}

impl Question {
    fn of(ray: &Ray, triangle: &[Vec3; 3]) -> Self {
        Self {
            origin: ray.origin.to_array(),
            direction: ray.direction.to_array(),
            corners: triangle.map(Vec3::into),
        }
    }

    /// det(p - o, q - o, d) for the corners p and q.
    fn side(&self, p: usize, q: usize) -> Sum {
        let (o, d, p, q) = (self.origin, self.direction, self.corners[p], self.corners[q]);
        let mut sum = Sum::ZERO;
        sum.add_volume(d, p, q);
        sum.add_volume(d, o, p);
        sum.add_volume(d, q, o);
        sum
    }

    /// t, unless the ray is in the triangle's plane.
    fn quotient(&self) -> Option<f64> {
        let mut whole = self.side(1, 2);
        whole.add_sum(&self.side(2, 0));
        whole.add_sum(&self.side(0, 1));
        let whole = whole.value();
        (whole != 0.0).then(|| self.volume().value() / whole)
    }

    /// det(a - o, b - o, c - o).
    fn volume(&self) -> Sum {
        let (o, [a, b, c]) = (self.origin, self.corners);
        let from_origin = o.map(|x| -x);
        let mut sum = Sum::ZERO;
        sum.add_volume(a, b, c);
        sum.add_volume(from_origin, b, c);
        sum.add_volume(from_origin, a, b);
        sum.add_volume(from_origin, c, a);
        sum
    }
}

/// The t at which `ray` meets `triangle`, from either side and before or behind its origin, with
/// more digits than single precision: rounded to single precision it is the exact t rounded once,
/// except for one in millions next to the middle of two numbers. A ray that meets an edge or a
/// corner meets every triangle there; one in the triangle's plane meets nothing.
pub fn intersect(ray: &Ray, triangle: &[Vec3; 3]) -> Option<f64> {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let corners = triangle.map(|v| v.as_dvec3() - o);
    let sides = [(1, 2), (2, 0), (0, 1)].map(|(p, q)| {
        let side = Bounded::determinant(corners[p], corners[q], d);
        side.if_signed().unwrap_or_else(|| Question::of(ray, triangle).side(p, q).value())
    });
    if sides.iter().any(|&s| s < 0.0) && sides.iter().any(|&s| s > 0.0) {
        return None;
    }
    plane(ray, triangle)
}

/// As [`intersect`], for the plane of the triangle.
pub fn plane(ray: &Ray, triangle: &[Vec3; 3]) -> Option<f64> {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let [a, b, c] = triangle.map(|v| v.as_dvec3());
    let whole = Bounded::determinant(b - a, c - a, d);
    let volume = Bounded::determinant(a - o, b - o, c - o);
    volume.over(whole).or_else(|| Question::of(ray, triangle).quotient())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::triangle::{ShearedSpace, T_TOLERANCE};
    use crate::math::random::Stream;

    /// Random triangles, and rays aimed at points of them.
    fn aimed() -> impl Iterator<Item = (Ray, [Vec3; 3])> {
        (0..20_000).map(|i| {
            let stream = Stream { seed: 11, pixel: i, sample: 0, bounce: 0 };
            let at = |k: u32| Vec3::from_slice(&stream.uniform(k)[..3]) - 0.5;
            let corners = [at(0), at(1), at(2)];
            let [u, v, ..] = stream.uniform(3);
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let target = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
            let origin = at(4) * 8.0;
            (Ray::new(origin, target - origin), corners)
        })
    }

    #[test]
    fn hits_and_their_t_are_those_of_the_watertight_test_within_its_bound() {
        let mut hits = 0;
        for (ray, corners) in aimed() {
            let Some(t) = intersect(&ray, &corners) else { continue };
            let Some(single) = ShearedSpace::new(&ray).intersect(&corners) else { continue };
            hits += 1;
            let error = (t - f64::from(single)).abs();
            assert!(error <= f64::from(T_TOLERANCE) * t.abs(), "{ray:?} {corners:?}: {t} {single}");
        }
        assert!(hits > 19_000, "{hits}");
    }

    #[test]
    fn rays_through_corners_and_edges_meet_the_triangles_there() {
        let corners =
            [Vec3::new(1.0, 2.0, 3.0), Vec3::new(5.0, 2.5, 1.0), Vec3::new(2.0, 7.0, 4.0)];
        let origin = Vec3::new(-3.0, 0.5, 9.0);
        let middle = (corners[0] + corners[1]) * 0.5;
        for target in [corners[0], corners[1], corners[2], middle] {
            let ray = Ray::new(origin, target - origin);
            let t = intersect(&ray, &corners).expect("a hit");
            assert!((t - 1.0).abs() < 1e-15, "{t}");
        }
    }

    #[test]
    fn t_is_right_however_flat_the_ray_meets_the_plane() {
        // The plane is z = 2^-20 x; the ray runs along x at z = 1 and meets it at x = 2^20.
        let size = (1_u32 << 21) as f32;
        let corners =
            [Vec3::new(0.0, -size, 0.0), Vec3::new(size, 0.0, 2.0), Vec3::new(0.0, size, 0.0)];
        let ray = Ray::new(Vec3::new(0.0, 0.0, 1.0), Vec3::X);
        assert_eq!(intersect(&ray, &corners), Some(f64::from(1_u32 << 20)));
        let beside =
            Ray::new(Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0 / (1 << 20) as f32));
        assert_eq!(intersect(&beside, &corners), None);
    }
}
