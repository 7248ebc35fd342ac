//! Chooses samples for an error, from a short pilot, or for a [time](budget).
//!
//! No reference is needed: every sampler here is unbiased, so the variance of independent renders
//! is the mean squared error of one. The pilot measures it in windows all over the image, for a few
//! numbers of points, and extrapolates linearly in logarithms. It is short: of the windows, it takes as many as there is
//! time for. More points are compared with fewer in the same windows. Each choice is then rendered for a moment, which
//! tells its time.
//!
//! Trilinear textures are blurred over less than the distance between the rays of a pixel
//! ([`Camera::footprint`](wavecrest_core::kernels::camera::Camera::footprint)): what they lose is no variance, and is small
//! beside it.
//!
//! One ray through the centre of each pixel is no sample of its area: renders agree in what they
//! miss, so they do not show it. Where rays in a pixel are varied, a choice for an error therefore
//! has at least four; where points on lights or the lens are, the measured error is that of these
//! points, and does not include what such a ray misses at edges.

pub mod budget;
pub mod target;

use std::fmt;
use std::time::Instant;

use super::setting::{Axis, Facts, Truth};
use crate::expected::{tiles, timed};
use crate::plot::number::figure;
use crate::summary::mean_and_error;
use wavecrest_base::error::Result;
use wavecrest_base::parallel;
use wavecrest_core::counters::Counters;
use wavecrest_core::film::Film;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::{Original, PreparedScene, Samples};
use wavecrest_core::render::units::Order;
use wavecrest_core::render::{RenderOptions, Rendered, Watch, camera_rays, render};
use wavecrest_core::tile::Tile;

/// Sides of the sample grids that the pilot tries, the first one again once it has told how long the choice may take.
const SIDES: [u32; 4] = [2, 2, 4, 8];

/// The seconds of a pilot, or this share of those of its choice if that is more, which it may exceed by a little.
const SHORT: f64 = 0.2;
const SHARE: f64 = 0.2;

/// The fewest windows that show how the error depends on the number of points.
const LEAST_WINDOWS: usize = 4;

/// The samplers of a render for an error: random points cost as much, and reach it with more of them.
pub(crate) const SAMPLERS: &[Sampling] = &[Sampling::Jittered, Sampling::Sobol];

/// The share by which times of a moment differ without a cause.
const NOISE: f64 = 0.2;

/// The largest side of a grid that is chosen for a time.
pub const MOST_SIDE: u32 = 1024;

/// The largest side of a grid that a pilot chooses: eight times that of the largest whose error it measures.
const FARTHEST_SIDE: u32 = 64;

/// Factor by which the error may be underestimated: choices reach a requested error with this
/// margin.
const MARGIN: f64 = 1.1;

/// Possible slopes of the error: -1/2 for independent points; none fall faster than with the power
/// -3/2 of their number.
const SLOPES: [f64; 2] = [-1.5, -0.5];

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

impl Chosen {
    /// The samples of the render.
    pub fn samples(&self) -> Samples {
        self.axis.samples(self.points)
    }
}

impl fmt::Display for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { points, axis, error, seconds } = self;
        write!(f, "{}: ", axis.counted(*points))?;
        // Nothing is known of what no ray of the pilot met.
        if error.is_finite() && *error > 0.0 {
            write!(f, "expected error {}, ", figure(*error))?;
        }
        write!(f, "{seconds:.2} s of tracing")
    }
}

/// The error with `count` points, extrapolated in logarithms from the last two of the measured ones.
fn extrapolated(errors: &[(f64, f64)], count: f64) -> f64 {
    let Some((m, last)) = errors.last() else { return f64::INFINITY };
    if *last <= 0.0 {
        return 0.0;
    }
    let slope = match errors {
        [.., (n, first), _] => libm::log(last / first) / libm::log(m / n),
        _ => SLOPES[1],
    };
    let slope = if slope.is_finite() { slope.clamp(SLOPES[0], SLOPES[1]) } else { SLOPES[1] };
    last * libm::pow(count / m, slope)
}

