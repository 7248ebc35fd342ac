//! Lights at extreme positions, and reflection at extreme angles and exponents.

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::case::{Effort, Outcome};
use super::convex::{Mesh, globe};
use super::refused;
use super::scenes::{self, Eye, PRESETS, every_image, pixels};
use super::surfaces::on_triangle;
use super::ways::{Numbers, Tests, in_blocks, inputs};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::blinn_phong::{Material, reflect};
use wavecrest_core::kernels::light::{Emitter, Falloff, Light, Triangles};
use wavecrest_core::kernels::shade::{ShadingPoint, shadow_request};
use wavecrest_core::kernels::surface::Surface;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::sampling::Sampling;
use wavecrest_core::math::vector::Vector;

const FALLOFFS: [Falloff; 3] = [Falloff::Linear, Falloff::InverseSquare, Falloff::None];
const FALLOFF_NAMES: [&str; 3] = ["linear", "inverse-square", "none"];

/// The power of the lights in tests of kernels.
const POWER: f32 = 10.0;

const MATERIAL: Material = Material { ks: 0.5, kd: 0.5, exponent: 8.0, color: Vec3::ONE, kr: 0.0 };

/// A point of a triangle, seen from its front.
fn shading_point(numbers: &mut Numbers, surface: &Surface<f32>) -> ShadingPoint<f32> {
    let view = numbers.direction().as_vec3();
    ShadingPoint {
        point: surface.point,
        error: surface.error,
        normal: surface.normal,
        shading_normal: surface.normal,
        view: if view.dot(surface.normal.into()) < 0.0 { -view } else { view }.into(),
        color: Vec3::ONE.into(),
        occlusion: 1.0,
        emission: Vec3::ZERO.into(),
        reflection: MATERIAL.reflection(),
        kr: MATERIAL.kr,
        lit: true,
    }
}

fn light(emitter: Emitter, falloff: Falloff) -> Light {
    let sampling = Sampling::Jittered;
    Light { emitter, power: Vec3::splat(POWER), falloff, sampling, grid: [1, 1], dimension: 1 }
}

/// A triangle with corners up to `unit` from 0.
fn random_triangle(numbers: &mut Numbers, unit: f64) -> [Vec3; 3] {
    [(); 3].map(|()| (numbers.direction() * (unit * numbers.one())).as_vec3())
}

/// Case 31.
pub(super) fn edge_on(effort: &Effort) -> Outcome {
    let mut outcome = refused::lights(effort);
    outcome.add(in_blocks(effort.of(1_000_000), |n| {
        edge_on_point(Tests::of(effort), &mut Numbers::new(effort, 31, n))
    }));
    for shape in hardly_lights() {
        for falloff in FALLOFF_NAMES {
            let light = json!({"type": "arealight", "intensity": 10, "color": [1, 1, 1],
                               "falloff": falloff, "sampling": "jittered", "samples": 2,
                               "shape": shape});
            let scene = over_a_floor(effort, &[light]);
            let images = every_image(effort, &scene, &[Preset::VeryFast], |rendered| {
                pixels(&rendered.film, |_, _, pixel| {
                    let is_below_0 = pixel.iter().any(|value| *value < 0.0);
                    is_below_0.then(|| "below 0".to_owned())
                })
            });
            outcome.add(images.with_context(|| format!("a light of the shape {shape}, {falloff}")));
        }
    }
    outcome
}

/// A point, and a light that it sees edge on, that contains it, or that is a needle.
fn edge_on_point(tests: Tests, numbers: &mut Numbers) -> Outcome {
    let unit = numbers.magnitude(1e-3, 1e3);
    let corners = random_triangle(numbers, unit);
    let Some(surface) = on_triangle(tests, numbers, &corners) else { return Outcome::default() };
    let point = shading_point(numbers, &surface);
    let near = Vec3::from(surface.point);
    let [p, q] = [(); 2].map(|()| near + (numbers.direction() * unit).as_vec3());
    let shape = match numbers.below(4) {
        // In the light's plane, beside it and at its corner.
        0 => [p, q, p + (p - near)],
        1 => [near, p, q],
        // The point's own surface.
        2 => corners,
        _ => [p, q, q + (numbers.direction() * (1e-6 * unit)).as_vec3()],
    };
    let falloff = FALLOFFS[numbers.below(3)];
    let Some(triangles) = Triangles::new(vec![shape]) else { return Outcome::default() };
    let light = light(Emitter::Triangles(triangles), falloff);
    let stream = Stream { seed: 0, pixel: numbers.below(1 << 20) as u32, sample: 0, bounce: 0 };
    let request = shadow_request(&point, Vec3::ONE.into(), &light, &light.point(0, &stream));
    let failure = request.filter(|request| {
        let contribution = Vec3::from(request.contribution);
        let is_right = contribution.is_finite()
            && contribution.min_element() >= 0.0
            && request.ray().direction.is_finite();
        !is_right
    });
    Outcome::one(failure.map(|request| format!("{request:?} from {point:?} to {shape:?}")))
}

