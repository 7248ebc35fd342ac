//! Chooses samples for an error or a time, from a short pilot.
//!
//! No reference is needed: every sampler here is unbiased, so the variance of independent renders
//! is the mean squared error of one. The pilot measures it in windows all over the image, for a few
//! numbers of points, and extrapolates linearly in logarithms. The time of a render is a constant
//! plus a time for each point; both are measured on the whole image with few points. A pilot with
//! little time measures fewer samplers and fewer numbers of points.
//!
//! One ray through the centre of each pixel is no sample of its area: renders agree in what they
//! miss, so they do not show it. Where rays in a pixel are varied, a choice for an error therefore
//! has at least four; where points on lights or the lens are, the measured error is that of these
//! points, and does not include what such a ray misses at edges.

pub mod budget;
pub mod target;

use std::fmt;
use std::time::Instant;

use rayon::prelude::*;

use super::fit::Rng;
use super::setting::{Facts, Target};
use crate::plot::number::figure;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::{Original, PreparedScene, Samples};
use wavecrest_core::render::{RenderOptions, render};
use wavecrest_core::tile::Tile;

/// Side of a window, in pixels.
const WINDOW: u32 = 8;

/// Windows along each side of the image: one at a random place in each cell of a grid.
const WINDOWS: u32 = 12;

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

/// The largest side of a chosen grid.
pub const MOST_SIDE: u32 = 1024;

/// Factor by which the error may be underestimated: choices reach a requested error with this
/// margin.
const MARGIN: f64 = 1.1;

/// Possible slopes of the error: -1/2 for independent points; none fall faster than with the power
/// -3/2 of their number.
const SLOPES: [f64; 2] = [-1.5, -0.5];

/// The kind of samples to vary for a smaller error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Points on area lights, for one ray a pixel.
    Lights,
    /// Rays through the lens.
    Lens,
    /// Rays through the pixel.
    Pixel,
}

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
pub struct Choice {
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

impl Axis {
    /// The axis of a scene. Without other random samples it is the pixel, as edges alias.
    pub fn of(facts: &Facts) -> Self {
        match facts {
            Facts { antialias: 2.., .. } => Self::Pixel,
            Facts { has_lens: true, .. } => Self::Lens,
            Facts { has_area_lights: true, .. } => Self::Lights,
            _ => Self::Pixel,
        }
    }

    /// The family of settings in which a sweep varies it.
    pub fn family(self) -> &'static str {
        match self {
            Self::Lights => "lights",
            Self::Lens => "lens",
            Self::Pixel => "pixel",
        }
    }

    /// The scene's samples with `points` along this axis. If a pixel has many rays, each takes one
    /// point of a light.
    pub fn samples(self, points: Points) -> Samples {
        let one = Some(Points { side: 1, ..points });
        let points = Some(points);
        match self {
            Self::Lights => Samples { lights: points, lens: None, pixel: None },
            Self::Lens => Samples { lights: one, lens: points, pixel: None },
            Self::Pixel => Samples { lights: one, lens: one, pixel: points },
        }
    }

    /// The smallest grid whose error renders show.
    fn least_side(self) -> u32 {
        if self == Self::Pixel { 2 } else { 1 }
    }

    /// A number of its points.
    fn counted(self, points: Points) -> String {
        let (thing, place) = match self {
            Self::Lights => ("point", "on each light"),
            Self::Lens => ("point", "on the lens"),
            Self::Pixel => ("ray", "per pixel"),
        };
        let plural = if points.count() == 1 { "" } else { "s" };
        format!("{} {} {thing}{plural} {place}", points.count(), points.sampling.name())
    }
}

