//! Vertex colours that differ as widely as a scene allows.

use glam::DVec3;
use serde_json::json;

use super::case::{Effort, Outcome};
use super::scenes::{self, Eye, every_image, pixels};
use super::ways::{Numbers, inputs};
use wavecrest_core::accel::build::Preset;

/// Triangles of a fan.
const TRIANGLES: usize = 12;

/// Largest error of interpolation, relative to the largest colour of the triangle: the point and
/// the weights have single precision.
const LARGEST_ERROR: f64 = 1e-5;

/// Case 46.
pub(super) fn interpolated(effort: &Effort) -> Outcome {
    let fans = inputs(effort, 46, 0..effort.either(4, 100));
    fans.map(|mut numbers| fan_from_above(effort, &mut numbers)).sum()
}

/// A fan in the plane y = 0 around the origin, seen by the centre pixel: the image shows only its
/// vertex colours, in ambient light.
fn fan_from_above(effort: &Effort, numbers: &mut Numbers) -> Outcome {
    let size = effort.either([25, 25], [65, 65]);
    let eye = Eye { up: DVec3::Z, ..Eye::at(DVec3::new(0.0, 5.0, 0.0), 60.0, size) };
    let around = |i: usize| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * i as f64 / TRIANGLES as f64);
        // Exact in the file and in single precision.
        DVec3::new(2.0 * sin, 0.0, 2.0 * cos).as_vec3().as_dvec3()
    };
    let points: Vec<DVec3> =
        std::iter::once(DVec3::ZERO).chain((0..TRIANGLES).map(around)).collect();
    let color = |_| {
        let most = [1.0, 1e12][numbers.below(2)];
        numbers.magnitude(1e-3, most) as f32
    };
    let colors: Vec<f32> = (0..points.len()).map(color).collect();
    let fan: Vec<[usize; 3]> =
        (0..TRIANGLES).map(|i| [0, 1 + i, 1 + (i + 1) % TRIANGLES]).collect();
    let mesh = json!({"type": "trimesh", "indices": fan, "sides": "both",
                      "points": points.iter().map(|p| p.to_array()).collect::<Vec<_>>(),
                      "colors": colors.iter().map(|&c| [c; 3]).collect::<Vec<_>>(),
                      "material": scenes::matte([1.0; 3])});
    // No power, but an ambient part.
    let light = scenes::point_light(0.0, DVec3::Y, "none");
    let mut scene = scenes::scene(0, &eye.json(), &[light], &[mesh]);
    scene["scene"]["ambient"] = 1.into();
    every_image(effort, &scene, &[Preset::VeryFast], |rendered| {
        pixels(&rendered.film, |x, y, [pixel, ..]| {
            let direction = eye.direction(x, y);
            let hit = eye.location - direction * (eye.location.y / direction.y);
            let of = |corners: &[usize; 3]| {
                let weights = weights(corners.map(|corner| points[corner]), hit);
                let is_within = weights.iter().all(|weight| *weight > -1e-6);
                let colors = corners.map(|corner| f64::from(colors[corner]));
                is_within.then(|| {
                    let mixed = weights.iter().zip(colors).map(|(w, c)| w * c).sum::<f64>();
                    (mixed, LARGEST_ERROR * colors.into_iter().fold(0.0, f64::max))
                })
            };
            // On an edge any of its triangles is right.
            let expected: Vec<(f64, f64)> = fan.iter().filter_map(of).collect();
            let is_right = expected.is_empty()
                || expected.iter().any(|(mixed, off)| (f64::from(pixel) - mixed).abs() <= *off);
            (!is_right).then(|| format!("not {expected:?}"))
        })
    })
}

/// The weights of a triangle's corners at a point of the plane y = 0.
fn weights([a, b, c]: [DVec3; 3], point: DVec3) -> [f64; 3] {
    let area = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).y;
    let whole = area(a, b, c);
    [area(point, b, c) / whole, area(a, point, c) / whole, area(a, b, point) / whole]
}