/// Shapes of lights that some points of the floor see edge on, or that touch the floor.
fn hardly_lights() -> Vec<Value> {
    vec![
        json!({"type": "plane", "points": [[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]]}),
        json!({"type": "plane", "points": [[0, 0, -1], [0, 1, -1], [0, 1, 1], [0, 0, 1]]}),
        json!({"type": "triangle", "points": [[-1, 0, 0], [1, 0, 0], [0, 1, 0]]}),
        json!({"type": "triangle", "points": [[-1, 1, 0], [1, 1, 0], [1, 1.000_001, 0]]}),
        json!({"type": "trimesh", "points": [[-1, 1, 0], [1, 1, 0], [0, 2, 0]],
               "indices": [[0, 0, 1], [0, 1, 2], [1, 1, 1]]}),
        json!({"type": "sphere", "center": [0, 1, 0], "radius": 1}),
        json!({"type": "sphere", "center": [0, 0, 0], "radius": 1e-6}),
    ]
}

/// These lights above a floor; a pixel's centre is at the origin.
fn over_a_floor(effort: &Effort, lights: &[Value]) -> Value {
    let size = effort.either([17, 17], [65, 65]);
    let location = DVec3::new(0.0, 5.0, 0.0);
    let eye = Eye { up: DVec3::Z, ..Eye::at(location, 50.0, size) };
    let at = |x: f64, z: f64| DVec3::new(3.0 * x, 0.0, 3.0 * z);
    let floor = [at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)];
    scenes::scene(0, &eye.json(), lights, &[scenes::plane(floor, scenes::matte([1.0; 3]))])
}

/// Case 32.
pub(super) fn at_the_surface(effort: &Effort) -> Outcome {
    let mut outcome = in_blocks(effort.of(1_000_000), |n| {
        light_at_a_point(Tests::of(effort), &mut Numbers::new(effort, 32, n))
    });
    // A wall at z = 1.5, hit by the centre of the image: numbers there are 2^-23 apart.
    let ulp = f64::from(1.5_f32.next_up() - 1.5);
    // Very near, the light is within the rounding error of the wall; a few ulp away it is where the
    // shadow ray starts.
    for height in -2..=9 {
        let count = u64::from(height == 1);
        for falloff in FALLOFF_NAMES {
            let size = effort.either([9, 9], [65, 65]);
            let eye = Eye::at(DVec3::new(0.0, 0.0, 5.0), 50.0, size);
            let at = |x: f64, y: f64| DVec3::new(x, y, 1.5);
            let wall = [at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)];
            let position = at(0.0, 0.0) + DVec3::Z * (ulp * f64::from(height));
            let light = scenes::point_light(10.0, position, falloff);
            let wall = scenes::plane(wall, scenes::matte([1.0; 3]));
            let scene = scenes::scene(0, &eye.json(), &[light], &[wall]);
            let images = every_image(effort, &scene, &[Preset::VeryFast], |rendered| {
                let found = rendered.counters.lights_at_surface;
                let failure = || format!("{found} counted, not {count}");
                let mut outcome = Outcome::one((found != count).then(failure));
                let middle = rendered.film.pixel(size[0] / 2, size[1] / 2).unwrap_or_default();
                let is_right = (middle[0] > 0.0) == (height > 0);
                outcome.check(is_right, || format!("{middle:?} below the light"));
                outcome
            });
            let context = || format!("a light {height} ulp before a wall, {falloff}");
            outcome.add(images.with_context(context));
        }
    }
    outcome
}

/// The vector from a point of a surface to a light: zero, a few of its rounding errors, or a small
/// part of `unit`.
fn away(numbers: &mut Numbers, surface: &Surface<f32>, unit: f64) -> DVec3 {
    let least = f64::from(surface.error.max_abs());
    match numbers.below(4) {
        0 => DVec3::ZERO,
        1 => Vec3::from(surface.normal).as_dvec3() * (least * numbers.magnitude(1e-3, 10.0)),
        2 => numbers.direction() * (least * numbers.magnitude(1e-3, 10.0)),
        _ => numbers.direction() * (unit * numbers.magnitude(1e-9, 1e-5)),
    }
}

/// The share of a light's power at a distance.
fn part_left(falloff: Falloff, distance: f64) -> f64 {
    match falloff {
        Falloff::Linear => 1.0 / (4.0 * std::f64::consts::PI * distance),
        Falloff::InverseSquare => 1.0 / (4.0 * std::f64::consts::PI * distance * distance),
        Falloff::None => 1.0,
    }
}

