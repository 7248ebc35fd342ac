//! Spot lights with empty, hard and half-space cones, and directional lights along surfaces.

use glam::DVec3;
use serde_json::{Value, json};

use super::case::{Effort, Outcome};
use super::scenes::{self, Eye, every_image, pixels};
use super::ways::inputs;
use wavecrest_core::accel::build::Preset;

/// Half angles of cones in degrees, inner and outer.
const CONES: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [0.0, 1e-6],
    [1e-3, 1e-3],
    [30.0, 30.0],
    [0.0, 45.0],
    [45.0, 45.0],
    [0.0, 90.0],
    [90.0, 90.0],
];

/// Height of the spot above the floor.
const HEIGHT: f64 = 2.0;

/// Within this distance of the edge of a cone, as a cosine, rounding decides: of hit points, and of
/// expected pixels.
const DOUBTFUL: f64 = 1e-6;

/// Case 41.
pub(super) fn cones(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    for cone in CONES {
        outcome.add(over_a_floor(effort, cone).with_context(|| format!("a cone of {cone:?}")));
    }
    for mut numbers in inputs(effort, 41, 0..effort.either(16, 200)) {
        let from = [(); 3].map(|()| 1.0 + numbers.below(1000) as f64);
        outcome.add(at_the_origin(effort, from).with_context(|| format!("a spot at {from:?}")));
    }
    for angle in [0.0, 1e-6, 0.53, 180.0] {
        let context = || format!("light along the floor, seen under {angle} degrees");
        outcome.add(along_the_floor(effort, angle).with_context(context));
    }
    outcome
}

/// A camera above the origin, which its centre pixel sees; with odd sizes the axes are rows of
/// pixels.
fn eye(effort: &Effort) -> Eye {
    let size = effort.either([17, 17], [65, 65]);
    Eye { up: DVec3::Z, ..Eye::at(DVec3::new(0.0, 5.0, 0.0), 90.0, size) }
}

/// The only visible shape: the plane y = 0.
fn floor() -> Value {
    let at = |x: f64, z: f64| DVec3::new(100.0 * x, 0.0, 100.0 * z);
    let corners = [at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)];
    scenes::plane(corners, scenes::matte([1.0; 3]))
}

/// A spot that points straight down: everything inside the inner cone is lit, everything outside
/// the outer one is black.
fn over_a_floor(effort: &Effort, [inner, outer]: [f64; 2]) -> Outcome {
    let eye = eye(effort);
    let light = json!({"type": "spotlight", "intensity": 10, "position": [0, HEIGHT, 0],
                       "color": [1, 1, 1], "direction": [0, -3, 0], "inner": inner, "outer": outer});
    let scene = scenes::scene(0, &eye.json(), &[light], &[floor()]);
    let edge = |degrees: f64| if degrees == 90.0 { 0.0 } else { degrees.to_radians().cos() };
    every_image(effort, &scene, &[Preset::VeryFast], |rendered| {
        pixels(&rendered.film, |x, y, pixel| {
            let direction = eye.direction(x, y);
            let hit = eye.location - direction * (eye.location.y / direction.y);
            let cosine = HEIGHT / (hit - DVec3::Y * HEIGHT).length();
            let is_lit = pixel[0] > 0.0;
            let is_within = cosine > edge(outer) + DOUBTFUL;
            let is_without = outer == 0.0 || cosine < edge(outer) - DOUBTFUL;
            match is_lit {
                true if is_without => Some("lit outside of the cone".to_owned()),
                false if is_within => Some("dark within the cone".to_owned()),
                _ => None,
            }
        })
    })
}

/// A spot that points at the origin lights it through the narrowest cone, and nothing through one
/// of 0 degrees, though the origin is on its axis.
fn at_the_origin(effort: &Effort, [x, y, z]: [f64; 3]) -> Outcome {
    let eye = eye(effort);
    let middle = eye.size.map(|side| side / 2);
    let image = |outer: f64| {
        let light = json!({"type": "spotlight", "intensity": 10, "position": [x, y, z],
                           "color": [1, 1, 1], "direction": [-x, -y, -z],
                           "inner": 0, "outer": outer, "falloff": "none"});
        let scene = scenes::scene(0, &eye.json(), &[light], &[floor()]);
        every_image(effort, &scene, &[Preset::VeryFast], |rendered| {
            pixels(&rendered.film, |x, y, pixel| {
                let is_right = match outer {
                    0.0 => pixel == [0.0; 3],
                    _ => [x, y] != middle || pixel[0] > 0.0,
                };
                (!is_right).then(|| format!("a cone of {outer}"))
            })
        })
    };
    [0.0, 0.1].map(image).into_iter().sum()
}

/// Parallel light in the plane of the floor adds nothing, and half of the light from half of the
/// sky is above the floor.
fn along_the_floor(effort: &Effort, angle: f64) -> Outcome {
    let light = json!({"type": "directionallight", "intensity": 1, "color": [1, 1, 1],
                       "direction": [1, 0, 0], "angle": angle, "samples": 16});
    let scene = scenes::scene(0, &eye(effort).json(), &[light], &[floor()]);
    every_image(effort, &scene, &[Preset::VeryFast], |rendered| {
        pixels(&rendered.film, |_, _, pixel| {
            // At most all directions at the greatest height.
            let most = (angle / 2.0).to_radians().sin() as f32;
            let is_right = (0.0..=most).contains(&pixel[0]) && (angle < 1.0 || pixel[0] > 0.0);
            (!is_right).then(|| format!("not from 0 to {most}"))
        })
    })
}
