//! Rays that start or end on a surface.

use super::aim::BoundingBall;
use super::examine::left;
use super::prelude::*;
use wavecrest_core::geometry::Quadric;
use wavecrest_core::kernels::disk::Disk;
use wavecrest_core::kernels::shade::SHADOW_END;

/// A point with coordinates of either sign and of any magnitude from 1e-8 to 1e8.
fn wide_point(rng: &mut InputRng) -> Vec3 {
    Vec3::from([(); 3].map(|()| (rng.sign() * rng.magnitude(1e-8, 1e8)) as f32))
}

/// Case 9: a triangle, a floor anywhere, a sphere or a disk, with rays that leave it.
pub(super) fn leaving(rng: &mut InputRng) -> World {
    let (center, radius) = (wide_point(rng), rng.magnitude(1e-8, 1e8) as f32);
    let normal = rng.direction().as_vec3();
    let mut geometry = Geometry::default();
    match rng.index % 4 {
        0 => add_triangle(&mut geometry, [(); 3].map(|()| wide_point(rng))),
        1 => {
            let (u, v) = normal.any_orthonormal_pair();
            add_sheet(&mut geometry, corners(center, u * radius, v * radius));
        }
        2 => geometry.quadrics.push(Quadric::Sphere(center, radius)),
        _ => geometry.quadrics.push(Quadric::Disk(Disk { center, normal, radius })),
    }
    let extent = BoundingBall::of(&geometry);
    let accel = rng.effort.accel(geometry.clone(), Preset::VeryFast);
    World::new(geometry, ALL_MISS, move |rng| {
        Some(left(&accel, &extent, rng, &mut accel.traversal(), 1e-4)?.0)
    })
}

/// One of the axes and the two others, and a height along it from 1e-3 to 1e6.
fn axes(rng: &mut InputRng) -> ([Vec3; 3], f32) {
    let k = rng.below(3);
    ([k, (k + 1) % 3, (k + 2) % 3].map(|k| Vec3::AXES[k]), rng.magnitude(1e-3, 1e6) as f32)
}

/// Where a random ray meets a random triangle of `accel`: the point, its error and the normal.
fn struck(accel: &Accel, rng: &mut InputRng) -> Option<[Vec3; 3]> {
    let number = rng.below(accel.geometry().triangles.len());
    let target = rng.within(accel.geometry().triangle(number));
    let eye = (target + rng.direction() * target.length().max(1e-3)).as_vec3();
    let ray = Ray::new(eye, target.as_vec3() - eye);
    Some(met(accel, &ray, &mut accel.traversal())?.1)
}

/// Case 10: a plate, and in every second world another just above it.
pub(super) fn contact(rng: &mut InputRng) -> World {
    let ([axis, u, v], height) = axes(rng);
    let gap = (ulp(height.into()) * (64.0 + 192.0 * rng.one()).round()) as f32;
    let mut geometry = Geometry::default();
    add_sheet(&mut geometry, corners(axis * height, u * height, v * height));
    let lower = rng.effort.accel(geometry.clone(), Preset::VeryFast);
    let is_covered = !rng.index.is_multiple_of(2);
    if is_covered {
        let wide = 2.0 * height;
        add_sheet(&mut geometry, corners(axis * (height + gap), u * wide, v * wide));
    }
    let hits = if is_covered { ALL_HIT } else { ALL_MISS };
    World::new(geometry, hits, move |rng| {
        let [point, error, normal] = struck(&lower, rng)?;
        let light = axis * (11.0 * height) + rng.direction().as_vec3() * height;
        let origin = offset_origin(point, error, normal, normalize(light - point));
        Some(Ray { t_max: SHADOW_END, ..Ray::new(origin, light - origin) })
    })
}

/// Case 12: a plate 64 ulp in front of lights, seen from below.
pub(super) fn just_before_a_light(rng: &mut InputRng) -> World {
    let ([axis, u, v], height) = axes(rng);
    let (wide, mut geometry) = (4.0 * height, Geometry::default());
    let center = axis * (height - 64.0 * ulp(height.into()) as f32);
    add_sheet(&mut geometry, corners(center, u * wide, v * wide));
    World::new(geometry, ALL_HIT, move |rng| {
        let mut about = |size: f32| rng.about(1.0) as f32 * size;
        let light = axis * height + u * about(height) + v * about(height);
        let from = axis * about(0.5 * height) + u * about(height) + v * about(height);
        Some(Ray { t_max: SHADOW_END, ..Ray::new(from, light - from) })
    })
}