/// A point light at a point, or within a few of its rounding errors.
fn light_at_a_point(tests: Tests, numbers: &mut Numbers) -> Outcome {
    let mut outcome = Outcome::default();
    let unit = numbers.magnitude(1e-6, 1e6);
    let corners = random_triangle(numbers, unit);
    let Some(surface) = on_triangle(tests, numbers, &corners) else { return outcome };
    let point = shading_point(numbers, &surface);
    let least = f64::from(surface.error.max_abs());
    let [at, normal] = [surface.point, surface.normal].map(|v| Vec3::from(v).as_dvec3());
    let position = (at + away(numbers, &surface, unit)).as_vec3();
    let falloff = FALLOFFS[numbers.below(3)];
    let light = light(Emitter::Point(position), falloff);
    let stream = Stream { seed: 0, pixel: 0, sample: 0, bounce: 0 };
    let request = shadow_request(&point, Vec3::ONE.into(), &light, &light.point(0, &stream));
    let towards = position.as_dvec3() - at;
    let distance = towards.length();
    let context = || format!("{request:?} from {point:?} to {position}");
    match &request {
        None => {
            let height = normal.dot(towards);
            let is_before = height > 1e-5 * distance && distance > 0.0;
            outcome.count(is_before.then(|| format!("it is left out: {}", context())));
        }
        Some(request) => {
            let nearest = distance.max(least);
            let most = f64::from(POWER * (MATERIAL.kd + MATERIAL.ks))
                * part_left(falloff, nearest)
                * 1.0001;
            let contribution = Vec3::from(request.contribution);
            let is_bounded =
                contribution.is_finite() && f64::from(contribution.max_element()) <= most;
            outcome.check(is_bounded, || format!("more than {most}: {}", context()));
            let is_doubtful = (distance / least - 1.0).abs() < 1e-5;
            let is_counted = request.at_light == (distance < least) || is_doubtful;
            outcome.check(is_counted, || format!("{distance}, {least}: {}", context()));
        }
    }
    outcome
}

/// A mesh with normals tilted at random from those of its globe.
fn with_normals(mesh: &Mesh, numbers: &mut Numbers, tilt: f64) -> Value {
    let normals = mesh.positions.iter().map(|p| {
        let normal = p.as_dvec3().normalize() + numbers.direction() * tilt;
        normal.normalize().to_array()
    });
    let normals: Vec<[f64; 3]> = normals.collect();
    let shiny = json!({"ks": 1, "kd": 1, "specularexponent": 2, "diffusecolor": [1, 1, 1]});
    let mut shape = scenes::mesh(&mesh.positions, &mesh.triangles, shiny);
    shape["shading"] = json!("smooth");
    shape["normals"] = json!(normals);
    shape
}

/// Case 33.
pub(super) fn horizon(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    let mut asked = 0_u64;
    for mut numbers in inputs(effort, 33, 0..effort.either(6, 200)) {
        let mesh = globe([1, 2, 4][numbers.below(3)], 64.0, 1.0 / 64.0);
        let light = numbers.direction() * 64.0 * numbers.magnitude(1.1, 10.0);
        let location = numbers.direction() * 200.0;
        let eye = Eye::at(location, 40.0, [32, 32]);
        // Up to nearly along the surface.
        let tilt = [0.0, 0.5, 3.0][numbers.below(3)];
        let shape = with_normals(&mesh, &mut numbers, tilt);
        let lights = [scenes::point_light(100.0, light, "none")];
        let scene = scenes::scene(0, &eye.json(), &lights, &[shape]);
        // Closer to a face's plane than this, rounding decides whether the light is in front of it.
        let doubtful = 64.0 * f64::from(f32::EPSILON) * light.length();
        let is_behind = |x, y| {
            let triangle = mesh.seen(location, eye.direction(x, y));
            triangle.is_some_and(|triangle| mesh.height(triangle, light) < -doubtful)
        };
        asked += eye.pixels().filter(|&(x, y)| is_behind(x, y)).count() as u64;
        let images = every_image(effort, &scene, &PRESETS, |rendered| {
            pixels(&rendered.film, |x, y, pixel| {
                let is_lit = pixel != [0.0; 3];
                (is_lit && is_behind(x, y)).then(|| "lit from behind".to_owned())
            })
        });
        let context = || format!("light at {light}, seen from {location}, tilt {tilt}");
        outcome.add(images.with_context(context));
    }
    outcome.check(asked > 0, || "no face has the light behind it".to_owned());
    let sheets = inputs(effort, 33, 0..effort.either(6, 200));
    outcome.add(sheets.map(|mut numbers| behind_a_sheet(effort, &mut numbers)).sum());
    outcome
}

