//! Rays that start or end on a surface.

use super::prelude::*;
use super::shapes::{add_sheet, corners};
use wavecrest_core::kernels::shade::SHADOW_END;
use wavecrest_core::kernels::surface::Surface;
use wavecrest_core::kernels::triangle::is_degenerate;
use wavecrest_core::math::float::{normalize, offset_end, offset_origin};

/// Rays from each surface of case 9.
const FROM_EACH: u32 = 100;

/// A point with coordinates of either sign and of any magnitude from 1e-8 to 1e8.
fn wide_point(numbers: &mut Numbers) -> Vec3 {
    Vec3::from([(); 3].map(|()| (numbers.sign() * numbers.magnitude(1e-8, 1e8)) as f32))
}

/// A random hit of the triangle.
pub(super) fn on_triangle(
    tests: Tests,
    numbers: &mut Numbers,
    corners: &[Vec3; 3],
) -> Option<Surface<f32>> {
    let target = numbers.within(*corners);
    let origin = (target + numbers.direction() * target.length().max(1e-3)).as_vec3();
    let ray = Ray::new(origin, target.as_vec3() - origin);
    let t = tests.triangle(&ray, corners)?;
    Some(tests.surface(&ray, t, corners))
}

/// Case 9.
pub(super) fn leaving(numbers: &mut Numbers) -> Outcome {
    let tests = Tests::from(&numbers.effort);
    let left = if numbers.once_in(2) {
        let corners = [(); 3].map(|()| wide_point(numbers));
        let surface = (!is_degenerate(&corners)).then(|| on_triangle(tests, numbers, &corners));
        surface.flatten().map(|surface| {
            leave(numbers, &surface, &|ray, _| tests.triangle(ray, &corners), &corners)
        })
    } else {
        let (center, radius) = (wide_point(numbers), numbers.magnitude(1e-8, 1e8) as f32);
        let away = numbers.direction() * (2.0 * f64::from(radius));
        let outside = (center.as_dvec3() + away).as_vec3();
        let ray = Ray::new(outside, center - outside);
        tests.sphere(&ray, center, radius).map(|t| {
            let surface = tests.sphere_surface(&ray, t, (center, radius));
            // Inward rays meet the opposite side.
            let again = |ray: &Ray, is_outward: bool| {
                tests.sphere(ray, center, radius).filter(|_| is_outward)
            };
            leave(numbers, &surface, &again, &(center, radius))
        })
    };
    left.unwrap_or_default()
}

/// Rays leave the surface of `shape` to both sides. `again` returns where they hit it again.
fn leave(
    numbers: &mut Numbers,
    surface: &Surface<f32>,
    again: &dyn Fn(&Ray, bool) -> Option<f32>,
    shape: &dyn std::fmt::Debug,
) -> Outcome {
    let mut outcome = Outcome::default();
    for k in 0..FROM_EACH {
        let tilted = numbers.direction();
        let [point, error, unit] = surface.vectors();
        let normal = unit.as_dvec3();
        // Half of the rays graze the surface.
        let along = tilted - normal * tilted.dot(normal);
        let direction = if k % 2 == 0 { tilted } else { along + normal * 1e-4 };
        let direction = normalize(direction.as_vec3());
        let ray = Ray::new(offset_origin(point, error, unit, direction), direction);
        let cosine = direction.dot(unit);
        if cosine.abs() > 1e-6 && ray.is_valid() {
            let t = again(&ray, cosine > 0.0);
            outcome.check(t.is_none(), || format!("{ray} meets {shape:?} again at {t:?}"));
        }
    }
    outcome
}

fn ulp(size: f32) -> f32 {
    size.next_up() - size
}

/// Case 10: a plate, and in every second world another just above it.
pub(super) fn contact(numbers: &mut Numbers) -> World {
    let (k, height) = (numbers.below(3), numbers.magnitude(1e-3, 1e6) as f32);
    let gap = ulp(height) * (64.0 + 192.0 * numbers.one() as f32).round();
    let [axis, u, v] = [k, (k + 1) % 3, (k + 2) % 3].map(|k| Vec3::AXES[k]);
    let mut geometry = Geometry::default();
    add_sheet(&mut geometry, corners(axis * height, u * height, v * height));
    let lower = [0, 1].map(|half| geometry.triangle(half));
    let expected = if numbers.index.is_multiple_of(2) {
        Expected::Nothing
    } else {
        let wide = 2.0 * height;
        add_sheet(&mut geometry, corners(axis * (height + gap), u * wide, v * wide));
        Expected::ANYTHING
    };
    World::new(geometry, &[Preset::VeryFast], move |numbers| {
        let half = numbers.among(lower);
        let found = on_triangle(Tests::from(&numbers.effort), numbers, &half)?;
        let [point, error, normal] = found.vectors();
        let light = axis * (11.0 * height) + numbers.direction().as_vec3() * height;
        let origin = offset_origin(point, error, normal, normalize(light - point));
        Some((Ray { t_max: SHADOW_END, ..Ray::new(origin, light - origin) }, expected.clone()))
    })
}

