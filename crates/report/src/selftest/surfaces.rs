//! Rays that start or end on a surface.

use super::aim::BoundingBall;
use super::examine::left;
use super::prelude::*;
use wavecrest_core::geometry::Quadric;
use wavecrest_core::kernels::disk::Disk;
use wavecrest_core::kernels::shade::SHADOW_END;

/// A point with coordinates of either sign and of any magnitude from 1e-8 to 1e8.
fn wide_point(numbers: &mut Numbers) -> Vec3 {
    Vec3::from([(); 3].map(|()| (numbers.sign() * numbers.magnitude(1e-8, 1e8)) as f32))
}

/// Case 9: a triangle, a floor anywhere, a sphere or a disk, with rays that leave it.
pub(super) fn leaving(numbers: &mut Numbers) -> World {
    let (center, radius) = (wide_point(numbers), numbers.magnitude(1e-8, 1e8) as f32);
    let normal = numbers.direction().as_vec3();
    let mut geometry = Geometry::default();
    match numbers.index % 4 {
        0 => add_triangle(&mut geometry, [(); 3].map(|()| wide_point(numbers))),
        1 => {
            let (u, v) = normal.any_orthonormal_pair();
            add_sheet(&mut geometry, corners(center, u * radius, v * radius));
        }
        2 => geometry.quadrics.push(Quadric::Sphere(center, radius)),
        _ => geometry.quadrics.push(Quadric::Disk(Disk { center, normal, radius })),
    }
    let extent = BoundingBall::of(&geometry);
    let accel = numbers.effort.accel(geometry.clone(), Preset::VeryFast);
    World::new(geometry, ALL_MISS, move |numbers| {
        Some(left(&accel, &extent, numbers, &mut accel.traversal(), 1e-4)?.0)
    })
}

/// One of the axes and the two others, and a height along it from 1e-3 to 1e6.
fn axes(numbers: &mut Numbers) -> ([Vec3; 3], f32) {
    let k = numbers.below(3);
    ([k, (k + 1) % 3, (k + 2) % 3].map(|k| Vec3::AXES[k]), numbers.magnitude(1e-3, 1e6) as f32)
}

/// Where a random ray meets a random triangle of `accel`: the point, its error and the normal.
pub(super) fn struck(accel: &Accel, numbers: &mut Numbers) -> Option<[Vec3; 3]> {
    let number = numbers.below(accel.geometry().triangles.len());
    let target = numbers.within(accel.geometry().triangle(number));
    let eye = (target + numbers.direction() * target.length().max(1e-3)).as_vec3();
    let ray = Ray::new(eye, target.as_vec3() - eye);
    Some(met(accel, &ray, &mut accel.traversal())?.1)
}

/// Case 10: a plate, and in every second world another just above it.
pub(super) fn contact(numbers: &mut Numbers) -> World {
    let ([axis, u, v], height) = axes(numbers);
    let gap = (ulp(height.into()) * (64.0 + 192.0 * numbers.one()).round()) as f32;
    let mut geometry = Geometry::default();
    add_sheet(&mut geometry, corners(axis * height, u * height, v * height));
    let lower = numbers.effort.accel(geometry.clone(), Preset::VeryFast);
    let is_covered = !numbers.index.is_multiple_of(2);
    if is_covered {
        let wide = 2.0 * height;
        add_sheet(&mut geometry, corners(axis * (height + gap), u * wide, v * wide));
    }
    let hits = if is_covered { ALL_HIT } else { ALL_MISS };
    World::new(geometry, hits, move |numbers| {
        let [point, error, normal] = struck(&lower, numbers)?;
        let light = axis * (11.0 * height) + numbers.direction().as_vec3() * height;
        let origin = offset_origin(point, error, normal, normalize(light - point));
        Some(Ray { t_max: SHADOW_END, ..Ray::new(origin, light - origin) })
    })
}

/// Case 12: a plate 64 ulp in front of lights, seen from below.
pub(super) fn just_before_a_light(numbers: &mut Numbers) -> World {
    let ([axis, u, v], height) = axes(numbers);
    let (wide, mut geometry) = (4.0 * height, Geometry::default());
    let center = axis * (height - 64.0 * ulp(height.into()) as f32);
    add_sheet(&mut geometry, corners(center, u * wide, v * wide));
    World::new(geometry, ALL_HIT, move |numbers| {
        let mut about = |size: f32| numbers.about(1.0) as f32 * size;
        let light = axis * height + u * about(height) + v * about(height);
        let from = axis * about(0.5 * height) + u * about(height) + v * about(height);
        Some(Ray { t_max: SHADOW_END, ..Ray::new(from, light - from) })
    })
}
