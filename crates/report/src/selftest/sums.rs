//! Long sums: of mirrored light, of the samples of a pixel and of a light; and whether the samplers
//! have the means and the independence that sums rely on.

use super::prelude::*;
use crate::summary::mean_and_error;
use wavecrest_core::math::sampling::Sampling;

/// The z coordinates of the two mirrors of case 35, and what is between them.
const PLACES: [f64; 2] = [0.0, 1.0];
const COLORS: [[f64; 3]; 2] = [[0.9, 0.5, 0.2], [0.1, 0.6, 0.8]];
const LIGHT: DVec3 = DVec3::new(0.3, 0.8, 0.4);
const INTENSITY: f64 = 20.0;
const AMBIENT: f64 = 0.05;
const KD: f64 = 0.7;

/// Numbers of bounces of case 35, of which few are tried quickly.
const BOUNCES: [u32; 31] = [
    0, 1, 2, 7, 100, 1000, 3, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 200, 300,
    400, 500, 600, 700, 800, 900,
];

/// Its inputs.
pub(super) const MIRRORS: [usize; 2] = [6, BOUNCES.len()];

/// Case 35.
pub(super) fn facing_mirrors(numbers: &mut Numbers) -> Vec<Picture> {
    /// The largest relative error of a pixel.
    const LARGEST_ERROR: f64 = 1e-4;
    let size = numbers.effort.either([4, 3], [6, 5]);
    let eye = Eye::at(DVec3::new(0.1, 0.2, 0.5), 8.0, size);
    let eye = Eye { look: DVec3::new(0.13, 0.19, 1.0), ..eye };
    let bounces = BOUNCES[numbers.index];
    let picture = |kr: f64| {
        let walls = [0, 1].map(|i| {
            let mirror = scenes::with(scenes::matte(COLORS[i]), json!({"kd": KD, "kr": kr}));
            let center = DVec3::Z * PLACES[i];
            scenes::square([center, DVec3::X * 1e4, DVec3::Y * 1e4], mirror)
        });
        let lights = [scenes::point_light(INTENSITY, LIGHT, "linear")];
        let more = json!({"nbounces": bounces, "scene": {"ambient": AMBIENT}});
        let scene = scenes::with(scenes::scene(&eye, &lights, &walls), more);
        let shows = move |x, y, pixel: [f32; 3]| {
            let right = radiance(eye.location, eye.direction(x, y), bounces, kr);
            let is_near = |i: usize| (f64::from(pixel[i]) / right[i] - 1.0).abs() <= LARGEST_ERROR;
            Some((0..3).all(is_near))
        };
        Picture::new(scene, shows).like_itself()
    };
    [0.5, 0.99, 1.0].map(picture).into()
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

/// Case 55: rays of a lens, in full a million, whose sum is in double precision, and the points of a
/// light, whose sum at a hit is in single precision.
pub(super) fn a_million(numbers: &mut Numbers) -> Vec<Picture> {
    const POINTS: u32 = 1 << 8;
    let rays: u32 = numbers.effort.either(1 << 9, 1 << 10);
    // The floor fills the image.
    let eye = Eye { size: [1, 1], ..Eye::above(1.0, 1) };
    let (strength, floor) = (0.1 + numbers.one(), scenes::floor(100.0, scenes::white()));
    let (scene, right, off) = if numbers.index.is_multiple_of(2) {
        let glow = json!({"material": {"emission": vec![strength; 3]}});
        let lens = json!({"camera": {"type": "thinlens", "aperture": 0.1, "focal": 5,
                                     "nsamplesx": rays, "nsamplesy": rays}});
        let scene = scenes::scene(&eye, &[], &[scenes::with(floor, glow)]);
        (scenes::with(scene, lens), strength, 1e-6)
    } else {
        // Every direction to the light is nearly straight up.
        let light = json!({"type": "directionallight", "intensity": strength, "color": [1, 1, 1],
                           "direction": [0, -1, 0], "angle": 1e-3, "sampling": "jittered",
                           "samples": POINTS});
        // Each addition rounds by at most half an ulp of the sum.
        let off = f64::from(POINTS * POINTS) * f64::from(f32::EPSILON) / 2.0;
        (scenes::scene(&eye, &[light], &[floor]), 0.8 * strength, off)
    };
    let is_near = move |c: f32| (f64::from(c) / right - 1.0).abs() <= off;
    vec![Picture::new(scene, move |_, _, pixel| Some(pixel.into_iter().all(is_near)))]
}

/// Seeds of case 56, points of a set along each side, and sets of each seed: of pixels beside each
/// other.
const SEEDS: u64 = 48;
const SIDE: u32 = 4;
const SETS: u32 = 16;

/// The largest deviation of a mean from its expectation, and of a correlation from 0, in standard
/// errors: chance exceeds it in less than one of 10^6 cases.
const LARGEST_DEVIATION: f64 = 6.0;

/// Functions of the unit square with their means.
type Integrand = (fn(Vec2) -> f64, f64);
const INTEGRANDS: [Integrand; 5] = [
    (|p| f64::from(p.x), 0.5),
    (|p| f64::from(p.y), 0.5),
    (|p| f64::from(p.x) * f64::from(p.y), 0.25),
    (|p| f64::from(u8::from(p.x + p.y < 0.7)), 0.245),
    (|p| f64::from(u8::from(p.length_squared() < 1.0)), std::f64::consts::FRAC_PI_4),
];

/// Case 56: estimates by each sampler, over seeds and pixels. Their mean is the integral, and
/// estimates of neighbouring pixels, dimensions and seeds do not depend on each other.
pub(super) fn samplers(numbers: &mut Numbers) -> Outcome {
    let mut outcome = Outcome::default();
    for sampling in Sampling::ALL {
        for (number, (of, mean)) in INTEGRANDS.into_iter().enumerate() {
            let error = |seed: u64, pixel: u32, dimension: u32| {
                let seed = numbers.effort.seed.wrapping_add(seed);
                let stream = Stream { seed, pixel, sample: 0, bounce: 0 };
                estimate(sampling, stream, dimension, of) - mean
            };
            let over = |value: &dyn Fn(u64, u32) -> f64| {
                let each = (0..SEEDS).flat_map(|seed| (0..SETS).map(move |set| value(seed, set)));
                let (mean, error) = mean_and_error(&each.collect::<Vec<_>>());
                mean / error.max(f64::from(f32::EPSILON))
            };
            let found = [
                ("the mean", over(&|s, p| error(s, p, 0))),
                ("the next pixel", over(&|s, p| error(s, p, 0) * error(s, p + 1, 0))),
                ("another dimension", over(&|s, p| error(s, p, 0) * error(s, p, 1))),
                ("the next seed", over(&|s, p| error(s, p, 0) * error(s + 1, p, 0))),
            ];
            for (name, off) in found {
                outcome.check(off.abs() <= LARGEST_DEVIATION, || {
                    let name = format!("{}, integrand {number}: {name}", sampling.name());
                    format!("{name}, {off} standard errors")
                });
            }
        }
    }
    outcome
}

/// The mean of a function over a set of points.
fn estimate(sampling: Sampling, stream: Stream, dimension: u32, of: fn(Vec2) -> f64) -> f64 {
    let count = SIDE * SIDE;
    let values = (0..count).map(|i| {
        let stream = Stream { sample: i, ..stream };
        let random = || {
            let [x, y, ..] = stream.uniform(dimension);
            [x, y]
        };
        of(sampling.point((i, i), [SIDE, SIDE], random, || stream.scramble(dimension)))
    });
    values.sum::<f64>() / f64::from(count)
}
