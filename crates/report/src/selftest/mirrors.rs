//! Mirrors that face each other.

use glam::DVec3;
use rayon::prelude::*;
use serde_json::json;

use super::case::{Effort, Outcome};
use super::scenes::{self, Eye, every_image, pixels};
use super::ways::in_order;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;

/// The largest relative error of a pixel.
const LARGEST_ERROR: f64 = 1e-4;

/// The z coordinates of the two mirrors.
const PLACES: [f64; 2] = [0.0, 1.0];

const COLORS: [[f64; 3]; 2] = [[0.9, 0.5, 0.2], [0.1, 0.6, 0.8]];
const LIGHT: DVec3 = DVec3::new(0.3, 0.8, 0.4);
const INTENSITY: f64 = 20.0;
const AMBIENT: f64 = 0.05;
const KD: f64 = 0.7;

/// Case 35.
pub(super) fn facing(effort: &Effort) -> Outcome {
    let few = vec![0, 1, 2, 7, 100, 1000];
    let many = (0..=20).chain((100..=1000).step_by(100)).collect();
    let bounces: Vec<u32> = effort.either(few, many);
    let asked = bounces.into_iter().flat_map(|n| [(n, 0.5), (n, 0.99), (n, 1.0)]);
    let all = asked.collect::<Vec<_>>().into_par_iter().map(|(bounces, kr)| {
        let context = || format!("{bounces} bounces of {kr}");
        between(effort, bounces, kr).with_context(context)
    });
    in_order(all)
}

fn between(effort: &Effort, bounces: u32, kr: f64) -> Outcome {
    let eye = Eye {
        location: DVec3::new(0.1, 0.2, 0.5),
        look: DVec3::new(0.13, 0.19, 1.0),
        up: DVec3::Y,
        fov: 8.0,
        size: effort.either([4, 3], [6, 5]),
    };
    let walls = [0, 1].map(|i| {
        let at = |x: f64, y: f64| DVec3::new(x, y, PLACES[i]) * DVec3::new(1e4, 1e4, 1.0);
        let material = json!({"ks": 0, "kd": KD, "specularexponent": 1, "diffusecolor": COLORS[i],
                              "kr": kr});
        scenes::plane([at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)], material)
    });
    let lights = [scenes::point_light(INTENSITY, LIGHT, "linear")];
    let mut scene = scenes::scene(bounces, &eye.json(), &lights, &walls);
    scene["scene"]["ambient"] = json!(AMBIENT);
    let judge = |expected: Film| {
        every_image(effort, &scene, &[Preset::Brute, Preset::VeryFast], |rendered| {
            let mut outcome = scenes::same(&rendered.film, &expected);
            outcome.add(pixels(&rendered.film, |x, y, pixel| {
                let right = radiance(eye.location, eye.direction(x, y), bounces, kr);
                let is_near =
                    |i: usize| (f64::from(pixel[i]) / right[i] - 1.0).abs() <= LARGEST_ERROR;
                (!(0..3).all(is_near)).then(|| format!("not {right}"))
            }));
            outcome
        })
    };
    scenes::image(effort, &scene, Preset::Brute).map(judge).into()
}

/// The radiance along the ray: instead of being mirrored, it continues straight through a row of
/// images of the space between.
fn radiance(origin: DVec3, direction: DVec3, bounces: u32, kr: f64) -> DVec3 {
    let mut sum = DVec3::ZERO;
    let mut wall = usize::from(direction.z > 0.0);
    let mut t = (PLACES[wall] - origin.z) / direction.z;
    let mut weight = 1.0;
    for _ in 0..=bounces {
        let point = (origin + direction * t).with_z(PLACES[wall]);
        let to_light = LIGHT - point;
        let distance = to_light.length();
        let cosine = to_light.z.abs() / distance;
        let lit = KD * cosine * INTENSITY / (4.0 * std::f64::consts::PI * distance);
        sum += DVec3::from(COLORS[wall]) * (weight * (AMBIENT + lit));
        weight *= kr;
        t += (PLACES[1] - PLACES[0]) / direction.z.abs();
        wall = 1 - wall;
    }
    sum
}
