//! What a hit needs to be shaded: the point, a bound on its rounding error, and the normals.
//!
//! Points are computed in double precision and rounded once, so that the bound is little more than
//! half an ulp and the origins of the next rays stay as near to the surface as they can.

pub mod lanes;

use glam::{Vec2, Vec3};

use super::precision::Arithmetic;
use super::quad;
use super::sphere;
use super::triangle::{self, ShearedSpace, fast};
use crate::math::float::{error_of_offset, max, max_abs, normalize, normalize_f64, rounding_error};
use crate::math::ray::Ray;

/// How far fast arithmetic moves origins off surfaces, in scene units: a fixed length, as in most
/// renderers. It is too little far from the origin, and too much in small scenes.
pub const FAST_OFFSET: f32 = 1e-4;

/// The error that makes origins move by [`FAST_OFFSET`].
pub(crate) const FAST_ERROR: f32 = error_of_offset(FAST_OFFSET);

/// A point of a surface, apart from what the surface is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, in world space.
    pub point: Vec3,
    /// Bound on the distance of `point` to the exact surface, for each coordinate.
    pub error: Vec3,
    /// The geometric normal, of unit length, on the side that the winding gives.
    pub normal: Vec3,
    /// Barycentric coordinates of the second and third corner (triangles), else zero.
    pub barycentric: Vec2,
}

impl Surface {
    /// The point at `t`, as fast arithmetic has it.
    #[inline]
    fn fast(ray: &Ray, t: f32, normal: impl Fn(Vec3) -> Vec3, barycentric: Vec2) -> Self {
        let point = ray.origin + ray.direction * t;
        let error = Vec3::splat(FAST_ERROR);
        Self { point, error, normal: normalize(normal(point)), barycentric }
    }
}

/// Where `ray` meets `corners`: at `t`, which fast arithmetic takes as it is.
#[inline]
pub fn triangle_at<P: Arithmetic>(ray: &Ray, t: f32, corners: &[Vec3; 3]) -> Surface {
    if !P::IS_FAST {
        return triangle(ray, corners);
    }
    let fast::Crossing { u, v, .. } = fast::crossing(ray, corners);
    let [a, b, c] = *corners;
    Surface::fast(ray, t, |_| (b - a).cross(c - a), Vec2::new(u, v))
}

/// Where `ray` meets the quad `corners`, at `t`.
#[inline]
pub fn quad_at<P: Arithmetic>(ray: &Ray, t: f32, corners: &[Vec3; 4]) -> Surface {
    let half = quad_half(ray, corners);
    Surface { barycentric: Vec2::ZERO, ..triangle_at::<P>(ray, t, &half) }
}

/// Where `ray` meets the sphere, at `t`; the normal points outward.
#[inline]
pub fn sphere_at<P: Arithmetic>(ray: &Ray, t: f32, center: Vec3, radius: f32) -> Surface {
    if !P::IS_FAST {
        return sphere(ray, center, radius);
    }
    Surface::fast(ray, t, |point| point - center, Vec2::ZERO)
}

/// Where `ray` meets `corners`.
pub fn triangle(ray: &Ray, corners: &[Vec3; 3]) -> Surface {
    let weights = ShearedSpace::new(ray).barycentric(corners);
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    let point = a * weights.x + b * weights.y + c * weights.z;
    let size = corners.iter().fold(0.0, |m, &v| max(m, max_abs(v)));
    Surface {
        point: point.as_vec3(),
        error: rounding_error(point, size),
        normal: triangle::normal(corners).as_vec3(),
        barycentric: Vec2::new(weights.y as f32, weights.z as f32),
    }
}

/// The half of the quad `corners` that `ray`, which hits it, meets first.
#[inline]
pub fn quad_half(ray: &Ray, corners: &[Vec3; 4]) -> [Vec3; 3] {
    let space = ShearedSpace::new(ray);
    let [first, second] = quad::halves(corners);
    // Nearly every ray passes by one half for certain, and then it was the other that was hit.
    if space.passes_by(&second) {
        return first;
    }
    if space.passes_by(&first) {
        return second;
    }
    match (space.intersect(&first), space.intersect(&second)) {
        (Some(s), Some(t)) if t < s => second,
        (None, Some(_)) => second,
        _ => first,
    }
}

