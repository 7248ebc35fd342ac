//! Tiles of coherent rays against brute force.

use glam::Vec3;

use crate::accel::build::Preset;
use crate::accel::{Accel, Hit};
use crate::geometry::{Geometry, Quadric};
use crate::kernels::disk::Disk;
use crate::math::random::Stream;
use crate::math::ray::Ray;
use crate::math::simd::{Level, is_wide};

fn random(index: u32, dimension: u32) -> [f32; 4] {
    Stream { seed: 23, pixel: index, sample: 0, bounce: 0 }.uniform(dimension)
}

/// A bumpy sheet of `n` by `n` squares, as a mesh that shares vertices, with some loose triangles,
/// a quad and a few spheres above; the last sphere is a light.
fn scene(n: u32) -> Geometry {
    let mut geometry = Geometry::default();
    for i in 0..(n + 1) * (n + 1) {
        let (x, y) = ((i % (n + 1)) as f32 / n as f32, (i / (n + 1)) as f32 / n as f32);
        geometry.positions.push(Vec3::new(x, y, 0.1 * random(i, 0)[0]) * 4.0 - 2.0);
    }
    for i in 0..n * n {
        let a = i % n + i / n * (n + 1);
        let (b, c, d) = (a + 1, a + n + 1, a + n + 2);
        geometry.triangles.extend([[a, b, d], [a, d, c]]);
    }
    for i in 0..40 {
        let [x, y, z, _] = random(i, 1);
        let center = Vec3::new(x, y, z) * 3.0 - 1.5;
        let first = geometry.positions.len() as u32;
        for k in 0..3 {
            let [a, b, c, _] = random(i, 2 + k);
            geometry.positions.push(center + (Vec3::new(a, b, c) - 0.5) * 0.4);
        }
        geometry.triangles.push([first, first + 1, first + 2]);
    }
    let first = geometry.positions.len() as u32;
    geometry.positions.extend([
        Vec3::new(-1.0, -1.0, 0.5),
        Vec3::new(0.0, -1.0, 0.5),
        Vec3::new(0.0, 0.0, 0.6),
        Vec3::new(-1.0, 0.0, 0.5),
    ]);
    geometry.quads.push([first, first + 1, first + 2, first + 3]);
    geometry.quadrics.extend([
        Quadric::Sphere(Vec3::new(0.5, 0.5, 0.3), 0.4),
        Quadric::Disk(Disk { center: Vec3::new(0.1, 0.6, 0.4), normal: Vec3::Z, radius: 0.5 }),
        Quadric::Sphere(Vec3::new(0.2, -0.4, 1.5), 0.3),
    ]);
    // Triangles, the quad and a sphere are lights'.
    let (triangles, all) = (geometry.triangles.len() as u32, geometry.len() as u32);
    geometry.lights = vec![1..triangles / 3, triangles..triangles + 1, all - 1..all];
    geometry
}

/// Rays of a camera, in tiles of 8 by 8 pixels; some are cut short, some start later.
fn rays(eye: Vec3, edge: u32) -> Vec<Ray> {
    (0..edge * edge)
        .map(|i| {
            let (tile, within) = (i / 64, i % 64);
            let across = edge / 8;
            let x = tile % across * 8 + within % 8;
            let y = tile / across * 8 + within / 8;
            let target = Vec3::new(x as f32, y as f32, 0.0) * (3.6 / edge as f32) - 1.8;
            let mut ray = Ray::new(eye, (target - eye).normalize());
            if i % 5 == 0 {
                ray.t_max = 3.5 + random(i, 9)[0];
            }
            if i % 7 == 0 {
                ray.t_min = 3.0 + random(i, 9)[1];
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
        let brute = Accel::new(geometry.clone(), Preset::Brute);
        for eye in [Vec3::new(0.3, -0.2, 4.0), Vec3::new(5.0, 4.0, 3.0), Vec3::new(-6.0, 1.0, 2.0)]
        {
            let mut rays = rays(eye, 40);
            // What no packet takes: beside the others, a ray that cannot be traced.
            rays[700].direction = Vec3::ZERO;
            rays.truncate(1590);
            let mut hits = vec![Hit::MISS; rays.len()];
            let mut occluded = vec![false; rays.len()];
            let mut traversal = brute.traversal();
            brute.closest_of(rays.as_slice(), &mut hits, &mut traversal);
            brute.occluded_of(rays.as_slice(), &mut occluded, &mut traversal);
            assert!(hits.iter().filter(|hit| !hit.is_miss()).count() > 200, "{squares} {eye}");
            assert!(occluded.contains(&true) && occluded.contains(&false));
            let mut accel = Accel::new(geometry.clone(), Preset::Fast);
            for level in Level::available() {
                accel.level = level.token().expect("it is available");
                let mut traversal = accel.traversal();
                // Whatever was there before is written over.
                let mut found = vec![Hit { t: 0.5, primitive: 0 }; rays.len()];
                accel.closest_of(rays.as_slice(), &mut found, &mut traversal);
                assert!(found == hits, "{squares} {eye} {level:?}");
                let mut met = vec![true; rays.len()];
                accel.occluded_of(rays.as_slice(), &mut met, &mut traversal);
                assert!(met == occluded, "{squares} {eye} {level:?}");
            }
        }
    }
}
