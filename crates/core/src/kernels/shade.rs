//! The shading step that both tracers take at every hit.
//!
//! It returns requests and never traces: light that is there at once ([`local_light`]), a shadow
//! ray for each point of each light with what it adds if nothing is in the way
//! ([`shadow_request`]), and the mirror ray ([`mirror`]). Whitted, *An Improved Illumination Model
//! for Shaded Display* (1980).

pub mod lanes;

use glam::Vec3;

use super::blinn_phong::{self, Material};
use super::light::{Light, LightPoint};
use crate::math::float::{dot, gamma, max_abs, normalize, offset_end, offset_origin};
use crate::math::ray::Ray;

/// A hit made ready to be shaded.
#[derive(Clone, Copy, Debug)]
pub struct ShadingPoint {
    /// The point, in world space.
    pub point: Vec3,
    /// Bound on its rounding error, for each coordinate.
    pub error: Vec3,
    /// Geometric normal of unit length, on the viewer's side.
    pub normal: Vec3,
    /// The normal that the surface is lit with, of unit length, on the viewer's side.
    pub shading_normal: Vec3,
    /// Direction to where the ray came from, of unit length.
    pub view: Vec3,
    /// Diffuse colour, from the material or a texture.
    pub color: Vec3,
    /// What the surface is made of.
    pub material: Material,
    /// Whether lights reach this side.
    pub lit: bool,
}

/// A shadow ray and what it is worth.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRequest {
    /// From the surface, t = 1 at the light.
    pub ray: Ray,
    /// What to add if nothing is on it.
    pub contribution: Vec3,
    /// Whether the light is nearer than the point's own error, so that its distance was taken to
    /// be that error.
    pub at_light: bool,
}

/// The light a hit shows without any ray: the ambient part of all lights together.
#[inline]
pub fn local_light(point: &ShadingPoint, ambient: f32) -> Vec3 {
    point.color * ambient
}

/// Where a shadow ray ends, in parts of the way to the light.
///
/// The segment's direction is rounded, so that its end lies up to gamma(2) of its length off the
/// light. A surface that holds the light must not occlude it: this end is before any that the
/// segment meets at more than 4 degrees, and an occluder 32 ulp before the light is still met.
pub const SHADOW_END: f32 = 1.0 - 16.0 * gamma(2);

/// The shadow ray to `target`, a point of `light`, unless it could add nothing: the light is
/// behind the surface, has no strength, or is not reflected to the viewer.
///
/// A light on the surface itself would be infinitely strong. Its distance is taken to be at least
/// the point's error bound; at no distance at all it has no direction and adds nothing.
#[inline]
pub fn shadow_request(
    point: &ShadingPoint,
    throughput: Vec3,
    light: &Light,
    target: &LightPoint,
) -> Option<ShadowRequest> {
    let towards = target.position - point.point;
    let to_light = normalize(towards);
    if !point.lit || dot(point.normal, to_light) <= 0.0 {
        return None;
    }
    let least = max_abs(point.error);
    let distance = dot(towards, towards).sqrt();
    let reflected = blinn_phong::reflect(
        &point.material,
        point.color,
        point.shading_normal,
        point.view,
        to_light,
    );
    let strength = light.falloff.at(distance.max(least)) / light.samples() as f32;
    let contribution = throughput * (reflected * (light.power * strength));
    if contribution == Vec3::ZERO {
        return None;
    }
    let origin = offset_origin(point.point, point.error, point.normal, to_light);
    let end = offset_end(target.position, target.error, target.normal, -to_light);
    let ray = Ray { t_max: SHADOW_END, ..Ray::new(origin, end - origin) };
    // Where the ray starts at the light itself it has no direction, and nothing is on it.
    let is_finite = ray.origin.is_finite() && ray.direction.is_finite();
    is_finite.then_some(ShadowRequest { ray, contribution, at_light: distance < least })
}

/// The mirror ray and its throughput, if the surface is a mirror on this side and what comes back
/// can still count.
#[inline]
pub fn mirror(point: &ShadingPoint, throughput: Vec3) -> Option<(Ray, Vec3)> {
    if !point.lit || point.material.kr <= 0.0 {
        return None;
    }
    let (direction, _) = mirrored(point.view, point.shading_normal, point.normal);
    let weight = throughput * point.material.kr;
    if weight == Vec3::ZERO {
        return None;
    }
    let origin = offset_origin(point.point, point.error, point.normal, direction);
    let ray = Ray::new(origin, direction);
    ray.is_valid().then_some((ray, weight))
}