/// Where `ray` meets the sphere; the normal points outward.
pub fn sphere(ray: &Ray, center: Vec3, radius: f32) -> Surface {
    let t = sphere::intersect_f64(ray, center, radius).unwrap_or(0.0);
    let hit = ray.origin.as_dvec3() + ray.direction.as_dvec3() * t;
    let normal = normalize_f64(hit - center.as_dvec3());
    let point = center.as_dvec3() + normal * f64::from(radius);
    Surface {
        point: point.as_vec3(),
        error: rounding_error(point, max(max_abs(center), radius)),
        normal: normal.as_vec3(),
        barycentric: Vec2::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::float::{normalize, offset_origin};
    use crate::math::random::Stream;

    /// A number of either sign and any magnitude from 1e-8 to 1e8.
    fn wide(u: f32, v: f32) -> f32 {
        let magnitude = 10.0_f64.powf(16.0 * f64::from(u) - 8.0) as f32;
        if v < 0.5 { -magnitude } else { magnitude }
    }

    fn random(index: u32, dimension: u32) -> [f32; 4] {
        Stream { seed: 9, pixel: index, sample: 0, bounce: 0 }.uniform(dimension)
    }

    /// Rays leave `surface` to its front and to its back; none may meet what `hit` tests again.
    fn leave(surface: &Surface, index: u32, hit: impl Fn(&Ray) -> Option<f32>) -> usize {
        (0..20)
            .filter(|&k| {
                let [x, y, z, _] = random(index, 100 + k);
                let tilted = normalize(Vec3::new(x, y, z) - 0.5);
                // Half of the rays graze the surface.
                let along = tilted - surface.normal * tilted.dot(surface.normal);
                let direction = if k % 2 == 0 { tilted } else { along + surface.normal * 1e-4 };
                let origin = offset_origin(surface.point, surface.error, surface.normal, direction);
                let ray = Ray::new(origin, normalize(direction));
                let leaves = ray.direction.dot(surface.normal).abs() > 1e-6;
                leaves && ray.is_valid() && hit(&ray).is_some()
            })
            .count()
    }

    #[test]
    fn hc09_a_ray_that_leaves_a_triangle_does_not_meet_it_again() {
        let mut tried = 0;
        for i in 0..5000 {
            let corners = [0, 1, 2].map(|k| {
                let ([a, b, c, d], [e, f, _, _]) = (random(i, 2 * k), random(i, 2 * k + 1));
                Vec3::new(wide(a, d), wide(b, e), wide(c, f))
            });
            if triangle::is_degenerate(&corners) {
                continue;
            }
            let target = corners[0] * 0.3 + corners[1] * 0.3 + corners[2] * 0.4;
            let [x, y, z, _] = random(i, 50);
            let origin = target + (Vec3::new(x, y, z) - 0.5) * target.length();
            let ray = Ray::new(origin, target - origin);
            if ShearedSpace::new(&ray).intersect(&corners).is_none() {
                continue;
            }
            tried += 1;
            let surface = triangle(&ray, &corners);
            let again = leave(&surface, i, |ray| ShearedSpace::new(ray).intersect(&corners));
            assert_eq!(again, 0, "triangle {i}: {corners:?}");
        }
        assert!(tried > 2000, "{tried}");
    }

    #[test]
    fn hc09_a_ray_that_leaves_a_sphere_does_not_meet_it_again() {
        for i in 0..5000 {
            let [a, b, c, d] = random(i, 0);
            let [e, f, g, h] = random(i, 1);
            let (center, radius) = (Vec3::new(wide(a, e), wide(b, f), wide(c, g)), wide(d, 1.0));
            let [x, y, z, _] = random(i, 2);
            let outside = center + normalize(Vec3::new(x, y, z) - 0.5) * (radius * (2.0 + h));
            let surface = sphere(&Ray::new(outside, center - outside), center, radius);
            if sphere::intersect(&Ray::new(outside, center - outside), center, radius).is_none() {
                continue;
            }
            let outward = |ray: &Ray| {
                let leaves = ray.direction.dot(surface.normal) > 0.0;
                leaves.then(|| sphere::intersect(ray, center, radius)).flatten()
            };
            assert_eq!(leave(&surface, i, outward), 0, "sphere {i}: {center} {radius}");
        }
    }
}
