//! Rays that start or end on a surface.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde_json::json;

use super::case::{Effort, Outcome};
use super::planes::rotation;
use super::scenes::{self, Eye, every_image, pixels};
use super::ways::{Numbers, Tests, every_way, in_order, inputs};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::shade::SHADOW_END;
use wavecrest_core::kernels::surface::Surface;
use wavecrest_core::kernels::triangle::is_degenerate;
use wavecrest_core::math::float::{normalize, offset_end, offset_origin};
use wavecrest_core::math::ray::Ray;

/// Rays from each surface of case 9.
const FROM_EACH: u32 = 100;

/// Runs `count` tests on all threads. `ask` describes the error for each input, if any; `None` for
/// inputs that are skipped.
fn each(
    effort: &Effort,
    case: u32,
    count: usize,
    ask: impl Fn(&mut Numbers) -> Option<Outcome> + Sync,
) -> Outcome {
    let ask = |n: usize| ask(&mut Numbers::new(effort, case, n));
    in_order((0..count).into_par_iter().filter_map(ask))
}

/// A number of either sign, of any magnitude from 1e-8 to 1e8.
fn wide(numbers: &mut Numbers) -> f64 {
    numbers.sign() * numbers.magnitude(1e-8, 1e8)
}

fn wide_point(numbers: &mut Numbers) -> DVec3 {
    DVec3::from([(); 3].map(|()| wide(numbers)))
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
pub(super) fn leaving(effort: &Effort) -> Outcome {
    let tests = Tests::of(effort);
    each(effort, 9, effort.of(1_000_000), |numbers| {
        if numbers.below(2) == 0 {
            let corners = [(); 3].map(|()| wide_point(numbers).as_vec3());
            if is_degenerate(&corners) {
                return None;
            }
            let surface = on_triangle(tests, numbers, &corners)?;
            Some(leave(numbers, &surface, |ray, _| {
                tests.triangle(ray, &corners).map(|t| format!("{corners:?} at {t}"))
            }))
        } else {
            let center = wide_point(numbers).as_vec3();
            let radius = numbers.magnitude(1e-8, 1e8) as f32;
            let away = numbers.direction() * (2.0 * f64::from(radius));
            let outside = (center.as_dvec3() + away).as_vec3();
            let ray = Ray::new(outside, center - outside);
            let t = tests.sphere(&ray, center, radius)?;
            let surface = tests.sphere_surface(&ray, t, center, radius);
            Some(leave(numbers, &surface, |ray, is_outward| {
                // Inward rays meet the opposite side.
                let t = tests.sphere(ray, center, radius).filter(|_| is_outward)?;
                Some(format!("sphere {center} {radius} at {t}"))
            }))
        }
    })
}

/// Rays leave the surface to both sides. `again` returns what they hit again.
fn leave(
    numbers: &mut Numbers,
    surface: &Surface<f32>,
    again: impl Fn(&Ray, bool) -> Option<String>,
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
        let origin = offset_origin(point, error, unit, direction);
        let ray = Ray::new(origin, direction);
        let cosine = direction.dot(unit);
        if cosine.abs() > 1e-6 && ray.is_valid() {
            let context = |what| format!("{ray} meets {what} again");
            outcome.count(again(&ray, cosine > 0.0).map(context));
        }
    }
    outcome
}

