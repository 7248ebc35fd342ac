//! The shading step at eight hits at a time: the operations of [`super`] in each lane, and so the
//! same bits.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};
use glam::Vec3;

use crate::kernels::blinn_phong::lanes::{Reflection, reflect};
use crate::kernels::light::{Falloff, Light};
use crate::math::lanes::Vec3x8;
use crate::math::simd::Lanes;

/// As [`super::ShadingPoint`], in each lane; every one is on a side that lights reach.
#[derive(Clone, Copy)]
pub struct LitPoints<S: Lanes> {
    /// The points, in world space.
    pub point: Vec3x8<S>,
    /// Bounds on their rounding errors, for each coordinate.
    pub error: Vec3x8<S>,
    /// Geometric normals of unit length, on the viewer's side.
    pub normal: Vec3x8<S>,
    /// The normals that surfaces are lit with, of unit length, on the viewer's side.
    pub shading_normal: Vec3x8<S>,
    /// Directions to where the rays came from, of unit length.
    pub view: Vec3x8<S>,
    /// Diffuse colours.
    pub color: Vec3x8<S>,
    /// What light from here counts for in its path.
    pub throughput: Vec3x8<S>,
    /// How light is reflected.
    pub reflection: Reflection<S>,
}

/// As [`crate::kernels::light::LightPoint`], in each lane.
#[derive(Clone, Copy)]
pub struct LightPoints<S: Lanes> {
    /// In world space.
    pub position: Vec3x8<S>,
    /// Bounds on the distance to the exact shape, for each coordinate.
    pub error: Vec3x8<S>,
    /// Normals of the shape, of unit length; zero for a point light.
    pub normal: Vec3x8<S>,
}

/// As [`super::ShadowRequest`], in each lane.
#[derive(Clone, Copy)]
pub struct ShadowRequests<S: Lanes> {
    /// Where the rays start.
    pub origin: Vec3x8<S>,
    /// To the light.
    pub direction: Vec3x8<S>,
    /// What to add if nothing is on the ray.
    pub contribution: Vec3x8<S>,
    /// Where the light is nearer than the point's own error.
    pub at_light: mask32x8<S>,
    /// Where there is a request.
    pub asked: mask32x8<S>,
}

/// See [`super::shadow_request`].
#[inline(always)]
pub fn shadow_requests<S: Lanes>(
    points: &LitPoints<S>,
    light: &Light,
    target: &LightPoints<S>,
) -> ShadowRequests<S> {
    let towards = target.position - points.point;
    let to_light = towards.normalize();
    let in_front = points.normal.dot(to_light).simd_gt(0.0);
    let least = points.error.max_abs();
    let distance = towards.dot(towards).sqrt();
    let reflected =
        reflect(&points.reflection, points.color, points.shading_normal, points.view, to_light);
    let strength = falloff(light.falloff, distance.max(least)) / light.samples() as f32;
    let power = Vec3x8::splat(least.token(), light.power).scale(strength);
    let contribution = points.throughput * (reflected * power);
    let origin = points.point.offset_origin(points.error, points.normal, to_light);
    let end = target.position.offset_end(target.error, target.normal, -to_light);
    let direction = end - origin;
    let finite = origin.is_finite() & direction.is_finite();
    let at_light = distance.simd_lt(least);
    let asked = in_front & contribution.is_not_zero() & finite;
    ShadowRequests { origin, direction, contribution, at_light, asked }
}

/// See [`Falloff::at`].
#[inline(always)]
fn falloff<S: Lanes>(falloff: Falloff, distance: f32x8<S>) -> f32x8<S> {
    let one = f32x8::splat(distance.token(), 1.0);
    let around = f32x8::splat(distance.token(), 4.0 * std::f32::consts::PI);
    match falloff {
        Falloff::Linear => one / (around * distance),
        Falloff::InverseSquare => one / (around * distance * distance),
        Falloff::None => one,
    }
}

/// See [`crate::math::ray::Ray::is_valid`].
#[inline(always)]
fn is_valid<S: Lanes>(origin: Vec3x8<S>, direction: Vec3x8<S>) -> mask32x8<S> {
    origin.is_finite() & direction.is_finite() & direction.is_not_zero()
}

/// Mirror rays, in each lane.
#[derive(Clone, Copy)]
pub struct Mirrored<S: Lanes> {
    /// Where the rays start.
    pub origin: Vec3x8<S>,
    /// Where they go, of unit length.
    pub direction: Vec3x8<S>,
    /// What they count for.
    pub throughput: Vec3x8<S>,
    /// Where there is a ray.
    pub asked: mask32x8<S>,
}

/// See [`super::mirror`], at points that lights reach. `kr` is the weight of each mirror.
#[inline(always)]
pub fn mirrors<S: Lanes>(points: &LitPoints<S>, kr: f32x8<S>) -> Mirrored<S> {
    let LitPoints { view, normal, .. } = *points;
    let smooth = reflection(view, points.shading_normal);
    let enters = !smooth.dot(normal).simd_gt(0.0);
    let direction = if enters.to_bitmask() & 0xFF == 0 {
        smooth
    } else {
        reflection(view, normal).or(enters, smooth)
    };
    let throughput = points.throughput.scale(kr);
    let origin = points.point.offset_origin(points.error, normal, direction);
    let asked = kr.simd_gt(0.0) & throughput.is_not_zero() & is_valid(origin, direction);
    Mirrored { origin, direction, throughput, asked }
}

/// See [`super::reflection`].
#[inline(always)]
fn reflection<S: Lanes>(view: Vec3x8<S>, normal: Vec3x8<S>) -> Vec3x8<S> {
    (normal.scale(view.dot(normal) * 2.0) - view).normalize()
}

impl<S: Lanes> LightPoints<S> {
    /// A point light at `position`.
    #[inline(always)]
    pub fn same(simd: S, position: Vec3) -> Self {
        let zero = Vec3x8::splat(simd, Vec3::ZERO);
        Self { position: Vec3x8::splat(simd, position), error: zero, normal: zero }
    }
}
