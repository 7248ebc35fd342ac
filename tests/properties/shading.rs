use std::f64::consts::PI;

use glam::Vec3;
use proptest::prelude::*;
use wavecrest_core::kernels::blinn_phong::{Material, reflect};
use wavecrest_core::kernels::light::{Emitter, Falloff, Light, Triangles};
use wavecrest_core::kernels::shade::{ShadingPoint, ShadowRequest, shadow_request};
use wavecrest_core::math::float::{max_abs, normalize};
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::sampling::Sampling;
use wavecrest_core::math::vector::Vector;

use crate::inputs::{magnitude, moderate, unit, vector};

/// The power of the lights.
const POWER: f32 = 10.0;

/// A material that reflects at most all of their light.
const MATERIAL: Material =
    Material { ks: 0.5, kd: 0.5, exponent: 8.0, color: Vec3::ONE, ..Material::BLACK };

/// A point of a surface, with its error, seen from the front; the normal for shading may be any.
fn point() -> impl Strategy<Value = ShadingPoint<f32>> {
    (vector(moderate), unit(), unit(), prop::option::of(unit())).prop_map(
        |(point, normal, view, smooth)| {
            let error = Vector::from(point).rounding_error(max_abs(point).max(f32::MIN_POSITIVE));
            let view = if view.dot(normal) < 0.0 { -view } else { view };
            let shading_normal = smooth.unwrap_or(normal).into();
            ShadingPoint {
                shading_normal,
                ..ShadingPoint::plain([point, error.into(), normal], view, &MATERIAL)
            }
        },
    )
}

fn falloff() -> impl Strategy<Value = Falloff> {
    (0..Falloff::ALL.len()).prop_map(|i| Falloff::ALL[i])
}

/// The shadow ray from a point to a light.
fn request(
    point: &ShadingPoint<f32>,
    emitter: Emitter,
    falloff: Falloff,
    pixel: u32,
) -> Option<ShadowRequest<f32>> {
    let (power, sampling) = (Vec3::splat(POWER), Sampling::Jittered);
    let light = Light { emitter, power, falloff, sampling, grid: [1, 1], dimension: 1 };
    let stream = Stream { seed: 0, pixel, sample: 0, bounce: 0 };
    shadow_request(point, Vec3::ONE.into(), &light, &light.point(0, &stream), None)
}

proptest! {
    #![proptest_config(crate::config())]

    /// The light may be at the point itself, or within a few of its rounding errors: it is no
    /// brighter than from the distance of that error, and lights no back, whatever the smooth normal.
    #[test]
    fn hc32_a_light_at_a_point_is_as_bright_as_at_its_error(
        point in point(), direction in unit(), falloff in falloff(),
        away in prop_oneof![Just(0.0), magnitude(-10, 4), magnitude(4, 40)],
    ) {
        let least = point.error.max_abs();
        let at = Vec3::from(point.point);
        let position = at + direction * (least * away.abs());
        let towards = position.as_dvec3() - at.as_dvec3();
        let (distance, least) = (towards.length(), f64::from(least));
        let height = Vec3::from(point.normal).as_dvec3().dot(towards);
        let Some(request) = request(&point, Emitter::Point(position), falloff, 0) else {
            let smooth = Vec3::from(point.shading_normal).as_dvec3().dot(towards);
            prop_assert!(height.min(smooth) <= 1e-5 * distance, "{} of {}", height, distance);
            return Ok(());
        };
        prop_assert!(height >= -1e-5 * distance, "{} of {}", height, distance);
        let counts = distance.max(least);
        let part = match falloff {
            Falloff::Linear => 1.0 / (4.0 * PI * counts),
            Falloff::InverseSquare => 1.0 / (4.0 * PI * counts * counts),
            Falloff::None => 1.0,
        };
        let found = Vec3::from(request.contribution);
        prop_assert!(found.is_finite() && found.min_element() >= 0.0, "{}", found);
        let most = 1.0001 * f64::from(POWER) * part;
        prop_assert!(f64::from(found.max_element()) <= most, "{} and not {}", found, most);
        let is_doubtful = (distance / least - 1.0).abs() < 1e-5;
        prop_assert!(request.at_light == (distance < least) || is_doubtful);
    }

    /// A triangle that contains the point or has it in its plane, or that is a needle.
    #[test]
    fn hc31_a_light_seen_edge_on_is_finite(
        point in point(), directions in (unit(), unit(), unit()), kind in 0..4, size in magnitude(-10, 10),
        falloff in falloff(), pixel: u32,
    ) {
        let near = Vec3::from(point.point);
        let [p, q] = [directions.0, directions.1].map(|way| near + way * size);
        let shape = match kind {
            0 => [p, q, p + (p - near)],
            1 => [near, p, q],
            2 => [near, p, near + (q - near).reject_from(Vec3::from(point.normal))],
            _ => [p, q, q + directions.2 * (1e-6 * size)],
        };
        let Some(triangles) = Triangles::new(vec![shape]) else { return Ok(()) };
        if let Some(request) = request(&point, Emitter::Triangles(triangles), falloff, pixel) {
            let found = Vec3::from(request.contribution);
            prop_assert!(found.is_finite() && found.min_element() >= 0.0, "{}", found);
            prop_assert!(request.ray().direction.is_finite(), "{:?}", request.ray());
        }
    }

    /// Light and view from extreme directions, exponents of any size: no more light than arrives.
    #[test]
    fn hc36_a_material_reflects_at_most_what_it_is_given(
        normal in unit(), views in (unit(), any::<bool>()), lights in (unit(), 0_usize..4, magnitude(-30, -16)),
        ks in 0.0_f32..=1.0, kd in 0.0_f32..=1.0,
        exponent in prop_oneof![magnitude(-20, 20), Just(0.0), Just(1e6), Just(999_999.5)],
    ) {
        let view = if views.1 { normal } else { views.0 };
        let (any, kind, nearly) = lights;
        let to_light = [-view, normalize(any * nearly - view), view, any][kind];
        let exponent = exponent.abs().min(1e6);
        let material = Material { ks, kd, exponent, ..MATERIAL }.reflection();
        let [at, from, to] = [normal, view, to_light].map(Vector::from);
        let found = Vec3::from(reflect(&material, Vec3::ONE.into(), at, from, to));
        prop_assert!(found.is_finite() && found.min_element() >= 0.0, "{}", found);
        let most = 1.000_01 * f64::from(ks + kd);
        prop_assert!(f64::from(found.max_element()) <= most, "{} and not {}", found, most);
    }
}