/// A square of two triangles around `center`, across the axis `k`.
fn add_plate(geometry: &mut Geometry, center: Vec3, k: usize, size: f32) {
    let first = geometry.positions.len() as u32;
    let (a, b) = (Vec3::AXES[(k + 1) % 3] * size, Vec3::AXES[(k + 2) % 3] * size);
    geometry.positions.extend([center - a - b, center + a - b, center + a + b, center - a + b]);
    geometry.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

fn ulp(size: f32) -> f32 {
    size.next_up() - size
}

/// Case 10.
pub(super) fn contact(effort: &Effort) -> Outcome {
    let tests = Tests::of(effort);
    let mut outcome = Outcome::default();
    let scenes = 200;
    for s in 0..scenes {
        let mut numbers = Numbers::new(effort, 10, usize::MAX - s);
        let (k, height) = (numbers.below(3), numbers.magnitude(1e-3, 1e6) as f32);
        let gap = ulp(height) * (64.0 + 192.0 * numbers.one() as f32).round();
        let axis = Vec3::AXES[k];
        let mut lower = Geometry::default();
        add_plate(&mut lower, axis * height, k, height);
        let mut both = lower.clone();
        add_plate(&mut both, axis * (height + gap), k, 2.0 * height);
        let start = s * 100_000;
        let rays: Vec<Ray> = inputs(effort, 10, start..start + effort.of(1_000_000) / scenes)
            .filter_map(|mut numbers| {
                let corners = lower.triangle(numbers.below(2));
                let found = on_triangle(tests, &mut numbers, &corners)?;
                let [point, error, normal] = found.vectors();
                let light = axis * (11.0 * height) + numbers.direction().as_vec3() * height;
                let to_light = normalize(light - point);
                let origin = offset_origin(point, error, normal, to_light);
                Some(Ray { t_max: SHADOW_END, ..Ray::new(origin, light - origin) })
            })
            .collect();
        for (geometry, name, is_blocked) in
            [(lower, "the plate it starts from", false), (both, "the plate above", true)]
        {
            let accel = effort.accel(geometry, Preset::VeryFast);
            outcome.add(every_way(accel, &rays, |_, _, hit| {
                let context = || format!("gap {gap} at {height}: {name} is at {}", hit.t);
                (hit.is_miss() == is_blocked).then(context)
            }));
        }
    }
    outcome
}

/// A triangle around `at`, tilted against `direction`, with sides of about `size`.
fn facing(numbers: &mut Numbers, at: DVec3, direction: DVec3, size: f64) -> [Vec3; 3] {
    let aside = direction.cross(numbers.direction()).normalize();
    let other = direction.cross(aside).normalize();
    let tilt = direction.normalize() * (0.5 * (numbers.one() - 0.5));
    let (a, b) = ((aside + tilt) * size, other * size);
    [at - a - b, at + a - b, at + b * 2.0].map(|v| v.as_vec3())
}

/// Two points at a distance of 1e-3 to 1e6, with coordinates up to a few times that.
fn apart(numbers: &mut Numbers) -> (Vec3, DVec3) {
    let distance = numbers.magnitude(1e-3, 1e6);
    let from = (numbers.direction() * (distance * (1.0 + numbers.one()))).as_vec3();
    (from, from.as_dvec3() + numbers.direction() * distance)
}

/// Case 11.
pub(super) fn towards_a_light_on_a_surface(effort: &Effort) -> Outcome {
    let mut outcome = towards_a_triangle(effort);
    for mut numbers in inputs(effort, 11, 0..effort.either(8, 200)) {
        outcome.add(under_a_ceiling(effort, &mut numbers));
    }
    outcome
}

fn towards_a_triangle(effort: &Effort) -> Outcome {
    let tests = Tests::of(effort);
    each(effort, 11, effort.of(10_000_000), |numbers| {
        let (from, light) = apart(numbers);
        let direction = light - from.as_dvec3();
        let size = direction.length() * numbers.magnitude(1e-3, 1.0);
        let corners = facing(numbers, light, direction, size);
        let [point, error, normal] = on_triangle(tests, numbers, &corners)?.vectors();
        let end = offset_end(point, error, normal, normalize(from - point));
        let ray = Ray { t_max: SHADOW_END, ..Ray::new(from, end - from) };
        let mut outcome = Outcome::default();
        // Flatter segments run along the light's own surface.
        if normalize(ray.direction).dot(normal).abs() > 0.1 {
            let hit = tests.triangle(&ray, &corners);
            let context = |t| format!("{ray} is blocked at {t} by the light's own {corners:?}");
            outcome.count(hit.filter(|&t| t != ray.t_max).map(context));
        }
        Some(outcome)
    })
}

/// A floor under a ceiling of four triangles. A light at the vertex that they share, or one of the
/// triangles as a light, is on the ceiling and lights all of the floor.
fn under_a_ceiling(effort: &Effort, numbers: &mut Numbers) -> Outcome {
    let (turned, size) = (rotation(numbers), numbers.magnitude(1e-3, 1e3));
    let moved = numbers.direction() * (size * [0.0, 10.0, 100.0][numbers.below(3)]);
    let place = |x: f64, y: f64, z: f64| turned * DVec3::new(x, y, z) * size + moved;
    let around = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)];
    let matte = || scenes::matte([1.0; 3]);
    let floor = around.map(|(x, z)| place(x, 0.0, z).as_vec3());
    let floor = scenes::mesh(&floor, &[[0, 1, 2], [0, 2, 3]], matte());
    let [x, z] = [(); 2].map(|()| numbers.one() - 0.5);
    let lamp = place(x, 1.0, z).as_vec3();
    let mut vertices = around.map(|(x, z)| place(x, 1.0, z).as_vec3()).to_vec();
    vertices.push(lamp);
    let ceiling = scenes::mesh(&vertices, &[[4, 0, 1], [4, 1, 2], [4, 2, 3], [4, 3, 0]], matte());
    let corners = [4, 0, 1].map(|vertex| vertices[vertex].as_dvec3().to_array());
    let triangle = json!({"type": "arealight", "intensity": 10, "color": [1, 1, 1],
                          "falloff": "none", "sampling": "random", "samples": 1,
                          "shape": {"type": "triangle", "points": corners}});
    let eye = Eye {
        location: place(0.0, 0.75, 0.0),
        look: place(0.0, 0.0, 0.0),
        up: turned * DVec3::Z,
        fov: 90.0,
        size: effort.either([17, 17], [33, 33]),
    };
    let shapes = [floor, ceiling];
    let lights = [scenes::point_light(10.0, lamp.as_dvec3(), "none"), triangle];
    let images = lights.map(|light| {
        let scene = scenes::scene(0, &eye.json(), std::slice::from_ref(&light), &shapes);
        let images = every_image(effort, &scene, &[Preset::VeryFast], |rendered| {
            pixels(&rendered.film, |_, _, pixel| {
                (pixel == [0.0; 3]).then(|| "its light is hidden".to_owned())
            })
        });
        images.with_context(|| format!("under {light}"))
    });
    images.into_iter().sum()
}

/// Case 12.
pub(super) fn just_before_a_light(effort: &Effort) -> Outcome {
    let tests = Tests::of(effort);
    each(effort, 12, effort.of(1_000_000), |numbers| {
        let (from, light) = apart(numbers);
        let light = light.as_vec3();
        let direction = light.as_dvec3() - from.as_dvec3();
        let size = light.abs().max_element().max(from.abs().max_element());
        let before = direction.normalize() * (64.0 * f64::from(ulp(size)));
        // Perpendicular, so that all of it is equally far before the light.
        let mut corners = facing(numbers, DVec3::ZERO, direction, f64::from(size));
        for corner in &mut corners {
            let upright = corner.as_dvec3()
                - direction * corner.as_dvec3().dot(direction) / direction.length_squared();
            *corner = (upright + light.as_dvec3() - before).as_vec3();
        }
        let ray = Ray { t_max: SHADOW_END, ..Ray::new(from, light - from) };
        let hit = tests.triangle(&ray, &corners).filter(|&t| t < ray.t_max);
        let context = || format!("{ray} is not blocked by {corners:?}");
        Some(Outcome::one(hit.is_none().then(context)))
    })
}
