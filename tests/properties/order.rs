use glam::Vec3;
use proptest::prelude::*;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Hit, KernelChoice};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::math::ray::Ray;

use crate::exact::meeting;
use crate::inputs::{moderate, vector};

type Corners = [Vec3; 3];

fn triangles() -> impl Strategy<Value = Vec<Corners>> {
    let corners = [vector(moderate), vector(moderate), vector(moderate)];
    prop::collection::vec(corners, 1..40)
}

/// Each ray with a number by which it can be sorted into another order.
fn rays() -> impl Strategy<Value = Vec<(Ray, u32)>> {
    let ray = (vector(moderate), vector(moderate)).prop_map(|(o, d)| Ray::new(o, d));
    prop::collection::vec((ray, any::<u32>()), 1..100)
}

fn accel(triangles: &[Corners]) -> Accel {
    let mut geometry = Geometry::default();
    for corners in triangles {
        let first = geometry.positions.len() as u32;
        geometry.positions.extend(corners);
        geometry.triangles.push([first, first + 1, first + 2]);
    }
    Accel::new(geometry, Preset::Fast)
}

fn ask(accel: &Accel, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::MISS; rays.len()];
    accel.closest_of(rays, &mut hits, &mut accel.traversal());
    hits
}

/// A turn of the axes, then a mirror: neither rounds anything.
fn turned(v: Vec3, turns: usize, mirror: [bool; 3]) -> Vec3 {
    let turned = [0, 1, 2].map(|k| v[(k + turns) % 3]);
    Vec3::from([0, 1, 2].map(|k| if mirror[k] { -turned[k] } else { turned[k] }))
}

/// Directions of which no two components are equal in size: which axis is longest is then clear.
fn has_a_longest_axis(ray: &Ray) -> bool {
    let [x, y, z] = ray.direction.abs().to_array();
    x != y && y != z && z != x
}

proptest! {
    #![proptest_config(proptest::test_runner::Config {
        cases: crate::config().cases.div_ceil(10),
        ..crate::config()
    })]

    #[test]
    fn hits_are_the_same_in_every_octant(
        triangles in triangles(), rays in rays(), turns in 0_usize..3, mirror: [bool; 3],
    ) {
        let rays: Vec<Ray> =
            rays.into_iter().map(|(ray, _)| ray).filter(has_a_longest_axis).collect();
        let change = |v| turned(v, turns, mirror);
        let changed: Vec<Corners> = triangles.iter().map(|t| t.map(change)).collect();
        let changed_rays: Vec<Ray> = rays
            .iter()
            .map(|ray| Ray::new(change(ray.origin), change(ray.direction)))
            .collect();
        let (here, there) = (accel(&triangles), accel(&changed));
        prop_assert_eq!(ask(&here, &rays), ask(&there, &changed_rays));
    }

    #[test]
    fn the_order_of_rays_decides_nothing(triangles in triangles(), rays in rays()) {
        let mut accel = accel(&triangles);
        let mut sorted = rays.clone();
        sorted.sort_by_key(|&(_, number)| number);
        for kernel in KernelChoice::ALL {
            accel.kernel = kernel;
            let by_number = |rays: &[(Ray, u32)]| {
                let asked: Vec<Ray> = rays.iter().map(|&(ray, _)| ray).collect();
                let numbers = rays.iter().map(|&(_, number)| number);
                let mut found: Vec<_> = numbers.zip(ask(&accel, &asked)).collect();
                found.sort_by_key(|&(number, hit)| (number, hit.t.to_bits(), hit.primitive));
                found
            };
            prop_assert_eq!(by_number(&rays), by_number(&sorted), "{:?}", kernel);
        }
    }

    #[test]
    fn the_order_of_triangles_decides_ties_alone(
        triangles in triangles(), rays in rays(), shift in 0_usize..40,
    ) {
        let rays: Vec<Ray> = rays.into_iter().map(|(ray, _)| ray).collect();
        let shift = shift % triangles.len();
        let mut rotated = triangles.clone();
        rotated.rotate_left(shift);
        let (here, there) = (ask(&accel(&triangles), &rays), ask(&accel(&rotated), &rays));
        for (i, (hit, other)) in here.iter().zip(&there).enumerate() {
            prop_assert_eq!(hit.t, other.t, "ray {}", i);
            if hit.is_miss() {
                continue;
            }
            let moved = (other.primitive as usize + shift) % triangles.len();
            // At one exact t the lower number wins, and numbers have changed.
            let [t, other_t] =
                [hit.primitive as usize, moved].map(|number| meeting(&rays[i], &triangles[number]));
            prop_assert!(hit.primitive as usize <= moved && t == other_t, "ray {}", i);
        }
    }

    /// A power of two changes exponents and nothing else.
    #[test]
    fn hits_are_the_same_at_every_scale(
        triangles in triangles(), rays in rays(), exponent in -20_i32..=20,
    ) {
        let scale = 2.0_f32.powi(exponent);
        let rays: Vec<Ray> = rays.into_iter().map(|(ray, _)| ray).collect();
        let scaled: Vec<Corners> = triangles.iter().map(|t| t.map(|v| v * scale)).collect();
        let scaled_rays: Vec<Ray> =
            rays.iter().map(|ray| Ray::new(ray.origin * scale, ray.direction * scale)).collect();
        prop_assert_eq!(ask(&accel(&triangles), &rays), ask(&accel(&scaled), &scaled_rays));
    }
}
