//! Chooses samples for an error, from a short pilot, or for a [time](budget).
//!
//! No reference is needed: every sampler here is unbiased, so the variance of independent renders
//! is the mean squared error of one. The pilot measures it in windows all over the image, for a few
//! numbers of points, and extrapolates linearly in logarithms. The time of a render is a constant
//! plus a time for each point; both are measured on the whole image with few points.
//!
//! One ray through the centre of each pixel is no sample of its area: renders agree in what they
//! miss, so they do not show it. Where rays in a pixel are varied, a choice for an error therefore
//! has at least four; where points on lights or the lens are, the measured error is that of these
//! points, and does not include what such a ray misses at edges.

pub mod advice;
pub mod budget;
pub mod measured;
pub mod target;

use std::fmt;

use super::setting::{Axis, Facts};
use crate::plot::number::figure;
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::{Original, PreparedScene, Samples};
use wavecrest_core::render::{RenderOptions, Watch, render};

use measured::pilot_seed;
pub use measured::{MeasuredError, error, measured, measuring_share};

/// Sides of the sample grids that the pilot tries.
const SIDES: [u32; 3] = [2, 4, 8];

/// Sides of the sample grids that it times.
const TIMED: [u32; 2] = [1, 2];

/// Largest number of timings, and the seconds after which no further one starts.
const REPEATS: u32 = 5;
const SHORT: f64 = 0.1;

/// Lower bound on the cost of a point, relative to the mean time of a point of the finer of these
/// grids.
const LEAST_SHARE: f64 = 0.25;

/// The share by which measured times differ without a cause.
const NOISE: f64 = 0.1;

/// The largest side of a chosen grid.
pub const MOST_SIDE: u32 = 1024;

/// Factor by which the error may be underestimated: choices reach a requested error with this
/// margin.
const MARGIN: f64 = 1.1;

/// Possible slopes of the error: -1/2 for independent points; none fall faster than with the power
/// -3/2 of their number.
const SLOPES: [f64; 2] = [-1.5, -0.5];

/// A sampler with its error and time.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Distribution of the points.
    pub sampling: Sampling,
    axis: Axis,
    /// Numbers of points with the measured root mean squared errors.
    errors: Vec<(f64, f64)>,
    /// Seconds of a whole render independent of the points, and for each point.
    seconds: [f64; 2],
}

/// A choice of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chosen {
    /// Distribution of the points, and the side of their grid.
    pub points: Points,
    /// The kind of samples.
    pub axis: Axis,
    /// Its estimated error: root mean squared error of linear values.
    pub error: f64,
    /// Its estimated seconds of tracing.
    pub seconds: f64,
}

/// The results of a pilot.
#[derive(Clone, Debug)]
pub struct Pilot {
    /// A curve for each sampler.
    pub curves: Vec<Curve>,
}

impl Chosen {
    /// The samples of the render.
    pub fn samples(&self) -> Samples {
        self.axis.samples(self.points)
    }

    /// Gives `scene`, whose file had `original`, these samples, and the tree that the expected rays
    /// are worth if that with `preset` may be replaced.
    pub fn apply(
        &self,
        scene: &mut PreparedScene,
        original: &Original,
        preset: Option<&mut Preset>,
    ) {
        scene.resample(original, &self.samples());
        let Some(preset) = preset else { return };
        let (held, rays) = (scene.accel.geometry().held(), scene.expected_rays());
        let best = Preset::choose(held as u64, rays);
        if best != *preset {
            scene.accel.rebuild(best);
            *preset = best;
        }
    }
}

impl fmt::Display for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { points, axis, error, seconds } = self;
        write!(f, "{}: ", axis.counted(*points))?;
        if error.is_finite() {
            write!(f, "expected error {}, ", figure(*error))?;
        }
        write!(f, "{seconds:.2} s of tracing")
    }
}

impl Curve {
    /// The error with `count` points, extrapolated in logarithms from the last two measurements;
    /// infinite if there is none.
    fn error(&self, count: f64) -> f64 {
        let Some((m, last)) = self.errors.last() else { return f64::INFINITY };
        if *last <= 0.0 {
            return 0.0;
        }
        let slope = match self.errors.as_slice() {
            [.., (n, first), _] => libm::log(last / first) / libm::log(m / n),
            _ => SLOPES[1],
        };
        let slope = if slope.is_finite() { slope.clamp(SLOPES[0], SLOPES[1]) } else { SLOPES[1] };
        last * libm::pow(count / m, slope)
    }