/// The choice of each of these `samplers` for `error`, from a pilot of `scene`, whose samples are restored. The random numbers follow from `seed`, and differ from those of a render with that seed. None if `watch`
/// ends the pilot.
///
/// # Errors
/// If there is no memory for an image.
pub fn choices(
    scene: &mut PreparedScene,
    samplers: &[Sampling],
    error: f64,
    seed: u64,
    watch: &dyn Watch,
) -> Result<Vec<Chosen>> {
    let original = &scene.original();
    // No timed render should wait for an image.
    scene.appearance.decode()?;
    let share = 1.0 / samplers.len() as f64;
    let mut choices = Vec::new();
    for &sampling in samplers {
        let chosen = choose(scene, original, sampling, error, seed, share, watch)?;
        scene.resample(original, &chosen.samples());
        let options = RenderOptions { seed: pilot_seed(seed, 0), ..RenderOptions::default() };
        let all = camera_rays(scene, &options)?;
        let done = |done: &Counters| (1 + done.rays.primary) as f64 / (1 + all) as f64;
        let moment = SHORT * share / PARTS;
        choices.push(Chosen { seconds: timed(scene, &options, moment, done)?.0, ..chosen });
    }
    if watch.cancelled() {
        choices.clear();
    }
    scene.resample(original, &Samples::default());
    Ok(choices)
}

/// The choice that reaches `error` in the least time; of those that do so in nearly this time, the one with
/// the least error.
pub fn best(choices: &[Chosen], error: f64) -> Option<Chosen> {
    let all = || choices.iter().copied();
    let by_error = |a: &Chosen, b: &Chosen| a.error.total_cmp(&b.error);
    let reaching = all().filter(|choice| choice.error <= error).min_by(|a, b| {
        let is_noise = (a.seconds - b.seconds).abs() < NOISE * a.seconds.max(b.seconds);
        if is_noise { by_error(a, b) } else { a.seconds.total_cmp(&b.seconds) }
    });
    reaching.or_else(|| all().min_by(by_error))
}

/// The parts of the time for a sampler: each number of points, a moment of its choice, and what is begun in time and
/// finished later.
const PARTS: f64 = SIDES.len() as f64 + 2.0;

/// The choice of a sampler for `error`, found in this `share` of the time of a pilot.
fn choose(
    scene: &mut PreparedScene,
    original: &Original,
    sampling: Sampling,
    error: f64,
    seed: u64,
    share: f64,
    watch: &dyn Watch,
) -> Result<Chosen> {
    let axis = Axis::of(&Facts::of(scene));
    let (mut allowed, mut last, mut errors) = (SHORT, Vec::new(), Vec::new());
    // The fewest points; the most if none suffices. Their time is not known yet.
    let fewest = |errors: &[(f64, f64)]| {
        let choice = |side| {
            let points = Points { sampling, side };
            let error = extrapolated(errors, f64::from(points.count()));
            Chosen { points, axis, error, seconds: 0.0 }
        };
        // The smallest grid whose error renders show.
        let least = if matches!(axis, Axis::Pixel(_)) { 2 } else { 1 };
        let mut choices = (least..=FARTHEST_SIDE).map(choice);
        choices.find(|c| c.error * MARGIN <= error).unwrap_or(choice(FARTHEST_SIDE))
    };
    for side in SIDES {
        let points = Points { sampling, side };
        let count = f64::from(points.count());
        scene.resample(original, &axis.samples(points));
        let start = Instant::now();
        let found = variances(scene, None, seed, allowed * share / PARTS, watch)?;
        let spent = start.elapsed().as_secs_f64();
        let finished: Vec<f64> = found.iter().copied().flatten().collect();
        match errors.last() {
            Some(&(fewer, before)) if fewer < count => {
                let Some(ratio) = ratio(&last, &found) else { break };
                errors.push((count, before * ratio));
            }
            _ => errors = vec![(count, mean_and_error(&finished).0.sqrt())],
        }
        let measured = measuring_share(scene.camera.size()) * finished.len() as f64;
        let each = spent * found.len() as f64 / (measured * count);
        let wanted = f64::from(fewest(&errors).points.count());
        allowed = SHORT.max(SHARE * each * wanted);
        last = found;
    }
    Ok(fewest(&errors))
}

/// The ratio of the other error to the one, from the windows that both were measured in, if there are enough.
fn ratio(one: &[Option<f64>], other: &[Option<f64>]) -> Option<f64> {
    let both = one.iter().zip(other).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
    let (a, b): (Vec<f64>, Vec<f64>) = both.unzip();
    let ratio = (b.iter().sum::<f64>() / a.iter().sum::<f64>()).sqrt();
    (ratio.is_finite() && a.len() >= LEAST_WINDOWS.min(one.len())).then_some(ratio)
}

/// Side of a window, in pixels.
const WINDOW: u32 = 8;

/// Windows along each side of the image: one at a random place in each cell of a grid.
const WINDOWS: u32 = 12;

