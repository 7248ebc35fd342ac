//! What a hit needs to be shaded: the point, a bound on its rounding error, and the normals.
//!
//! Points are computed in double precision and rounded once, so that the bound is little more than
//! half an ulp and the origins of the next rays stay as near to the surface as they can.

use glam::{DVec3, Vec2, Vec3};

use super::quad;
use super::sphere;
use super::triangle::{self, ShearedSpace};
use crate::math::float::{gamma, max, max_abs, normalize_f64};
use crate::math::ray::Ray;

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

/// Where `ray` meets the quad `corners`.
pub fn quad(ray: &Ray, corners: &[Vec3; 4]) -> Surface {
    let space = ShearedSpace::new(ray);
    let [first, second] = quad::halves(corners);
    let half = match (space.intersect(&first), space.intersect(&second)) {
        (Some(s), Some(t)) if t < s => second,
        (None, Some(_)) => second,
        _ => first,
    };
    Surface { barycentric: Vec2::ZERO, ..triangle(ray, &half) }
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

/// Bound on the error of `point` once it is rounded to single precision, where `size` bounds the
/// coordinates that it was computed from.
fn rounding_error(point: DVec3, size: f32) -> Vec3 {
    // Sixteen roundings of double precision on numbers up to `size`.
    const DOUBLE: f32 = 16.0 * f64::EPSILON as f32;
    point.as_vec3().abs() * gamma(2) + DOUBLE * size
}
