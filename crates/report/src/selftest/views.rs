//! Cameras with extreme parameters, and almost empty scenes.

use glam::DVec3;
use serde_json::{Value, json};

use super::case::{Effort, Outcome};
use super::refused;
use super::scenes::{self, BACKGROUND, Eye, every_image, pixels};
use super::ways::{Numbers, inputs};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::math::random::Stream;

/// Every preset, including brute force.
const PRESETS: &[Preset] = &Preset::ALL;

fn color(numbers: &mut Numbers) -> [f64; 3] {
    [(); 3].map(|()| numbers.one())
}

/// Case 24.
pub(super) fn next_to_nothing(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    let mut shown = 0_u64;
    for mut numbers in inputs(effort, 24, 0..effort.either(3, 100)) {
        let turn = numbers.direction();
        let size = [1 + numbers.below(24) as u32, 1 + numbers.below(24) as u32];
        let eye = Eye::at(turn * 4.0, 50.0, size);
        let background = color(&mut numbers);
        let right = background.map(|c| c as f32);
        let lights = [scenes::point_light(50.0, numbers.direction() * 9.0, "linear")];
        for (name, shapes) in alone(&mut numbers) {
            let is_seen = |&(x, y): &(u32, u32)| {
                sees(&shapes, eye.location, eye.direction(x, y)) == Some(true)
            };
            shown += eye.pixels().filter(is_seen).count() as u64;
            for lights in [&lights[..], &[]] {
                let bounces = [0, 5][numbers.below(2)];
                let mut scene = scenes::scene(bounces, &eye.json(), lights, &shapes);
                scene["scene"]["backgroundcolor"] = json!(background);
                let images = every_image(effort, &scene, PRESETS, |rendered| {
                    pixels(&rendered.film, |x, y, pixel| {
                        let direction = eye.direction(x, y);
                        let seen = sees(&shapes, eye.location, direction);
                        let failure = match seen {
                            Some(false) => pixel != right,
                            Some(true) => pixel == right || lights.is_empty() && pixel != [0.0; 3],
                            None => false,
                        };
                        failure.then(|| format!("{seen:?} of background {right:?}"))
                    })
                });
                outcome.add(images.with_context(|| format!("{name}, {} lights", lights.len())));
            }
        }
    }
    outcome.check(shown > 0, || "no shape is to be seen".to_owned());
    outcome
}

/// No shape, and one of each kind.
fn alone(numbers: &mut Numbers) -> Vec<(&'static str, Vec<Value>)> {
    let mut corner = || numbers.direction() * 1.2;
    let [a, b, c] = [(); 3].map(|()| corner());
    let mut shiny = scenes::matte([0.9, 0.8, 0.7]);
    shiny["kr"] = json!(0.5);
    let triangle = json!({"type": "triangle", "sides": "both", "material": shiny,
                          "points": [a.to_array(), b.to_array(), c.to_array()]});
    let mesh = scenes::mesh(&[a, b, c].map(|p| p.as_vec3()), &[[0, 1, 2]], shiny.clone());
    let sphere = scenes::sphere(a * 0.5, 0.7, shiny.clone());
    let plane = scenes::plane([a, b, c, a + c - b], shiny);
    vec![
        ("nothing", vec![]),
        ("a triangle", vec![triangle]),
        ("a mesh", vec![mesh]),
        ("a sphere", vec![sphere]),
        ("a plane", vec![plane]),
    ]
}

/// Whether the ray meets the only shape, in double precision; `None` beside its edge.
fn sees(shapes: &[Value], origin: DVec3, direction: DVec3) -> Option<bool> {
    const EDGE: f64 = 1e-4;
    let Some(shape) = shapes.first() else { return Some(false) };
    let vector = |value: &Value| {
        let at = |i: usize| value[i].as_f64().unwrap_or(f64::NAN);
        DVec3::new(at(0), at(1), at(2)) - origin
    };
    if let Some(radius) = shape["radius"].as_f64() {
        let center = vector(&shape["center"]);
        let beside = center.cross(direction).length() - radius;
        return (beside.abs() > EDGE).then_some(beside < 0.0);
    }
    let points: Vec<DVec3> = shape["points"].as_array()?.iter().map(vector).collect();
    // The ray passes every edge on the same side.
    let sides = (0..points.len()).map(|i| {
        let (p, q) = (points[i], points[(i + 1) % points.len()]);
        p.cross(q).dot(direction) / (q - p).length()
    });
    let sides: Vec<f64> = sides.collect();
    let is_doubtful = sides.iter().any(|s| s.abs() < EDGE);
    let is_inside = sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0);
    (!is_doubtful).then_some(is_inside)
}

