//! What the differential of a ray becomes where the ray meets the scene: a footprint in a texture, or
//! the differential of a mirror ray.
//!
//! Both tracers call these functions hit by hit, for trilinear textures and for mirrors alone.

use glam::{Vec2, Vec3};

use super::{Appearance, LookUps, PreparedScene, Shape, Texture, UvMap};
use crate::accel::Hit;
use crate::accel::geometry::{Geometry, Primitive};
use crate::kernels::differential::{Differential, turn_between, uv_change};
use crate::kernels::shade::{self, ShadingPoint};
use crate::kernels::surface::Surface;
use crate::kernels::texture::sphere_uv_change;
use crate::math::float::{dot, normalize};
use crate::math::ray::Ray;
use crate::plan::schedule::Step;

/// A point of a mirror.
#[derive(Clone, Copy, Debug)]
pub struct MirrorPoint {
    /// In world space.
    pub point: Vec3,
    /// Geometric normal of unit length, on the viewer's side.
    pub normal: Vec3,
    /// The normal that the surface is lit with, of unit length, on the viewer's side.
    pub shading_normal: Vec3,
}

impl MirrorPoint {
    /// What a mirror's differentials want of `point`.
    pub fn of(point: &ShadingPoint<f32>) -> Self {
        let ShadingPoint { point, normal, shading_normal, .. } = *point;
        let [point, normal, shading_normal] = [point, normal, shading_normal].map(Vec3::from);
        Self { point, normal, shading_normal }
    }
}

impl Appearance {
    /// How texture coordinates change with the point `surface` of the shape's primitive, by `steps`.
    /// Not finite where a step is not.
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
    /// Whether mirror rays have differentials. Those of camera rays follow from their directions
    /// ([`Camera::differential`](crate::kernels::camera::Camera::differential)) where they are asked
    /// for, and are never kept.
    pub fn carries_differentials(&self) -> bool {
        self.bounces > 0 && self.plan.schedule().runs(Step::Differentials)
    }

    /// The differential of the ray that the mirror at `point` sends on, from that of `ray`, which
    /// arrives there with `hit`.
    pub fn mirrored(
        &self,
        differential: &Differential,
        ray: &Ray,
        hit: &Hit,
        point: &MirrorPoint,
        look_ups: &mut LookUps,
    ) -> Differential {
        look_ups.footprints += 1;
        let MirrorPoint { normal, shading_normal, .. } = *point;
        let steps = differential.at(ray, hit.t, normal);
        let view = -ray.direction;
        let (_, smooth) = shade::mirrored::<f32>(view.into(), shading_normal.into(), normal.into());
        let about = if smooth { shading_normal } else { normal };
        let turns = steps.map(|step| self.turn(hit.primitive, point, step, smooth));
        differential.reflected(ray, steps, about, turns)
    }

    /// How the normal that a mirror turns about changes with its point.
    fn turn(&self, primitive: u32, point: &MirrorPoint, step: Vec3, smooth: bool) -> Vec3 {
        let geometry = self.accel.geometry();
        match geometry.primitive(primitive) {
            Primitive::Sphere(i) => {
                let turn = turn_of_sphere(geometry, primitive, step);
                let outward = point.point - geometry.spheres[i].0;
                if dot(outward, point.normal) < 0.0 { -turn } else { turn }
            }
            Primitive::Triangle(_) | Primitive::Instanced(_) if smooth => {
                let shape = &self.appearance.shapes[self.appearance.shape_of(primitive)];
                let normals = shape
                    .smooth
                    .then(|| self.appearance.normals(shape, geometry, primitive))
                    .flatten();
                let corners = geometry.mesh_triangle(primitive);
                normals.zip(corners).map_or(Vec3::ZERO, |(normals, corners)| {
                    turn_between(&corners, &normals, point.point, step, point.shading_normal)
                })
            }
            Primitive::Triangle(_) | Primitive::Quad(_) | Primitive::Instanced(_) => Vec3::ZERO,
        }
    }
}

/// How the outward normal of a sphere changes with its point; that of anything else does not.
fn turn_of_sphere(geometry: &Geometry, primitive: u32, step: Vec3) -> Vec3 {
    match geometry.primitive(primitive) {
        Primitive::Sphere(i) => step / geometry.spheres[i].1,
        Primitive::Triangle(_) | Primitive::Quad(_) | Primitive::Instanced(_) => Vec3::ZERO,
    }
}
