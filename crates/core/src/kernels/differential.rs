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

use glam::Vec3;

use crate::math::float::dot_f64;
use crate::math::ray::Ray;
use crate::math::real::{Single, both};
use crate::math::vector::Vector;

/// The derivatives of a ray, or of a ray in each lane, for a step to the right and one down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differential<F = f32> {
    /// Of the origin, in scene units per sample.
    pub origin: [Vector<F>; 2],
    /// Of the unit direction.
    pub direction: [Vector<F>; 2],
}

impl<F: Single> Differential<F> {
    /// The changes of the points at `t` of rays in these directions on surfaces with these geometric
    /// normals, on either side: neighbouring rays meet the plane through the point.
    #[inline(always)]
    pub fn at(&self, direction: Vector<F>, t: F, normal: Vector<F>) -> [Vector<F>; 2] {
        let (ahead, normal, t) = (direction.widen(), normal.widen(), t.widen());
        let towards = ahead.dot(normal);
        let ([right, down], [turn_right, turn_down]) = (self.origin, self.direction);
        both(
            [(right, turn_right), (down, turn_down)],
            #[inline(always)]
            |(origin, direction)| {
                let sideways = origin.widen() + direction.widen().scale(t);
                let farther = -sideways.dot(normal) / towards;
                Vector::narrow(sideways + ahead.scale(farther))
            },
        )
    }

    /// Replaces the differential in lane `i`.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, of: &Differential) {
        let Differential { origin, direction } = of;
        let own = self.origin.iter_mut().chain(&mut self.direction);
        own.zip(origin.iter().chain(direction)).for_each(|(own, of)| own.set_lane(i, (*of).into()));
    }
}

impl Differential {
    /// That of a ray without width.
    pub fn none() -> Self {
        let still = [Vec3::ZERO.into(); 2];
        Self { origin: still, direction: still }
    }

    /// The differential of the ray that `ray` becomes about the unit vector `normal`, if points change
    /// by `steps` and the normal by `turns`: mirrored, or refracted with this unit direction and this
    /// ratio of the index of refraction before to that behind.
    pub fn turned(
        &self,
        ray: &Ray,
        steps: [Vector<f32>; 2],
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
            let change = Vec3::from(self.direction[axis]).as_dvec3();
            let turn = turns[axis].as_dvec3();
            let cosine_changes = dot_f64(change, normal) + dot_f64(direction, turn);
            let along_changes = change_along * cosine_changes;
            (change * ratio - (turn * along + normal * along_changes)).as_vec3().into()
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
    let corners = corners.map(Vector::from);
    let [y, z] = weights(&corners, (point - Vec3::from(corners[0])).into());
    let sum = a * (1.0 - y - z) + b * y + c * z;
    let length = dot_f64(sum, sum).sqrt();
    if length == 0.0 {
        return Vec3::ZERO;
    }
    let [y, z] = weights(&corners, step.into());
    let change = (b - a) * y + (c - a) * z;
    let unit = sum / length;
    let turn = (change - unit * dot_f64(unit, change)) / length;
    if dot_f64(unit, normal.as_dvec3()) < 0.0 { -turn.as_vec3() } else { turn.as_vec3() }
}

/// The changes of texture coordinates for a `step` on triangles with `uvs` at their `corners`.
#[inline(always)]
pub fn uv_change<F: Single>(
    corners: &[Vector<F>; 3],
    uvs: &[[F; 2]; 3],
    step: Vector<F>,
) -> [F; 2] {
    let [[au, av], [bu, bv], [cu, cv]] = *uvs;
    let [y, z] = weights(corners, step);
    both(
        [[au, bu, cu], [av, bv, cv]],
        #[inline(always)]
        |[a, b, c]| {
            let a = a.widen();
            F::narrow((b.widen() - a) * y + (c.widen() - a) * z)
        },
    )
}

/// The components of `step` along the edges from the first corner to the second and to the third:
/// the changes of their barycentric coordinates.
#[inline(always)]
fn weights<F: Single>([a, b, c]: &[Vector<F>; 3], step: Vector<F>) -> [F::Double; 2] {
    let (a, b, c, step) = (a.widen(), b.widen(), c.widen(), step.widen());
    let (to_b, to_c) = (b - a, c - a);
    let normal = to_b.cross(to_c);
    let area = normal.dot(normal);
    [step.cross(to_c).dot(normal) / area, to_b.cross(step).dot(normal) / area]
}

#[cfg(test)]
mod tests;