/// Case 27.
pub(super) fn upright(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    for mut numbers in inputs(effort, 27, 0..effort.of(100_000)) {
        let location = numbers.direction() * numbers.magnitude(1e-3, 1e6);
        let along = match numbers.below(2) {
            0 => DVec3::AXES[numbers.below(3)] * numbers.sign(),
            _ => numbers.direction(),
        };
        let view = along * numbers.magnitude(1e-3, 1e6);
        let look = location + view;
        // The rounded sum in the file, not the intended value.
        let view = look - location;
        let off = [0.0, 1e-7, 1e-5, 1.0][numbers.below(4)];
        let aside = view.normalize().cross(numbers.direction()).normalize();
        let up = (view.normalize() + aside * off) * numbers.sign() * numbers.magnitude(1e-3, 1e3);
        let eye = Eye { location, look, up, fov: 40.0, size: [4, 3] };
        let context = || format!("location {location}, look {look}, up {up}");
        let scene = scenes::scene(0, &eye.json(), &[], &[]);
        match scenes::prepare(effort, &scene, Preset::VeryFast) {
            Err(error) => outcome.count(Some(format!("{}: {error}", context()))),
            Ok(prepared) => {
                let is_warned = prepared.warns("camera.up");
                let is_right = is_warned == (off < 1e-6);
                outcome.check(is_right, || format!("{}: warned {is_warned}", context()));
                let basis = prepared.scene.camera.basis().map(|v| v.as_dvec3());
                let failure = not_orthonormal(basis);
                outcome.count(failure.map(|failure| format!("{}: {failure}", context())));
            }
        }
        // And a camera that looks at its own position.
        let scene = scenes::scene(0, &Eye { look: location, ..eye }.json(), &[], &[]);
        let refusal = scenes::prepare(effort, &scene, Preset::VeryFast);
        outcome.add(refused::names(refusal, "camera.look").with_context(context));
    }
    outcome
}

/// The error of unit vectors that should be orthogonal, within 4 ulp of 1.
fn not_orthonormal(basis: [DVec3; 3]) -> Option<String> {
    const LARGEST_ERROR: f64 = 4.0 * f32::EPSILON as f64;
    for (i, a) in basis.iter().enumerate() {
        for (j, b) in basis.iter().enumerate() {
            let error = a.dot(*b) - f64::from(u8::from(i == j));
            let is_within = error.abs() <= LARGEST_ERROR;
            if !is_within {
                return Some(format!("{basis:?}: vectors {i} and {j} are off by {error:e}"));
            }
        }
    }
    None
}

/// Case 28.
pub(super) fn angles(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    for mut numbers in inputs(effort, 28, 0..effort.of(10_000)) {
        let fov = match numbers.below(3) {
            0 => [0.001, 179.0][numbers.below(2)],
            _ => numbers.magnitude(0.001, 179.0).clamp(0.001, 179.0),
        };
        let long = [1, 2, 7, 100, 65_536][numbers.below(5)];
        let size = if numbers.below(2) == 0 { [1, long] } else { [long, 1] };
        let axis = ["x", "y", "smaller", "larger"][numbers.below(4)];
        let look = numbers.direction();
        let eye = Eye { location: DVec3::ZERO, look, up: numbers.direction(), fov, size };
        let mut camera = eye.json();
        camera["fovaxis"] = json!(axis);
        if numbers.below(2) == 0 {
            camera["antialias"] = json!(2);
        }
        let scene = scenes::scene(0, &camera, &[], &[]);
        let context = || format!("{fov} degrees along {axis}, {size:?}, towards {look}");
        match scenes::prepare(effort, &scene, Preset::VeryFast) {
            Err(error) => outcome.count(Some(format!("{}: {error}", context()))),
            Ok(prepared) => {
                outcome.add(rays_of(&prepared.scene.camera, &mut numbers, effort.seed, context));
            }
        }
    }
    for size in [[1, 33], [33, 1], [1, 1]] {
        for fov in [0.001, 1.0, 90.0, 179.0] {
            outcome.add(thin_image(effort, size, fov));
        }
    }
    outcome.add(refused_angles(effort));
    outcome
}