    fn choice(&self, side: u32) -> Chosen {
        let points = Points { sampling: self.sampling, side };
        let count = f64::from(points.count());
        let seconds = self.seconds[0] + self.seconds[1] * count;
        Chosen { points, axis: self.axis, error: self.error(count), seconds }
    }

    /// The fewest points for `error`; the largest number if none suffices.
    pub fn for_error(&self, error: f64) -> Chosen {
        let choices = (self.axis.least_side()..=MOST_SIDE).map(|side| self.choice(side));
        choices.into_iter().find(|c| c.error * MARGIN <= error).unwrap_or(self.choice(MOST_SIDE))
    }
}

impl Pilot {
    /// Tests samplers on `scene`, whose file had `original`, and restores the scene. The random numbers
    /// follow from `seed`, and differ from those of a render with that seed. If `watch` ends the pilot, it
    /// has no curve.
    ///
    /// # Errors
    /// If there is no memory for an image.
    pub fn run(
        scene: &mut PreparedScene,
        original: &Original,
        seed: u64,
        watch: &dyn Watch,
    ) -> Result<Self> {
        // No timed render should wait for an image.
        scene.appearance.decode()?;
        let axis = Axis::of(&Facts::of(scene));
        let mut curves: Vec<Curve> = Vec::new();
        for sampling in Sampling::ALL {
            curves.push(curve(scene, original, (sampling, axis), seed, watch)?);
        }
        if watch.cancelled() {
            curves.clear();
        }
        scene.resample(original, &Samples::default());
        Ok(Self { curves })
    }

    /// The choice that reaches `error` in the least time; of those that do so in nearly this time, the one with
    /// the least error.
    pub fn for_error(&self, error: f64) -> Option<Chosen> {
        let choices = || self.curves.iter().map(|curve| curve.for_error(error));
        let reaching = || choices().filter(|choice| choice.error <= error);
        let least = reaching().map(|choice| choice.seconds).fold(f64::INFINITY, f64::min);
        let fast = reaching().filter(|choice| choice.seconds <= least * (1.0 + NOISE));
        let best = fast.min_by(|a, b| a.error.total_cmp(&b.error));
        best.or_else(|| choices().min_by(|a, b| a.error.total_cmp(&b.error)))
    }
}

fn curve(
    scene: &mut PreparedScene,
    original: &Original,
    (sampling, axis): (Sampling, Axis),
    seed: u64,
    watch: &dyn Watch,
) -> Result<Curve> {
    let resample = |scene: &mut PreparedScene, side| {
        let points = Points { sampling, side };
        scene.resample(original, &axis.samples(points));
        f64::from(points.count())
    };
    let seconds = cost(|side| {
        resample(scene, side);
        let options = RenderOptions { seed: pilot_seed(seed, 0), ..RenderOptions::default() };
        render(scene, &options, watch).map(|rendered| rendered.seconds)
    })?;
    let mut errors = Vec::new();
    for side in SIDES {
        let count = resample(scene, side);
        errors.push((count, error(scene, None, seed, watch)?.error));
    }
    Ok(Curve { sampling, axis, errors, seconds })
}

/// Seconds of a whole render independent of the points, and for each point, where `trace` returns
/// those of a render with a grid of this side.
fn cost(mut trace: impl FnMut(u32) -> Result<f64>) -> Result<[f64; 2]> {
    let [few, more] = TIMED.map(|side| f64::from(side * side));
    // The least of several alternating runs if they are short: other programs can only add to a
    // time.
    let mut times = [trace(TIMED[0])?, trace(TIMED[1])?];
    let mut spent: f64 = times.iter().sum();
    for _ in 1..REPEATS {
        if spent > SHORT {
            break;
        }
        for (side, least) in TIMED.into_iter().zip(&mut times) {
            let seconds = trace(side)?;
            *least = least.min(seconds);
            spent += seconds;
        }
    }
    // A point costs at least a part of the mean. If a busy machine slowed the first render, a point
    // would otherwise seem free, and any number affordable.
    let each = ((times[1] - times[0]) / (more - few)).max(LEAST_SHARE * times[1] / more);
    Ok([(times[0] - each * few).max(0.0), each])
}