/// A triangle around `at`, tilted against `direction`, with sides of about `size`.
fn facing(numbers: &mut Numbers, at: DVec3, direction: DVec3, size: f64) -> [Vec3; 3] {
    let aside = direction.cross(numbers.direction()).normalize();
    let other = direction.cross(aside).normalize();
    let tilt = direction.normalize() * numbers.about(0.25);
    let (a, b) = ((aside + tilt) * size, other * size);
    [at - a - b, at + a - b, at + b * 2.0].map(|v| v.as_vec3())
}

/// Two points at a distance of 1e-3 to 1e6, with coordinates up to a few times that.
fn apart(numbers: &mut Numbers) -> (Vec3, DVec3) {
    let distance = numbers.magnitude(1e-3, 1e6);
    let from = (numbers.direction() * (distance * (1.0 + numbers.one()))).as_vec3();
    (from, from.as_dvec3() + numbers.direction() * distance)
}

/// Case 11: the segment to a light on a triangle.
pub(super) fn towards_a_triangle(numbers: &mut Numbers) -> Outcome {
    let tests = Tests::from(&numbers.effort);
    let (from, light) = apart(numbers);
    let direction = light - from.as_dvec3();
    let size = direction.length() * numbers.magnitude(1e-3, 1.0);
    let corners = facing(numbers, light, direction, size);
    let Some(surface) = on_triangle(tests, numbers, &corners) else { return Outcome::default() };
    let [point, error, normal] = surface.vectors();
    let end = offset_end(point, error, normal, normalize(from - point));
    let ray = Ray { t_max: SHADOW_END, ..Ray::new(from, end - from) };
    // Flatter segments run along the light's own surface.
    if normalize(ray.direction).dot(normal).abs() <= 0.1 {
        return Outcome::default();
    }
    let hit = tests.triangle(&ray, &corners).filter(|&t| t != ray.t_max);
    Outcome::of(hit.is_none(), || {
        format!("{ray} is blocked at {hit:?} by the light's own {corners:?}")
    })
}

/// Case 11: a floor under a ceiling of four triangles. A light at the vertex that they share, or
/// one of the triangles as a light, is on the ceiling and lights all of the floor.
pub(super) fn under_a_ceiling(numbers: &mut Numbers) -> Vec<Picture> {
    let (turned, size) = (numbers.rotation(), numbers.magnitude(1e-3, 1e3));
    let moved = numbers.direction() * (size * numbers.among([0.0, 10.0, 100.0]));
    let place = |x: f64, y: f64, z: f64| turned * DVec3::new(x, y, z) * size + moved;
    let around = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)];
    let floor = around.map(|(x, z)| place(x, 0.0, z).as_vec3());
    let floor = scenes::mesh(&floor, &[[0, 1, 2], [0, 2, 3]], scenes::white());
    let lamp = place(numbers.about(0.5), 1.0, numbers.about(0.5)).as_vec3();
    let mut vertices = around.map(|(x, z)| place(x, 1.0, z).as_vec3()).to_vec();
    vertices.push(lamp);
    let fan = [[4, 0, 1], [4, 1, 2], [4, 2, 3], [4, 3, 0]];
    let ceiling = scenes::mesh(&vertices, &fan, scenes::white());
    let corners = [4, 0, 1].map(|vertex| vertices[vertex].as_dvec3().to_array());
    let triangle = json!({"type": "arealight", "intensity": 10, "color": [1, 1, 1],
                          "falloff": "none", "sampling": "random", "samples": 1,
                          "shape": {"type": "triangle", "points": corners}});
    let eye = Eye {
        location: place(0.0, 0.75, 0.0),
        look: place(0.0, 0.0, 0.0),
        up: turned * DVec3::Z,
        fov: 90.0,
        size: [numbers.effort.either(17, 33); 2],
    };
    let lights = [scenes::point_light(10.0, lamp.as_dvec3(), "none"), triangle];
    let picture = |light| {
        let scene = scenes::scene(&eye, &[light], &[floor.clone(), ceiling.clone()]);
        Picture::new(scene, |_, _, pixel| Some(pixel != [0.0; 3]))
    };
    lights.map(picture).into()
}

/// Case 12.
pub(super) fn just_before_a_light(numbers: &mut Numbers) -> Outcome {
    let tests = Tests::from(&numbers.effort);
    let (from, light) = apart(numbers);
    let light = light.as_vec3();
    let direction = light.as_dvec3() - from.as_dvec3();
    let size = light.abs().max_element().max(from.abs().max_element());
    let before = direction.normalize() * (64.0 * f64::from(ulp(size)));
    // Perpendicular, so that all of it is equally far before the light.
    let corners = facing(numbers, DVec3::ZERO, direction, f64::from(size)).map(|corner| {
        let corner = corner.as_dvec3();
        let upright = corner - direction * corner.dot(direction) / direction.length_squared();
        (upright + light.as_dvec3() - before).as_vec3()
    });
    let ray = Ray { t_max: SHADOW_END, ..Ray::new(from, light - from) };
    let hit = tests.triangle(&ray, &corners).filter(|&t| t < ray.t_max);
    Outcome::of(hit.is_some(), || format!("{ray} is not blocked by {corners:?}"))
}
