//! Ray differentials at hits: the footprint in a texture, or the differential of the next ray.
//!
//! Both tracers call these functions hit by hit, only for trilinear textures and for rays that may
//! show them.

use glam::{Vec2, Vec3};

use super::{Appearance, LookUps, PreparedScene, Shape, Texture, UvMap};
use crate::accel::Hit;
use crate::geometry::{Geometry, Primitive};
use crate::kernels::differential::{Differential, turn_between, uv_change};
use crate::kernels::shade::{self, ShadingPoint};
use crate::kernels::surface::Surface;
use crate::kernels::texture::sphere_uv_change;
use crate::kernels::transmission::Refracted;
use crate::math::float::{dot, normalize};
use crate::math::ray::Ray;
use crate::plan::schedule::Step;

impl Appearance {
    /// The changes of texture coordinates if the point `surface` of the shape's primitive moves by
    /// `steps`. Not finite if a step is not.
    pub fn footprint(
        &self,
        texture: &Texture,
        geometry: &Geometry,
        (shape, primitive): (&Shape, u32),
        surface: &Surface<f32>,
        steps: [Vec3; 2],
    ) -> [Vec2; 2] {
        let own = match &texture.map {
            UvMap::Planar(map) => steps.map(|step| map.change(step)),
            UvMap::Sphere(to_own) => {
                let normal = normalize(*to_own * Vec3::from(surface.normal));
                steps.map(|step| {
                    let turn = turn_of_sphere(geometry, primitive, step);
                    sphere_uv_change(normal, *to_own * turn)
                })
            }
            UvMap::Mesh => {
                let uvs = self.uvs(shape, geometry, primitive);
                uvs.zip(geometry.mesh_triangle(primitive))
                    .map_or([Vec2::ZERO; 2], |(uvs, corners)| {
                        steps.map(|step| uv_change(&corners, &uvs, step))
                    })
            }
        };
        texture.placing.map_or(own, |placing| own.map(|change| placing.change(change)))
    }
}

impl PreparedScene {
    /// Whether rays from surfaces have differentials. Those of camera rays follow from their directions
    /// ([`Camera::differential`](crate::kernels::camera::Camera::differential)) and are never
    /// stored.
    pub fn carries_differentials(&self) -> bool {
        let schedule = self.plan.schedule();
        (self.bounces > 0 || schedule.has_transmission()) && schedule.runs(Step::Differentials)
    }

    /// The differential of the mirror ray at `point`, from that of `ray`, which arrives there with
    /// `hit`.
    pub fn mirrored(
        &self,
        differential: &Differential,
        ray: &Ray,
        hit: &Hit,
        point: &ShadingPoint<f32>,
        look_ups: &mut LookUps,
    ) -> Differential {
        let view = -ray.direction;
        let (_, smooth) = shade::mirrored(view.into(), point.shading_normal, point.normal);
        look_ups.footprints += 1;
        self.turned(differential, (ray, hit), point, smooth, None)
    }

    /// The differential of the ray that goes on behind `point`, with this refraction, or straight.
    pub(super) fn transmitted(
        &self,
        differential: &Differential,
        (ray, hit): (&Ray, &Hit),
        point: &ShadingPoint<f32>,
        refracted: Option<&Refracted>,
        look_ups: &mut LookUps,
    ) -> Differential {
        look_ups.footprints += 1;
        match refracted {
            Some(&Refracted { direction, ratio, smooth, .. }) if direction != ray.direction => {
                self.turned(differential, (ray, hit), point, smooth, Some((direction, ratio)))
            }
            _ => Differential {
                origin: differential.at(ray, hit.t, point.normal.into()),
                ..*differential
            },
        }
    }

    /// The differential of the ray that turns at `point` about its interpolated normal if `smooth`, else
    /// about its geometric one: see [`Differential::turned`].
    fn turned(
        &self,
        differential: &Differential,
        (ray, hit): (&Ray, &Hit),
        point: &ShadingPoint<f32>,
        smooth: bool,
        refracted: Option<(Vec3, f64)>,
    ) -> Differential {
        let steps = differential.at(ray, hit.t, point.normal.into());
        let turns = steps.map(|step| self.turn(hit.primitive, point, step, smooth));
        let about = if smooth { point.shading_normal } else { point.normal };
        differential.turned(ray, steps, about.into(), turns, refracted)
    }

    /// The change of the mirror's normal with its point.
    fn turn(&self, primitive: u32, point: &ShadingPoint<f32>, step: Vec3, smooth: bool) -> Vec3 {
        let geometry = self.accel.geometry();
        match geometry.primitive(primitive) {
            Primitive::Quadric(i) => {
                let turn = turn_of_sphere(geometry, primitive, step);
                let outward = Vec3::from(point.point) - geometry.quadrics[i].parts().0;
                if dot(outward, point.normal.into()) < 0.0 { -turn } else { turn }
            }
            Primitive::Triangle(_) | Primitive::Instanced(_) if smooth => {
                let shape = &self.appearance.shapes[self.appearance.shape_of(primitive)];
                let normals = shape
                    .smooth
                    .then(|| self.appearance.normals(shape, geometry, primitive))
                    .flatten();
                let corners = geometry.mesh_triangle(primitive);
                normals.zip(corners).map_or(Vec3::ZERO, |(normals, corners)| {
                    let [at, normal] = [point.point, point.shading_normal].map(Vec3::from);
                    turn_between(&corners, &normals, at, step, normal)
                })
            }
            Primitive::Triangle(_) | Primitive::Quad(_) | Primitive::Instanced(_) => Vec3::ZERO,
        }
    }
}

/// The change of a sphere's outward normal with its point; zero for other primitives.
fn turn_of_sphere(geometry: &Geometry, primitive: u32, step: Vec3) -> Vec3 {
    let Primitive::Quadric(i) = geometry.primitive(primitive) else { return Vec3::ZERO };
    geometry.quadrics[i].sphere().map_or(Vec3::ZERO, |(_, radius)| step / radius)
}
