//! Ray differentials: how a ray changes from one sample of the image to the next, and the footprint
//! of a sample on a surface (Igehy, *Tracing Ray Differentials*, SIGGRAPH 1999).
//!
//! A differential is a pair of derivatives, for a step to the right and a step down in the image.
//! Each function here differentiates a stage of the ray's path: the camera creates the differential
//! ([`Camera::differential`]), the transfer to a surface moves it ([`Differential::at`]), and
//! reflection or refraction turns it ([`Differential::turned`]). At a surface, the change of the point becomes
//! a change of texture coordinates: [`PlanarMap::change`], [`sphere_uv_change`] and [`uv_change`].
//!
//! Each step is computed in double precision and rounded once. At grazing angles the derivative is
//! unbounded, so results may be infinite or NaN. They stay so: textures use the coarsest level for
//! values that are not finite ([`Image::level`]).
//!
//! [`Camera::differential`]: super::camera::Camera::differential
//! [`PlanarMap::change`]: super::texture::PlanarMap::change
//! [`sphere_uv_change`]: super::texture::sphere_uv_change
//! [`Image::level`]: super::texture::Image::level

use glam::{DVec3, Vec2, Vec3};

use crate::math::float::dot_f64;
use crate::math::ray::Ray;

/// The derivatives of a ray, for a step to the right and one down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Differential {
    /// Of the origin, in scene units per sample.
    pub origin: [Vec3; 2],
    /// Of the unit direction.
    pub direction: [Vec3; 2],
}

impl Differential {
    /// The change of the point at `t` of `ray` on a surface with this geometric normal, on either
    /// side: neighbouring rays meet the plane through the point.
    pub fn at(&self, ray: &Ray, t: f32, normal: Vec3) -> [Vec3; 2] {
        let (direction, normal) = (ray.direction.as_dvec3(), normal.as_dvec3());
        let towards = dot_f64(direction, normal);
        [0, 1].map(|axis| {
            let sideways =
                self.origin[axis].as_dvec3() + self.direction[axis].as_dvec3() * f64::from(t);
            let farther = -dot_f64(sideways, normal) / towards;
            (sideways + direction * farther).as_vec3()
        })
    }

    /// The differential of the ray that `ray` becomes about the unit vector `normal`, if points change
    /// by `steps` and the normal by `turns`: mirrored, or refracted with this unit direction and this
    /// ratio of the index of refraction before to that behind.
    pub fn turned(
        &self,
        ray: &Ray,
        steps: [Vec3; 2],
        normal: Vec3,
        turns: [Vec3; 2],
        refracted: Option<(Vec3, f64)>,
    ) -> Self {
        let (direction, normal) = (ray.direction.as_dvec3(), normal.as_dvec3());
        let before = dot_f64(direction, normal);
        // What the direction, with this weight, moves along the normal, and how that changes with
        // `before`. Mirrored, it leaves as far from the plane as it arrives.
        let (ratio, along, change_along) =
            refracted.map_or((1.0, 2.0 * before, 2.0), |(bent, ratio)| {
                let behind = dot_f64(bent.as_dvec3(), normal);
                (ratio, ratio * before - behind, ratio - ratio * ratio * before / behind)
            });
        let turned = [0, 1].map(|axis| {
            let (change, turn) = (self.direction[axis].as_dvec3(), turns[axis].as_dvec3());
            let cosine_changes = dot_f64(change, normal) + dot_f64(direction, turn);
            let along_changes = change_along * cosine_changes;
            (change * ratio - (turn * along + normal * along_changes)).as_vec3()
        });
        Self { origin: steps, direction: turned }
    }
}

/// How the interpolated normal of a triangle changes with the point.
///
/// `normals` are the values at the `corners`, and `normal` is the interpolated unit normal at
/// `point`, on either side. Zero if the normals cancel out.
pub fn turn_between(
    corners: &[Vec3; 3],
    normals: &[Vec3; 3],
    point: Vec3,
    step: Vec3,
    normal: Vec3,
) -> Vec3 {
    let [a, b, c] = normals.map(|n| n.as_dvec3());
    let [y, z] = weights(corners, point - corners[0]);
    let sum = a * (1.0 - y - z) + b * y + c * z;
    let length = dot_f64(sum, sum).sqrt();
    if length == 0.0 {
        return Vec3::ZERO;
    }
    let [y, z] = weights(corners, step);
    let change = (b - a) * y + (c - a) * z;
    let unit = sum / length;
    let turn = (change - unit * dot_f64(unit, change)) / length;
    if dot_f64(unit, normal.as_dvec3()) < 0.0 { -turn.as_vec3() } else { turn.as_vec3() }
}

/// The change of the texture coordinates for a `step` on a triangle with `uvs` at its `corners`.
pub fn uv_change(corners: &[Vec3; 3], uvs: &[Vec2; 3], step: Vec3) -> Vec2 {
    let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
    let [y, z] = weights(corners, step);
    ((b - a) * y + (c - a) * z).as_vec2()
}

/// The components of `step` along the edges from the first corner to the second and to the third:
/// the changes of their barycentric coordinates.
fn weights(corners: &[Vec3; 3], step: Vec3) -> [f64; 2] {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    let (to_b, to_c, step) = (b - a, c - a, step.as_dvec3());
    let normal = to_b.cross(to_c);
    let area = dot_f64(normal, normal);
    let part = |across: DVec3| dot_f64(across, normal) / area;
    [part(step.cross(to_c)), part(to_b.cross(step))]
}

#[cfg(test)]
mod tests;
