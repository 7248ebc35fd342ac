//! Sums over the hits of a pixel's camera rays.

use glam::Vec3;

use super::names::Names;
use crate::camera_rays::Gather;
use wavecrest_core::accel::Hit;
use wavecrest_core::kernels::precision::Arithmetic;
use wavecrest_core::math::float::dot;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::prepared::{Interaction, LookUps, PreparedScene};

/// The sums of a pixel's samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Number of samples that hit something.
    pub(super) hits: u32,
    /// Sums over these.
    pub(super) depth: f64,
    pub(super) normal: [f64; 3],
    pub(super) albedo: [f64; 3],
    pub(super) position: [f64; 3],
    /// Number for the first sample; 0 for nothing.
    pub(super) object: u32,
    pub(super) material: u32,
}

/// Sums the hits of camera rays.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a> {
    pub(super) scene: &'a PreparedScene,
    pub(super) names: &'a Names<'a>,
}

impl Gather for Pass<'_> {
    type Sums = Sums;

    fn add<P: Arithmetic>(&self, ray: &Ray, hit: &Hit, is_first: bool, sums: &mut Sums) {
        let scene = self.scene;
        let Some(Seen { point, normal, albedo }) = Seen::of::<P>(scene, ray, hit) else { return };
        let [_, _, forward] = scene.camera.basis();
        sums.hits += 1;
        sums.depth += f64::from(hit.t) * f64::from(dot(ray.direction, forward));
        add_to(&mut sums.normal, normal.to_array().map(f64::from));
        add_to(&mut sums.albedo, albedo.to_array().map(f64::from));
        add_to(&mut sums.position, (point.as_dvec3() + scene.origin).to_array());
        if is_first {
            let shape = scene.appearance.shape_of(hit.primitive);
            (sums.object, sums.material) = self.names.numbers(shape);
        }
    }
}

/// The visible properties of a hit on a surface or a light.
pub(crate) struct Seen {
    pub(crate) point: Vec3,
    /// The shading normal, on the side of the ray.
    pub(crate) normal: Vec3,
    pub(crate) albedo: Vec3,
}

impl Seen {
    /// The properties of this `hit` of `ray`.
    pub(crate) fn of<P: Arithmetic>(scene: &PreparedScene, ray: &Ray, hit: &Hit) -> Option<Self> {
        let differential = || scene.camera.differential(ray.direction);
        match scene.interaction::<P>(ray, hit, &differential, &mut LookUps::default()) {
            Interaction::Nothing => None,
            Interaction::Surface(at) => Some(Self {
                point: at.point.into(),
                normal: at.shading_normal.into(),
                albedo: at.color.into(),
            }),
            Interaction::Light(albedo) => {
                let surface =
                    wavecrest_core::prepared::surface::<P>(scene.accel.geometry(), ray, hit);
                let normal = towards(ray, surface.normal.into());
                Some(Self { point: surface.point.into(), normal, albedo })
            }
        }
    }
}

/// The normal on the side of the ray's origin.
fn towards(ray: &Ray, normal: Vec3) -> Vec3 {
    if dot(ray.direction, normal) > 0.0 { -normal } else { normal }
}

fn add_to(sum: &mut [f64; 3], value: [f64; 3]) {
    sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value);
}
