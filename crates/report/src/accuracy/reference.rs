//! Reference images for errors, with their own standard error.
//!
//! A reference is the mean of several renders with the reference kernel and different random numbers.
//! Each is unbiased, so their spread estimates the distance of the mean from the truth: the
//! standard error, as a root mean square over all values of the image. An error below [`FLOOR`]
//! standard errors is noise of the reference; renders are added until the reference is accurate
//! enough for the comparisons, or until there are [`MOST_REPLICATES`].

use super::setting::{Setting, Target};
use super::subject::Subject;
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::film::Film;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::Samples;
use wavecrest_core::render::RenderOptions;

/// Errors of at least this many standard errors are above the noise of the reference.
pub const FLOOR: f64 = 3.0;

/// Smallest number of renders of a reference: fewer would not show their spread.
const LEAST_REPLICATES: u32 = 4;

/// Largest number of renders.
const MOST_REPLICATES: u32 = 32;

/// Their first seed, which no other render uses.
const FIRST_SEED: u64 = 1 << 63;

/// A reference picture.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The mean.
    pub film: Film,
    /// Points of each kind in each pixel, all renders together.
    pub samples: u64,
    /// The number of renders.
    pub replicates: u32,
    /// Root mean square, over all values, of the standard error of the mean.
    pub standard_error: f64,
    /// Seconds that it took.
    pub seconds: f64,
}

impl Reference {
    /// Whether `rmse`, an error against it, is above its noise.
    pub fn believes(&self, rmse: f64) -> bool {
        rmse >= FLOOR * self.standard_error
    }
}

/// Sums over renders.
struct Sums {
    sum: Vec<[f64; 3]>,
    squares: Vec<[f64; 3]>,
    count: u32,
}

impl Sums {
    fn new(pixels: usize) -> Self {
        Self { sum: vec![[0.0; 3]; pixels], squares: vec![[0.0; 3]; pixels], count: 0 }
    }

    fn add(&mut self, film: &Film) {
        self.count += 1;
        let rows = self.sum.iter_mut().zip(&mut self.squares).zip(film.pixels());
        for ((sum, squares), pixel) in rows {
            for ((sum, squares), &value) in sum.iter_mut().zip(squares).zip(pixel) {
                *sum += f64::from(value);
                *squares += f64::from(value) * f64::from(value);
            }
        }
    }

    /// Mean and variance of each value, pixel by pixel.
    fn moments(&self) -> impl Iterator<Item = ([f64; 3], [f64; 3])> {
        let n = f64::from(self.count);
        self.sum.iter().zip(&self.squares).map(move |(sum, squares)| {
            let variance = |channel: usize| {
                let (sum, squares) = (sum[channel], squares[channel]);
                ((squares - sum * sum / n) / (n - 1.0).max(1.0)).max(0.0)
            };
            (sum.map(|s| s / n), [variance(0), variance(1), variance(2)])
        })
    }

    /// The mean.
    fn film(&self, [width, height]: [u32; 2]) -> Result<Film> {
        let mean = self.moments().map(|(mean, _)| mean.map(|v| v as f32)).collect();
        Film::from_pixels(width, height, mean)
    }

    /// See [`Reference::standard_error`].
    fn standard_error(&self) -> f64 {
        let variances: f64 = self.moments().flat_map(|(_, variance)| variance).sum();
        (variances / f64::from(self.count) / (3 * self.sum.len()).max(1) as f64).sqrt()
    }
}

/// The setting of the reference of `target`, and the number of points of each kind in the scene: at
/// least `least` for each sampled kind.
fn setting(subject: &Subject, target: Target, least: u32) -> (Setting, u32) {
    let facts = subject.facts();
    let mut samples = Samples::default();
    let mut count = 1;
    if facts.is_sampled(target) {
        let many = Points { sampling: Sampling::Sobol, side: least.isqrt() };
        let many = if many.count() < least { Points { side: many.side + 1, ..many } } else { many };
        count = many.count();
        let one = Some(Points { side: 1, ..many });
        let many = Some(many);
        // With many rays in a pixel, each has one point of the sequence on each light and on the
        // lens.
        samples = if target == Target::Pixel || facts.antialias > 1 {
            Samples { pixel: many, lens: one, lights: one }
        } else if facts.has_lens {
            Samples { pixel: None, lens: many, lights: one }
        } else {
            Samples { pixel: None, lens: None, lights: many }
        };
    }
    (Setting { samples, ..Setting::default() }, count)
}

/// The least work of a reference, in points of each pixel: see [`Setting::work`].
pub fn least_work(least: u32) -> u64 {
    REFERENCE_COST * u64::from(LEAST_REPLICATES) * u64::from(least)
}

/// How many times as long as the usual kernel the reference kernel takes, roughly.
const REFERENCE_COST: u64 = 3;

/// Renders the reference of `target`, with at least `least` points of each kind, until errors of
/// `smallest` are above its noise.
///
/// # Errors
/// If the scene can no longer be rendered.
pub fn make(
    subject: &mut Subject,
    target: Target,
    least: u32,
    smallest: impl Fn(&mut Subject, &Film) -> Result<f64>,
) -> Result<Reference> {
    let (setting, count) = setting(subject, target, least);
    let is_sampled = subject.facts().is_sampled(target);
    let [width, height] = subject.size();
    let mut sums = Sums::new(width as usize * height as usize);
    let mut seconds = 0.0;
    loop {
        let seed = FIRST_SEED + u64::from(sums.count);
        let options = RenderOptions { seed, ..RenderOptions::default() };
        let rendered = subject.render_with(KernelChoice::Reference, &setting, &options)?;
        seconds += rendered.seconds;
        sums.add(&rendered.film);
        let enough = if is_sampled { LEAST_REPLICATES } else { 1 };
        if sums.count < enough {
            continue;
        }
        let standard_error = if is_sampled { sums.standard_error() } else { 0.0 };
        let samples = u64::from(sums.count) * u64::from(count);
        let film = sums.film([width, height])?;
        let replicates = sums.count;
        let made = Reference { film, samples, replicates, standard_error, seconds };
        let done = standard_error == 0.0
            || replicates >= MOST_REPLICATES
            || made.believes(smallest(subject, &made.film)?);
        if done {
            return Ok(made);
        }
    }
}