/// `view` turned about the shading normal, and whether it was that; else about the geometric normal.
/// An interpolated normal can send the ray into the surface, where the geometric one cannot.
#[inline]
pub fn mirrored(view: Vec3, shading_normal: Vec3, normal: Vec3) -> (Vec3, bool) {
    let smooth = reflection(view, shading_normal);
    if dot(smooth, normal) > 0.0 { (smooth, true) } else { (reflection(view, normal), false) }
}

/// `view` turned about `normal`, of unit length.
#[inline]
fn reflection(view: Vec3, normal: Vec3) -> Vec3 {
    normalize(normal * (2.0 * dot(view, normal)) - view)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::light::{Emitter, Falloff};
    use crate::math::random::Stream;
    use crate::math::sampling::Sampling;

    fn point() -> ShadingPoint {
        ShadingPoint {
            point: Vec3::ZERO,
            error: Vec3::splat(1e-6),
            normal: Vec3::Y,
            shading_normal: Vec3::Y,
            view: normalize(Vec3::new(1.0, 1.0, 0.0)),
            color: Vec3::ONE,
            material: Material { ks: 0.0, kd: 1.0, exponent: 1.0, color: Vec3::ONE, kr: 0.5 },
            lit: true,
        }
    }

    fn light(position: Vec3) -> Light {
        Light {
            emitter: Emitter::Point(position),
            power: Vec3::splat(10.0),
            falloff: Falloff::InverseSquare,
            sampling: Sampling::Random,
            grid: [1, 1],
            dimension: 1,
        }
    }

    fn request(point: &ShadingPoint, target: Vec3) -> Option<ShadowRequest> {
        let light = light(target);
        let stream = Stream { seed: 0, pixel: 0, sample: 0, bounce: 0 };
        shadow_request(point, Vec3::ONE, &light, &light.point(0, &stream))
    }

    #[test]
    fn a_light_overhead_adds_its_falloff() {
        let r = request(&point(), Vec3::Y * 2.0).expect("a request");
        assert!((r.contribution.x - 10.0 / (16.0 * std::f32::consts::PI)).abs() < 1e-6);
        assert!(!r.at_light && r.ray.origin.y > 0.0 && r.ray.t_max < 1.0);
    }

    #[test]
    fn no_ray_is_cast_that_could_add_nothing() {
        assert!(request(&point(), Vec3::NEG_Y).is_none(), "behind");
        assert!(request(&ShadingPoint { lit: false, ..point() }, Vec3::Y).is_none(), "unlit side");
        let black = ShadingPoint { color: Vec3::ZERO, ..point() };
        assert!(request(&black, Vec3::Y).is_none(), "black");
    }

    #[test]
    fn hc32_a_light_on_the_surface_is_finite() {
        for height in [0.0, 1e-30, 1e-9, 1e-7] {
            if let Some(r) = request(&point(), Vec3::Y * height) {
                assert!(r.contribution.is_finite() && r.at_light, "{height}");
            }
        }
    }

    #[test]
    fn hc32_a_light_where_the_ray_starts_is_not_left_out() {
        let point = point();
        let origin = offset_origin(point.point, point.error, point.normal, Vec3::Y);
        let r = request(&point, origin).expect("a request");
        assert!(r.ray.direction == Vec3::ZERO && r.contribution.min_element() > 0.0, "{r:?}");
    }

    #[test]
    fn hc33_a_mirror_ray_never_enters_the_surface() {
        let leaning = ShadingPoint {
            shading_normal: normalize(Vec3::new(1.0, 0.1, 0.0)),
            view: normalize(Vec3::new(-1.0, 0.2, 0.0)),
            ..point()
        };
        let (ray, throughput) = mirror(&leaning, Vec3::ONE).expect("a mirror ray");
        assert!(ray.direction.y > 0.0);
        assert_eq!(throughput, Vec3::splat(0.5));
    }
}