/// Seeds of pilots, apart from those of renders.
fn pilot_seed(seed: u64, number: u64) -> u64 {
    seed ^ (0x5EED << 40) ^ (number << 32)
}

/// The work to measure the error of an image of this size, as a share of that of rendering it.
pub fn measuring_share(size: [u32; 2]) -> f64 {
    let pixels: usize = windows(size, 0).iter().map(Tile::len).sum();
    OTHERS as f64 * pixels as f64 / size.map(f64::from).iter().product::<f64>()
}

/// An error measured in windows: root mean squared error of linear values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredError {
    /// The estimate.
    pub error: f64,
    /// The error that the image has at most, with [`CONFIDENCE`]: from the differences between
    /// windows.
    pub at_most: f64,
    /// The share of the pixels that are in windows.
    pub share: f64,
}

/// Why there may be no error.
pub const NO_ERROR: &str =
    "renders with other random numbers are equal wherever they were compared";

/// The confidence of [`MeasuredError::at_most`], as standard errors of a normal distribution: 0.975.
const CONFIDENCE: f64 = 1.96;

/// Renders of each window beside the image that is measured.
const OTHERS: u64 = 2;

/// The error of an image of `scene` with its current samples, in windows; without a meaning if `watch` ends it. `None` if
/// the image is not finished, or if renders do not show their error: with one ray through the centre of each pixel and
/// nothing else left to chance they are all equal, and so they are where no ray meets what is rare.
///
/// # Errors
/// If there is no memory for a window.
pub fn measured(
    scene: &PreparedScene,
    rendered: &Rendered,
    seed: u64,
    watch: &dyn Watch,
) -> Result<Option<MeasuredError>> {
    if !rendered.finished || !Facts::of(scene).is_sampled(Truth::Scene) {
        return Ok(None);
    }
    let found = variances(scene, Some(&rendered.film), seed, f64::INFINITY, watch)?;
    let (mean, deviation) = mean_and_error(&found.into_iter().flatten().collect::<Vec<_>>());
    let at_most = (mean + CONFIDENCE * deviation).sqrt();
    let share = measuring_share(scene.camera.size()) / OTHERS as f64;
    let error = MeasuredError { error: mean.sqrt(), at_most, share };
    Ok(Some(error).filter(|found| found.error > 0.0))
}

/// The variance of some renders of `scene` and of `film`, the whole image, if there is one, in each window that was begun
/// in the first `seconds`: the first ones are all over the image.
///
/// # Errors
/// If there is no memory for a window.
fn variances(
    scene: &PreparedScene,
    film: Option<&Film>,
    seed: u64,
    seconds: f64,
    watch: &dyn Watch,
) -> Result<Vec<Option<f64>>> {
    let start = Instant::now();
    // A window is one tile: all threads have work only if there are several windows at once.
    let tiles = windows(scene.camera.size(), pilot_seed(seed, u64::from(film.is_some())));
    let found = parallel::map(tiles.into_iter(), |tile| {
        if start.elapsed().as_secs_f64() > seconds {
            return Ok(None);
        }
        let window = [tile.x, tile.y, tile.width, tile.height];
        let mut films: Vec<Film> =
            film.map(|film| film.part(window)).into_iter().collect::<Result<_>>()?;
        for number in 1..=OTHERS {
            let seed = pilot_seed(seed, number);
            let options = RenderOptions { seed, crop: Some(tile), ..RenderOptions::default() };
            films.push(render(scene, &options, watch)?.film);
        }
        Ok(Some(variance(&films)))
    });
    found.into_iter().collect()
}

/// The variance of a value between images of one size: the mean over all their values.
pub(super) fn variance(films: &[Film]) -> f64 {
    let n = films.len() as f64;
    let values = films.first().map_or(0, |film| film.pixels().len() * 3);
    let of = |index: usize| {
        let each = || films.iter().map(move |film| f64::from(film.pixels().as_flattened()[index]));
        let mean = each().sum::<f64>() / n;
        each().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0)
    };
    (0..values).map(of).sum::<f64>() / values.max(1) as f64
}

/// A window in each part of the image, at a random place, in an order that is all over the image.
fn windows(size: [u32; 2], seed: u64) -> Vec<Tile> {
    let tiles = tiles(size, WINDOWS, WINDOW, seed);
    let step = Order::Spread.step(tiles.len() as u32) as usize;
    (0..tiles.len()).map(|number| tiles[number * step % tiles.len()]).collect()
}
