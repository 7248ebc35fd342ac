//! The differentials of rays that go on from hits.
//!
//! Both tracers call these functions hit by hit, only for rays that may show trilinear textures.

use glam::Vec3;

use super::{LookUps, PreparedScene};
use crate::accel::Hit;
use crate::geometry::Primitive;
use crate::kernels::differential::{Differential, turn_between};
use crate::kernels::shade::{self, ShadingPoint};
use crate::kernels::transmission::Refracted;
use crate::math::float::dot;
use crate::math::ray::Ray;
use crate::plan::schedule::Step;

impl PreparedScene {
    /// Whether rays from surfaces have differentials. Those of camera rays follow from their directions
    /// ([`Camera::differential`](crate::kernels::camera::Camera::differential)) and are never
    /// stored.
    pub fn carries_differentials(&self) -> bool {
        let schedule = self.plan.schedule();
        (self.bounces > 0 || schedule.has_transmission()) && schedule.runs(Step::Differentials)
    }

    /// The differential that a ray carries, or that of a camera ray.
    pub(super) fn arriving(&self, carried: Option<Differential>, ray: &Ray) -> Differential {
        carried.unwrap_or_else(|| self.camera.differential(ray.direction.into()))
    }

    /// The differential of the mirror ray at `point`, from that of `ray`, which arrives there with
    /// `hit`.
    pub fn mirrored(
        &self,
        carried: Option<Differential>,
        ray: &Ray,
        hit: &Hit,
        point: &ShadingPoint<f32>,
        look_ups: &mut LookUps,
    ) -> Differential {
        let view = -ray.direction;
        let (_, smooth) = shade::mirrored(view.into(), point.shading_normal, point.normal);
        look_ups.footprints += 1;
        self.turned(&self.arriving(carried, ray), (ray, hit), point, smooth, None)
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
                origin: differential.at(ray.direction.into(), hit.t, point.normal),
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
        let steps = differential.at(ray.direction.into(), hit.t, point.normal);
        let turns = steps.map(|step| self.turn(hit.primitive, point, step.into(), smooth));
        let about = if smooth { point.shading_normal } else { point.normal };
        differential.turned(ray, steps, about.into(), turns, refracted)
    }

    /// The change of the mirror's normal with its point.
    fn turn(&self, primitive: u32, point: &ShadingPoint<f32>, step: Vec3, smooth: bool) -> Vec3 {
        let geometry = self.accel.geometry();
        match geometry.primitive(primitive) {
            Primitive::Quadric(i) => {
                let turn = geometry.quadrics[i].sphere().map_or(Vec3::ZERO, |(_, r)| step / r);
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
