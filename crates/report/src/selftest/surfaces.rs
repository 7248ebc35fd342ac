//! Rays that start or end on a surface.

use super::aim::BoundingBall;
use super::examine::left;
use super::prelude::*;
use super::ways::hits;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::geometry::Quadric;
use wavecrest_core::kernels::disk::Disk;
use wavecrest_core::kernels::shade::SHADOW_END;
use wavecrest_core::math::float::offset_end;

/// A point with coordinates of either sign and of any magnitude from 1e-8 to 1e8.
fn wide_point(numbers: &mut Numbers) -> Vec3 {
    Vec3::from([(); 3].map(|()| (numbers.sign() * numbers.magnitude(1e-8, 1e8)) as f32))
}

/// Case 9: a triangle, a sphere or a disk, with rays that leave it.
pub(super) fn leaving(numbers: &mut Numbers) -> World {
    let geometry = if numbers.once_in(2) {
        of_triangles([[(); 3].map(|()| wide_point(numbers))])
    } else {
        let (center, radius) = (wide_point(numbers), numbers.magnitude(1e-8, 1e8) as f32);
        let normal = numbers.direction().as_vec3();
        let disk = Quadric::Disk(Disk { center, normal, radius });
        let quadric = numbers.among([Quadric::Sphere(center, radius), disk]);
        Geometry { quadrics: vec![quadric], ..Geometry::default() }
    };
    let extent = BoundingBall::of(&geometry);
    let accel = numbers.effort.accel(geometry.clone(), Preset::VeryFast);
    World::new(geometry, move |numbers| {
        let (ray, _) = left(&accel, &extent, numbers, &mut accel.traversal(), 1e-4)?;
        Some((ray, ExpectedHit::NOTHING))
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
    let expected = if numbers.index.is_multiple_of(2) {
        ExpectedHit::NOTHING
    } else {
        let wide = 2.0 * height;
        add_sheet(&mut geometry, corners(axis * (height + gap), u * wide, v * wide));
        ExpectedHit::ANYTHING
    };
    World::new(geometry, move |numbers| {
        let [point, error, normal] = struck(&lower, numbers)?;
        let light = axis * (11.0 * height) + numbers.direction().as_vec3() * height;
        let origin = offset_origin(point, error, normal, normalize(light - point));
        Some((Ray { t_max: SHADOW_END, ..Ray::new(origin, light - origin) }, expected.clone()))
    })
}

/// Case 11: the segment to a light on a triangle.
pub(super) fn towards_a_triangle(numbers: &mut Numbers) -> Outcome {
    let distance = numbers.magnitude(1e-3, 1e6);
    // Half of them where coordinates, and so their roundings, are large for that distance.
    let far = numbers.among([1.0, 100.0]) * distance;
    let from = (numbers.direction() * (far * (1.0 + numbers.one()))).as_vec3();
    let way = numbers.direction();
    let light = from.as_dvec3() + way * distance;
    // Around the light, and tilted against the way to it.
    let size = distance * numbers.magnitude(1e-3, 1.0);
    let aside = way.cross(numbers.direction()).normalize();
    let (a, b) = ((aside + way * numbers.about(0.25)) * size, way.cross(aside) * size);
    let corners = [light - a - b, light + a - b, light + b * 2.0].map(|v| v.as_vec3());
    let mut accel = numbers.effort.accel(of_triangles([corners]), Preset::VeryFast);
    let Some([point, error, normal]) = struck(&accel, numbers) else { return Outcome::default() };
    let end = offset_end(point, error, normal, normalize(from - point));
    let ray = Ray { t_max: SHADOW_END, ..Ray::new(from, end - from) };
    // Flatter segments run along the light's own surface.
    if normalize(ray.direction).dot(normal).abs() <= 0.1 {
        return Outcome::default();
    }
    let kernels = [KernelChoice::default(), KernelChoice::Reference].map(|kernel| {
        accel.kernel = kernel;
        let (hits, blocked) = hits(&accel, &[ray], &mut accel.traversal());
        Outcome::of(hits[0].is_miss() && !blocked[0], || {
            format!("{ray} is blocked at {} by the light's own {corners:?}", hits[0].t)
        })
    });
    kernels.into_iter().sum()
}

/// Case 11: a floor under a ceiling of four triangles. A light at the vertex that they share, or
/// one of the triangles as a light, is on the ceiling and lights all of the floor.
pub(super) fn under_a_ceiling(numbers: &mut Numbers) -> Vec<Picture> {
    let (turned, size) = (numbers.rotation(), numbers.magnitude(1e-3, 1e3));
    let moved = numbers.direction() * (size * numbers.among([0.0, 10.0, 100.0]));
    // In single precision, so that the lamp is at a vertex.
    let place =
        |x: f64, y: f64, z: f64| (turned * DVec3::new(x, y, z) * size + moved).as_vec3().as_dvec3();
    let around = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)];
    let floor = around.map(|(x, z)| place(x, 0.0, z));
    let floor = scenes::mesh(&floor, &[[0, 1, 2], [0, 2, 3]], scenes::white());
    let lamp = place(numbers.about(0.5), 1.0, numbers.about(0.5));
    let [a, b, c, d] = around.map(|(x, z)| place(x, 1.0, z));
    let fan = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
    let ceiling = scenes::mesh(&[lamp, a, b, c, d], &fan, scenes::white());
    let corners = [lamp, a, b].map(|vertex| vertex.to_array());
    let triangle = json!({"type": "arealight", "intensity": 10, "color": [1, 1, 1],
                          "falloff": "none", "samples": 1,
                          "shape": {"type": "triangle", "points": corners}});
    let size = [numbers.effort.either(17, 33); 2];
    let eye = Eye::at(place(0.0, 0.75, 0.0), 90.0, size);
    let eye = Eye { look: moved, up: turned * DVec3::Z, ..eye };
    let lights = [scenes::point_light(10.0, lamp, "none"), triangle];
    let picture = |light| {
        let scene = scenes::scene(&eye, &[light], &[floor.clone(), ceiling.clone()]);
        Picture::new(scene, |_, _, pixel| Some(pixel != [0.0; 3]))
    };
    lights.map(picture).into()
}

/// Case 12: a plate 64 ulp in front of lights, seen from below.
pub(super) fn just_before_a_light(numbers: &mut Numbers) -> World {
    let ([axis, u, v], height) = axes(numbers);
    let (wide, mut geometry) = (4.0 * height, Geometry::default());
    let center = axis * (height - 64.0 * ulp(height.into()) as f32);
    add_sheet(&mut geometry, corners(center, u * wide, v * wide));
    World::new(geometry, move |numbers| {
        let mut about = |size: f32| numbers.about(1.0) as f32 * size;
        let light = axis * height + u * about(height) + v * about(height);
        let from = axis * about(0.5 * height) + u * about(height) + v * about(height);
        let ray = Ray { t_max: SHADOW_END, ..Ray::new(from, light - from) };
        Some((ray, ExpectedHit::ANYTHING))
    })
}
