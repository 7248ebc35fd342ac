//! The triangle test against double precision, at edges, in planes and at any size.

use glam::{DVec3, Vec3};

use super::*;
use crate::math::float::gamma;
use crate::math::random::Stream;
use crate::math::ray::Ray;

fn random_point(index: u32, dimension: u32, scale: f32) -> Vec3 {
    let u = Stream { seed: 5, pixel: index, sample: 0, bounce: 0 }.uniform(dimension);
    (Vec3::new(u[0], u[1], u[2]) - 0.5) * scale
}

/// t against the plane's equation in double precision, over sizes and distances.
#[test]
fn t_stays_within_its_stated_bound() {
    let mut hits = 0;
    for i in 0..20_000 {
        let size = [1e-3_f32, 1.0, 1e3][i as usize % 3];
        let triangle = [0, 1, 2].map(|k| random_point(i, k, size));
        if is_degenerate(&triangle) {
            continue;
        }
        let target = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        let origin = random_point(i, 3, 50.0);
        let ray = Ray::new(origin, crate::math::float::normalize(target - origin));
        let Some(t) = meet(&ray, &triangle) else { continue };
        hits += 1;
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let [a, b, c] = triangle.map(|v| v.as_dvec3());
        let n = (b - a).cross(c - a);
        if n.dot(d).abs() < 1e-6 * n.length() {
            continue; // Here the reference itself has lost its digits.
        }
        let exact = n.dot(a - o) / n.dot(d);
        let error = (f64::from(t) - exact).abs();
        assert!(error <= f64::from(gamma(2)) * exact, "{i}: {t} {exact}");
    }
    assert!(hits > 15_000, "{hits}");
}

/// Sizes at which the products of the test vanish in single precision.
#[test]
fn hc08_t_keeps_its_bound_however_small_the_scene() {
    for exponent in -38..0 {
        let scale = 10.0_f64.powi(exponent) as f32;
        for i in 0..200 {
            let triangle = [0, 1, 2].map(|k| random_point(i, k, scale));
            let target = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
            let direction = crate::math::float::normalize(random_point(i, 3, 1.0));
            let ray = Ray::new(target - direction * (3.0 * scale), direction);
            let Some(t) = meet(&ray, &triangle) else { continue };
            let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            let [a, b, c] = triangle.map(|v| v.as_dvec3());
            let n = (b - a).cross(c - a);
            let exact = n.dot(a - o) / n.dot(d);
            if n.normalize().dot(d).abs() > 0.01 {
                let error = (f64::from(t) - exact).abs() / exact;
                assert!(error <= f64::from(gamma(2)), "{exponent} {i}: {t} {exact}");
            }
        }
    }
}

#[test]
fn a_ray_through_a_shared_edge_meets_one_side_or_both() {
    let (a, b) = (Vec3::new(-1.0, 0.3, 0.1), Vec3::new(1.0, -0.2, 0.7));
    let (c, d) = (Vec3::new(0.3, 2.0, -0.4), Vec3::new(-0.1, -2.0, 0.2));
    for i in 0..20_000 {
        // At its ends other triangles would have to be.
        let s = (i + 1) as f32 / 20_002.0;
        // From above, where the two triangles lie on either side of their edge.
        let origin = random_point(i, 0, 2.0) + Vec3::Z * 20.0;
        let ray = Ray::new(origin, a + (b - a) * s - origin);
        let hit = meet(&ray, &[a, b, c]).or(meet(&ray, &[b, a, d]));
        assert!(hit.is_some(), "ray {i}");
    }
}

/// The ray passes some 1e-6 outside the triangle for t from 0.61 to 1.22, which is a hit for
/// single precision, and meets the triangle's plane elsewhere.
#[test]
fn hc19_a_grazing_hit_is_where_the_ray_is_nearest() {
    let corners = [
        Vec3::new(-3.062_986_6, -0.894_475_6, 8.516_521),
        Vec3::new(4.963_964_5, -0.874_327_34, 18.173_862),
        Vec3::new(-5.939_19, -1.012_029, 5.590_315),
    ];
    let origin = Vec3::new(0.106_161_12, -0.847_918_7, 12.142_476);
    let ray = Ray::new(origin, Vec3::new(-3.413_557, -0.071_562_11, -3.801_911_4));
    let t = meet(&ray, &corners);
    assert!(t.is_none_or(|t| (0.6..1.25).contains(&t)), "{t:?}");
}

#[test]
fn a_ray_in_the_plane_misses() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for i in 0..1000 {
        let mut origin = random_point(i, 0, 10.0);
        let mut direction = random_point(i, 1, 1.0);
        (origin.z, direction.z) = (0.0, 0.0);
        assert_eq!(meet(&Ray::new(origin, direction), &triangle), None);
    }
}

#[test]
fn collinear_corners_are_degenerate_and_slivers_are_not() {
    let p = |x: f32, y: f32| Vec3::new(x, y, 3.0 * x);
    assert!(is_degenerate(&[p(0.25, 0.5), p(0.5, 1.0), p(1.0, 2.0)]));
    assert!(is_degenerate(&[p(1.0, 2.0), p(1.0, 2.0), p(4.0, 2.5)]));
    let sliver = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 1e-30, 0.0)];
    assert!(!is_degenerate(&sliver));
}

/// Rounded products of sides this small are zero or wholly wrong, and their sums look like areas.
#[test]
fn the_area_of_a_tiny_triangle_is_judged_exactly() {
    for exponent in [-60, -70, -75, -80] {
        let scale = 2.0_f32.powi(exponent);
        let p = |x: f32, y: f32| Vec3::new(x, y, 3.0 * x) * scale;
        assert!(is_degenerate(&[p(0.25, 0.5), p(0.5, 1.0), p(1.0, 2.0)]), "2^{exponent}");
        assert!(is_degenerate(&[p(0.1, 0.3), p(0.2, 0.6), p(0.4, 1.2)]), "2^{exponent}");
        assert!(!is_degenerate(&[p(0.25, 0.5), p(0.5, 1.0), p(1.0, 2.000_001)]), "2^{exponent}");
    }
}

#[test]
fn barycentric_coordinates_name_the_point() {
    let triangle = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 2.5, 2.0), Vec3::new(2.0, 5.0, 3.5)];
    let point = triangle[0] * 0.5 + triangle[1] * 0.25 + triangle[2] * 0.25;
    let ray = Ray::new(Vec3::new(0.0, 0.0, -9.0), point - Vec3::new(0.0, 0.0, -9.0));
    let b = exact::barycentric(&ray, &triangle).expect("it is not parallel");
    assert!((b - DVec3::new(0.5, 0.25, 0.25)).abs().max_element() < 1e-6, "{b}");
}
