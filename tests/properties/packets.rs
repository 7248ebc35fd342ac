use glam::Vec3;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Hit};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::is_wide;

use crate::kernels::{Numbers, add_quad, bumpy_sphere, cloud};

/// A mesh that shares vertices, loose triangles and spheres, and a quad; some of each are lights.
pub(crate) fn scene(n: u32) -> Geometry {
    let mut numbers = Numbers(100_000);
    let mut geometry = cloud(&mut numbers, 1.8);
    let first = geometry.positions.len() as u32;
    let mesh = bumpy_sphere(n);
    geometry.positions.extend(&mesh.positions);
    geometry.triangles.extend(mesh.triangles.into_iter().map(|t| t.map(|v| v + first)));
    let corners = [[-1.0, -1.0, 0.5], [0.0, -1.0, 0.5], [0.0, 0.0, 0.6], [-1.0, 0.0, 0.5]];
    add_quad(&mut geometry, corners.map(Vec3::from));
    let (triangles, all) = (geometry.triangles.len() as u32, geometry.len() as u32);
    geometry.passed = vec![1..triangles / 3, triangles..triangles + 1, all - 1..all];
    geometry
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
