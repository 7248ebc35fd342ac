//! Tiles of coherent rays against brute force.

use glam::Vec3;

use crate::accel::build::Preset;
use crate::accel::tests::{Numbers, brute, bumpy_sphere, cloud, compare};
use crate::accel::{Accel, Hit};
use crate::geometry::Geometry;
use crate::math::ray::Ray;
use crate::math::simd::is_wide;

/// A mesh that shares vertices, loose triangles and spheres, and a quad; some of each are lights.
fn scene(n: u32) -> Geometry {
    let mut numbers = Numbers(100_000);
    let mut geometry = cloud(&mut numbers, 1.8);
    let first = geometry.positions.len() as u32;
    let mesh = bumpy_sphere(n);
    geometry.positions.extend(mesh.positions);
    geometry.triangles.extend(mesh.triangles.into_iter().map(|t| t.map(|v| v + first)));
    let first = geometry.positions.len() as u32;
    geometry.positions.extend([
        Vec3::new(-1.0, -1.0, 0.5),
        Vec3::new(0.0, -1.0, 0.5),
        Vec3::new(0.0, 0.0, 0.6),
        Vec3::new(-1.0, 0.0, 0.5),
    ]);
    geometry.quads.push([first, first + 1, first + 2, first + 3]);
    let (triangles, all) = (geometry.triangles.len() as u32, geometry.len() as u32);
    geometry.passed = vec![1..triangles / 3, triangles..triangles + 1, all - 1..all];
    geometry
}

/// Rays of a camera, in tiles of 8 by 8 pixels; some are cut short, some start later.
fn rays(eye: Vec3, edge: u32) -> Vec<Ray> {
    let mut numbers = Numbers(0);
    (0..edge * edge)
        .map(|i| {
            let (tile, within) = (i / 64, i % 64);
            let across = edge / 8;
            let x = tile % across * 8 + within % 8;
            let y = tile / across * 8 + within / 8;
            let target = Vec3::new(x as f32, y as f32, 0.0) * (3.6 / edge as f32) - 1.8;
            let mut ray = Ray::new(eye, (target - eye).normalize());
            if i % 5 == 0 {
                ray.t_max = 3.5 + numbers.one();
            }
            if i % 7 == 0 {
                ray.t_min = 3.0 + numbers.one();
            }
            ray
        })
        .collect()
}

#[test]
fn rays_of_one_sign_along_each_axis_share_a_tile() {
    let accel = Accel::new(scene(12), Preset::Fast);
    if !is_wide(accel.level) {
        return;
    }
    let mut traversal = accel.traversal();
    // Of two blocks, one has its rays in two directions, the other in one but for a few rays.
    let side = |i: usize| if i < 64 { i % 8 < 3 } else { i == 70 };
    let rays: Vec<_> = (0..128)
        .map(|i| {
            let x = if side(i) { -0.1 } else { 0.1 };
            Ray::new(Vec3::new(0.0, 0.0, 4.0), Vec3::new(x, 0.1 + i as f32 / 1e3, -1.0))
        })
        .collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    accel.closest_of(rays.as_slice(), &mut hits, &mut traversal);
    assert_eq!(traversal.kernels.closest.packet, 127);
    assert_eq!(traversal.kernels.closest.stream, 1);
    for (ray, hit) in rays.iter().zip(&hits) {
        assert_eq!(accel.closest(ray, &mut traversal), *hit);
    }
}

#[test]
fn hc03_coherent_rays_are_answered_as_by_brute_force_at_every_level() {
    for squares in [2, 12, 60] {
        let geometry = scene(squares);
        for eye in [Vec3::new(0.3, -0.2, 4.0), Vec3::new(5.0, 4.0, 3.0), Vec3::new(-6.0, 1.0, 2.0)]
        {
            let mut rays = rays(eye, 40);
            // What no packet takes: beside the others, a ray that cannot be traced.
            rays[700].direction = Vec3::ZERO;
            rays.truncate(1590);
            let (_, occluded) = brute(&geometry, &rays);
            assert!(occluded.contains(&true) && occluded.contains(&false));
            assert!(compare(&format!("{squares} {eye}"), &geometry, &rays) > 200);
        }
    }
}
