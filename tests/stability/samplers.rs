use glam::Vec2;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::sampling::{Draw, Sampling};

/// Seeds, points of a set along each side, and sets of each seed: of pixels beside each other.
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

/// Estimates by each sampler, over seeds and pixels. Their mean is the integral, and estimates of
/// neighbouring pixels, dimensions and seeds do not depend on each other.
#[test]
fn hc56_estimates_have_no_bias_and_no_correlation() {
    for sampling in Sampling::ALL {
        for (number, (of, mean)) in INTEGRANDS.into_iter().enumerate() {
            let error = |seed: u64, pixel: u32, dimension: u32| {
                let stream = Stream { seed, pixel, sample: 0, bounce: 0 };
                estimate(sampling, stream, dimension, of) - mean
            };
            type Value<'a> = &'a dyn Fn(u64, u32) -> f64;
            let products: [(&str, Value<'_>); 4] = [
                ("the mean", &|s, p| error(s, p, 0)),
                ("the next pixel", &|s, p| error(s, p, 0) * error(s, p + 1, 0)),
                ("another dimension", &|s, p| error(s, p, 0) * error(s, p, 1)),
                ("the next seed", &|s, p| error(s, p, 0) * error(s + 1, p, 0)),
            ];
            for (name, value) in products {
                let off = in_standard_errors(value);
                let name = format!("{}, integrand {number}: {name}", sampling.name());
                assert!(off.abs() <= LARGEST_DEVIATION, "{name}, {off} standard errors");
            }
        }
    }
}

/// The mean of a value over seeds and pixels, in its standard errors.
fn in_standard_errors(value: &dyn Fn(u64, u32) -> f64) -> f64 {
    let all = (1..=SEEDS).flat_map(|seed| (0..SETS).map(move |set| value(seed, set)));
    let (all, count) = (all.collect::<Vec<_>>(), f64::from(SETS) * SEEDS as f64);
    let mean = all.iter().sum::<f64>() / count;
    let variance = all.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (count - 1.0);
    mean / (variance / count).sqrt().max(f64::from(f32::EPSILON))
}

/// The mean of a function over a set of points.
fn estimate(sampling: Sampling, stream: Stream, dimension: u32, of: fn(Vec2) -> f64) -> f64 {
    let count = SIDE * SIDE;
    let values = (0..count).map(|i| {
        let draw = Draw { dimension, first: 0, scramble: dimension, grid: [SIDE, SIDE] };
        let places = [&[stream.pixel][..], &[i]];
        of(Vec2::from(sampling.points::<f32>((), stream, places, draw, |sample| (sample, sample))))
    });
    values.sum::<f64>() / f64::from(count)
}