/// An open sheet, with a light before its tilted normals: lit if the light is before the sheet too,
/// black if it is behind, where nothing else hides it.
fn behind_a_sheet(effort: &Effort, numbers: &mut Numbers) -> Outcome {
    let turn = std::f64::consts::TAU * numbers.one();
    let aside = DVec3::new(libm::cos(turn), 0.0, libm::sin(turn));
    let place = aside * numbers.magnitude(2.0, 20.0);
    // At least 63 degrees, so that a light is before the normals at up to 26 degrees behind the sheet.
    let normal = (aside * numbers.magnitude(2.0, 4.0) + DVec3::Y).normalize().to_array();
    let corners =
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let mut sheet = scenes::mesh(&corners, &[[0, 1, 2], [0, 2, 3]], scenes::matte([1.0; 3]));
    sheet["shading"] = json!("smooth");
    sheet["normals"] = json!(vec![normal; 4]);
    let eye =
        Eye { up: DVec3::Z, ..Eye::at(DVec3::Y * 5.0, 10.0, effort.either([8, 8], [32, 32])) };
    let images = [1.0, -1.0].map(|side| {
        let light = place + DVec3::Y * (side * numbers.magnitude(1e-3, 0.4));
        let lights = [scenes::point_light(100.0, light, "none")];
        let scene = scenes::scene(0, &eye.json(), &lights, std::slice::from_ref(&sheet));
        let images = every_image(effort, &scene, &[Preset::VeryFast], |rendered| {
            pixels(&rendered.film, |_, _, pixel| {
                let is_lit = pixel != [0.0; 3];
                (is_lit != (side > 0.0)).then(|| "of a sheet".to_owned())
            })
        });
        images.with_context(|| format!("light at {light}, normals {normal:?}"))
    });
    images.into_iter().sum()
}

/// Exponents, including the limits of scenes.
fn exponent(numbers: &mut Numbers) -> f32 {
    let of_any_size = numbers.magnitude(1e-6, 1e6) as f32;
    [0.0, 1e-30, 1.0, 1e6, 999_999.5, of_any_size.round(), of_any_size][numbers.below(7)]
}

/// Case 36.
pub(super) fn highlights(effort: &Effort) -> Outcome {
    let mut outcome = in_blocks(effort.of(10_000_000), |n| {
        let mut numbers = Numbers::new(effort, 36, n);
        let normal = numbers.direction().as_vec3();
        let view = [numbers.direction().as_vec3(), normal][numbers.below(2)];
        let nearly = (numbers.direction() * numbers.magnitude(1e-9, 1e-5)).as_vec3();
        let to_light = match numbers.below(4) {
            0 => -view,
            1 => wavecrest_core::math::float::normalize(nearly - view),
            2 => view,
            _ => numbers.direction().as_vec3(),
        };
        let [ks, kd] = [(); 2].map(|()| [0.0, 1.0, numbers.one() as f32][numbers.below(3)]);
        let material = Material { ks, kd, exponent: exponent(&mut numbers), ..MATERIAL };
        let [to, from] = [to_light, view].map(Vector::from);
        let white = Vec3::ONE.into();
        let found = reflect(&material.reflection(), white, normal.into(), from, to);
        let found = Vec3::from(found);
        let is_right = found.is_finite()
            && found.min_element() >= 0.0
            && f64::from(found.max_element()) <= f64::from(ks + kd) * 1.00001;
        Outcome::one((!is_right).then(|| {
            format!("{found} of {material:?}, normal {normal}, view {view}, light {to_light}")
        }))
    });
    for exponent in [0.0, 1e-30, 0.5, 1.0, 999_999.5, 1e6] {
        outcome.add(shiny_ball(effort, exponent).with_context(|| format!("exponent {exponent}")));
    }
    outcome
}

/// A ball with this exponent, with the same image in every way of rendering.
fn shiny_ball(effort: &Effort, exponent: f64) -> Outcome {
    let mut shiny = scenes::matte([0.5; 3]);
    shiny["ks"] = json!(1);
    shiny["specularexponent"] = json!(exponent);
    let location = DVec3::new(0.0, 0.0, 4.0);
    let eye = Eye::at(location, 40.0, [24, 24]);
    // At the eye, where the half vector is the view, and behind the visible surface.
    let lights = [location, -location, DVec3::Z * 1.5]
        .map(|position| scenes::point_light(40.0, position, "linear"));
    let ball = scenes::sphere(DVec3::ZERO, 1.0, shiny);
    let scene = scenes::scene(0, &eye.json(), &lights, &[ball]);
    scenes::same_images(effort, &scene, &[Preset::VeryFast], &scene)
}