impl Choice {
    /// The samples of the render.
    pub fn samples(&self) -> Samples {
        self.axis.samples(self.points)
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { points, axis, error, seconds } = self;
        let points = axis.counted(*points);
        match error.is_finite() {
            true => write!(f, "{points}: expected error {}, ", figure(*error))?,
            false => write!(f, "{points}: unknown error, ")?,
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

    fn choice(&self, side: u32) -> Choice {
        let points = Points { sampling: self.sampling, side };
        let count = f64::from(points.count());
        let seconds = self.seconds[0] + self.seconds[1] * count;
        Choice { points, axis: self.axis, error: self.error(count), seconds }
    }

    /// The fewest points for `error`; the largest number if none suffices.
    pub fn for_error(&self, error: f64) -> Choice {
        let choices = (self.axis.least_side()..=MOST_SIDE).map(|side| self.choice(side));
        choices.into_iter().find(|c| c.error * MARGIN <= error).unwrap_or(self.choice(MOST_SIDE))
    }

    /// The most points for `seconds`; one if there is no time for more.
    pub fn for_time(&self, seconds: f64) -> Choice {
        let choices = (1..=MOST_SIDE).rev().map(|side| self.choice(side));
        choices.into_iter().find(|c| c.seconds <= seconds).unwrap_or(self.choice(1))
    }
}

impl Pilot {
    /// Tests every sampler on `scene`, whose file had `original`, and restores the scene. The
    /// random numbers follow from `seed`, and differ from those of a render with that seed.
    ///
    /// # Errors
    /// If there is no memory for an image.
    pub fn run(scene: &mut PreparedScene, original: &Original, seed: u64) -> Result<Self> {
        Self::within(scene, original, seed, &|_| true)
    }

    /// As [`Pilot::run`], while `fits` allows work of some seconds. At least the time of one point
    /// with the best sampler is measured.
    ///
    /// # Errors
    /// As [`Pilot::run`].
    pub fn within(
        scene: &mut PreparedScene,
        original: &Original,
        seed: u64,
        fits: &dyn Fn(f64) -> bool,
    ) -> Result<Self> {
        // No timed render should wait for an image.
        scene.appearance.decode()?;
        let axis = Axis::of(&Facts::of(scene));
        let mut curves: Vec<Curve> = Vec::new();
        let mut seconds = 0.0;
        // The best first.
        for sampling in Sampling::ALL.into_iter().rev() {
            if !curves.is_empty() && !fits(seconds) {
                break;
            }
            let start = Instant::now();
            curves.push(curve(scene, original, (sampling, axis), seed, fits)?);
            seconds = f64::max(seconds, start.elapsed().as_secs_f64());
        }
        curves.reverse();
        scene.resample(original, &Samples::default());
        Ok(Self { curves })
    }

    /// The choice that reaches `error` in the least time.
    pub fn for_error(&self, error: f64) -> Option<Choice> {
        let choices = self.curves.iter().map(|curve| curve.for_error(error));
        let reaches = |c: &Choice| c.error <= error;
        choices.min_by(|a, b| {
            reaches(b).cmp(&reaches(a)).then(if reaches(a) {
                a.seconds.total_cmp(&b.seconds)
            } else {
                a.error.total_cmp(&b.error)
            })
        })
    }

    /// The choice with the least error in `seconds`.
    pub fn for_time(&self, seconds: f64) -> Option<Choice> {
        let choices = self.curves.iter().map(|curve| curve.for_time(seconds));
        choices.min_by(|a, b| a.error.total_cmp(&b.error))
    }
}

/// The cost of an error with one sampler.
#[derive(Clone, Copy, Debug)]
pub struct Advice {
    /// The choice, as the pilot expects it.
    pub choice: Choice,
    /// Seconds of tracing the image, and its error; `None` if the choice takes too long to try.
    pub measured: Option<(f64, Measured)>,
}

/// Choices that take longer than this in seconds are not tried.
const TRIED: f64 = 5.0;

/// What `error` costs with each sampler: the choices of a pilot, tried on the whole image. The scene
/// is restored.
///
/// # Errors
/// As [`Pilot::run`].
pub fn advise(
    scene: &mut PreparedScene,
    original: &Original,
    error: f64,
    seed: u64,
) -> Result<Vec<Advice>> {
    let pilot = Pilot::run(scene, original, seed)?;
    let mut advice = Vec::new();
    for curve in &pilot.curves {
        let choice = curve.for_error(error);
        let mut measured = None;
        if choice.seconds <= TRIED {
            scene.resample(original, &choice.samples());
            let options = RenderOptions { seed, ..RenderOptions::default() };
            let rendered = render(scene, &options, &())?;
            let again = render(scene, &options, &())?.seconds;
            let error = self::error(scene, Some(&rendered.film), seed)?;
            measured = Some((rendered.seconds.min(again), error));
        }
        advice.push(Advice { choice, measured });
    }
    scene.resample(original, &Samples::default());
    Ok(advice)
}

impl Advice {
    /// Seconds of tracing: measured, or expected of a choice that was not tried.
    pub fn seconds(&self) -> f64 {
        self.measured.map_or(self.choice.seconds, |(seconds, _)| seconds)
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((seconds, found)) = self.measured else {
            return write!(f, "{} (not tried)", self.choice);
        };
        let points = self.choice.axis.counted(self.choice.points);
        write!(f, "{points}: error {}, {seconds:.3} s of tracing", figure(found.error))
    }
}

fn curve(
    scene: &mut PreparedScene,
    original: &Original,
    (sampling, axis): (Sampling, Axis),
    seed: u64,
    fits: &dyn Fn(f64) -> bool,
) -> Result<Curve> {
    let resample = |scene: &mut PreparedScene, side| {
        let points = Points { sampling, side };
        scene.resample(original, &axis.samples(points));
        f64::from(points.count())
    };
    let seconds = cost(fits, |side| {
        resample(scene, side);
        let options = RenderOptions { seed: pilot_seed(seed, 0), ..RenderOptions::default() };
        render(scene, &options, &()).map(|rendered| rendered.seconds)
    })?;
    let mut errors = Vec::new();
    for side in SIDES {
        let count = resample(scene, side);
        let share = measured_share(scene.camera.size());
        if !fits(OTHERS as f64 * share * (seconds[0] + seconds[1] * count)) {
            break;
        }
        errors.push((count, error(scene, None, seed)?.error));
    }
    Ok(Curve { sampling, axis, errors, seconds })
}

/// Seconds of a whole render independent of the points, and for each point, where `trace` returns
/// those of a render with a grid of this side.
fn cost(fits: &dyn Fn(f64) -> bool, mut trace: impl FnMut(u32) -> Result<f64>) -> Result<[f64; 2]> {
    let [few, more] = TIMED.map(|side| f64::from(side * side));
    let first = trace(TIMED[0])?;
    // Without time for more points, the whole render counts as the cost of its points.
    if !fits(first * more / few) {
        return Ok([0.0, first / few]);
    }
    // The least of several alternating runs if they are short: other programs can only add to a
    // time.
    let mut times = [first, trace(TIMED[1])?];
    let mut spent: f64 = times.iter().sum();
    for _ in 1..REPEATS {
        if spent > SHORT || !fits(times.iter().sum()) {
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

/// Seeds of pilots, apart from those of renders.
fn pilot_seed(seed: u64, number: u64) -> u64 {
    seed ^ (0x5EED << 40) ^ (number << 32)
}

/// Whether renders of `scene` show the error of its samples: with one ray through the centre of
/// each pixel and nothing else left to chance, they are all equal.
pub fn is_sampled(scene: &PreparedScene) -> bool {
    Facts::of(scene).is_sampled(Target::Scene)
}

/// Whether the error of `scene` leaves out what one ray through the centre of each pixel misses.
pub fn leaves_out_aliasing(scene: &PreparedScene) -> bool {
    scene.camera.antialias() == 1
}

/// The share of an image of this size that is in windows.
pub fn measured_share(size: [u32; 2]) -> f64 {
    let pixels: usize = windows(size, &mut Rng::new(0)).iter().map(Tile::len).sum();
    pixels as f64 / size.map(f64::from).iter().product::<f64>()
}

/// An error measured in windows: root mean squared error of linear values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The estimate.
    pub error: f64,
    /// The error that the image has at most, with [`CONFIDENCE`]: from the differences between
    /// windows.
    pub at_most: f64,
}

/// The confidence of [`Measured::at_most`], as standard errors of a normal distribution: 0.975.
const CONFIDENCE: f64 = 1.96;

/// Renders of each window beside the image that is measured.
const OTHERS: u64 = 2;

/// The error of `scene` with its current samples, in windows, from the variance of some renders and
/// of `film`, the whole image, if there is one. Without random samples all are equal, and say
/// nothing of the error: see [`is_sampled`].
///
/// # Errors
/// If there is no memory for a window.
pub fn error(scene: &PreparedScene, film: Option<&Film>, seed: u64) -> Result<Measured> {
    let mut rng = Rng::new(pilot_seed(seed, u64::from(film.is_some())));
    // A window is one tile: all threads have work only if there are several windows at once.
    let tiles = windows(scene.camera.size(), &mut rng);
    let found = tiles.into_par_iter().map(|tile| {
        let window = [tile.x, tile.y, tile.width, tile.height];
        let mut films: Vec<Film> =
            film.map(|film| film.part(window)).into_iter().collect::<Result<_>>()?;
        for number in 1..=OTHERS {
            let seed = pilot_seed(seed, number);
            let options = RenderOptions { seed, crop: Some(tile), ..RenderOptions::default() };
            films.push(render(scene, &options, &())?.film);
        }
        Ok(variance(&films))
    });
    let found: Vec<f64> = found.collect::<Result<_>>()?;
    let n = found.len() as f64;
    let mean = found.iter().sum::<f64>() / n;
    let squares: f64 = found.iter().map(|each| (each - mean) * (each - mean)).sum();
    let deviation = (squares / (n - 1.0).max(1.0) / n).sqrt();
    Ok(Measured { error: mean.sqrt(), at_most: (mean + CONFIDENCE * deviation).sqrt() })
}

/// The variance of a value between images of one size: the mean over all their values.
fn variance(films: &[Film]) -> f64 {
    let n = films.len() as f64;
    let values = films.first().map_or(0, |film| film.pixels().len() * 3);
    let of = |index: usize| {
        let each = || films.iter().map(move |film| f64::from(film.pixels().as_flattened()[index]));
        let mean = each().sum::<f64>() / n;
        each().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0)
    };
    (0..values).map(of).sum::<f64>() / values.max(1) as f64
}

/// A window in each part of the image, all of one size; the whole image if it is small.
fn windows([width, height]: [u32; 2], rng: &mut Rng) -> Vec<Tile> {
    let parts = |side: u32| (side / WINDOW).clamp(1, WINDOWS);
    let (columns, rows) = (parts(width), parts(height));
    let mut place = |part: u32, parts: u32, side: u32| {
        let bound = |part: u32| (u64::from(side) * u64::from(part) / u64::from(parts)) as u32;
        let (start, end) = (bound(part), bound(part + 1));
        let length = WINDOW.min(end - start);
        (start + rng.below((end - start - length) as usize + 1) as u32, length)
    };
    let mut tiles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (x, width) = place(column, columns, width);
            let (y, height) = place(row, rows, height);
            tiles.push(Tile { x, y, width, height });
        }
    }
    tiles
}