/// Invalid angles of view.
fn refused_angles(effort: &Effort) -> Outcome {
    let refused = [0.0, -1.0, 0.000_999, 179.001, 180.0, 1e9].map(|fov| {
        let eye = Eye { look: DVec3::X, ..Eye::at(DVec3::ZERO, fov, [3, 3]) };
        let scene = scenes::scene(0, &eye.json(), &[], &[]);
        let refusal = scenes::prepare(effort, &scene, Preset::VeryFast);
        refused::names(refusal, "camera.fov").with_context(|| format!("{fov} degrees"))
    });
    refused.into_iter().sum()
}

/// Whether rays of some pixels have directions of length 1 within 4 ulp.
fn rays_of(
    camera: &Camera,
    numbers: &mut Numbers,
    seed: u64,
    context: impl Fn() -> String,
) -> Outcome {
    let mut outcome = Outcome::default();
    let [width, height] = camera.size().map(|side| side as usize);
    for _ in 0..100 {
        let (x, y) = (numbers.below(width), numbers.below(height));
        let stream = Stream { seed, pixel: 0, sample: 0, bounce: 0 };
        let ray = camera.ray(x as u32, y as u32, &stream);
        let error = (ray.direction.as_dvec3().length() - 1.0).abs();
        let is_right = ray.is_valid() && error < 4.0 * f64::from(f32::EPSILON);
        outcome.check(is_right, || format!("{}: pixel ({x}, {y}) has the ray {ray}", context()));
    }
    outcome
}

/// An image one pixel wide or high, the same to the last bit in every way of rendering.
fn thin_image(effort: &Effort, size: [u32; 2], fov: f64) -> Outcome {
    let eye = Eye::at(DVec3::new(0.0, 0.0, 4.0), fov, size);
    let shapes = [scenes::sphere(DVec3::ZERO, 1.5, scenes::matte([1.0; 3]))];
    let light = scenes::point_light(50.0, DVec3::new(3.0, 4.0, 5.0), "linear");
    let scene = scenes::scene(0, &eye.json(), &[light], &shapes);
    let images = scenes::same_images(effort, &scene, &[Preset::VeryFast], &scene);
    images.with_context(|| format!("{size:?} at {fov} degrees"))
}

/// Case 29.
pub(super) fn lenses(effort: &Effort) -> Outcome {
    let mut outcome = refused::lenses(effort);
    for mut numbers in inputs(effort, 29 + 32, 0..effort.either(4, 100)) {
        let eye = Eye::at(numbers.direction() * 5.0, 45.0, [20, 15]);
        let shapes = [
            scenes::sphere(DVec3::ZERO, 1.0, scenes::matte([0.9, 0.5, 0.1])),
            scenes::sphere(DVec3::new(1.5, 0.2, 0.3), 0.7, scenes::matte(BACKGROUND)),
        ];
        let light = scenes::point_light(50.0, numbers.direction() * 8.0, "linear");
        let mut camera = eye.json();
        camera["antialias"] = json!(1 + numbers.below(3));
        let pinhole = scenes::scene(0, &camera, std::slice::from_ref(&light), &shapes);
        camera["type"] = json!("thinlens");
        camera["aperture"] = json!(0);
        camera["focal"] = json!(numbers.magnitude(1e-6, 1e9));
        let closed = scenes::scene(0, &camera, &[light], &shapes);
        outcome.add(scenes::same_images(effort, &closed, &[Preset::VeryFast], &pinhole));
    }
    outcome
}
