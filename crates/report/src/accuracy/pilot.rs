//! Choosing samples for an error or for a time, from a short pilot.
//!
//! No reference is needed: every sampler here is without bias, so that half of the mean squared difference
//! of two renders with random numbers of their own is the mean squared error of one. The pilot takes it in
//! windows all over the image, for a few numbers of points, and goes on along the line through their
//! logarithms. The time of a render is a constant and so much for each point; both are measured on the
//! whole image with few points.

use std::fmt;
use std::time::Instant;

use super::fit::Rng;
use super::setting::Facts;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::{Original, PreparedScene, Samples};
use wavecrest_core::render::{RenderOptions, render};
use wavecrest_core::tile::Tile;

/// Side of a window, in pixels.
const WINDOW: u32 = 8;

/// Windows along each side of the image: one somewhere in each part of a grid.
const WINDOWS: u32 = 12;

/// Sides of the grids that the pilot tries.
const SIDES: [u32; 3] = [2, 4, 8];

/// Sides of the grids whose time it takes.
const TIMED: [u32; 2] = [1, 2];

/// How often it takes them at most, and for how many seconds it begins once more.
const REPEATS: u32 = 5;
const SHORT: f64 = 0.1;

/// What a point costs at least, in parts of the mean time of a point of the finer of these grids.
const LEAST_SHARE: f64 = 0.25;

/// The largest side that is chosen.
const MOST_SIDE: u32 = 1024;

/// The error is estimated so much too small or too large, now and then: what is asked for is undercut by
/// as much.
const MARGIN: f64 = 1.1;

/// Slopes that the error can have: independent points have the first, and none fall quicker than
/// with the power 3/2 of their number.
const SLOPES: [f64; 2] = [-1.5, -0.5];

/// What of a scene is sampled more finely for a smaller error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Points on area lights, from one ray a pixel.
    Lights,
    /// Rays through the lens.
    Lens,
    /// Rays through the pixel.
    Pixel,
}

/// A way to sample a scene, more or less finely.
#[derive(Clone, Debug)]
pub struct Curve {
    /// How points are spread.
    pub sampling: Sampling,
    axis: Axis,
    /// Numbers of points and the root mean square errors found.
    errors: Vec<(f64, f64)>,
    /// Seconds of a whole render whatever the points, and for each.
    seconds: [f64; 2],
}

/// What was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// How points are spread, and along the side of how large a grid.
    pub points: Points,
    /// What is sampled so.
    pub axis: Axis,
    /// Its error, as estimated: root mean square of linear values.
    pub error: f64,
    /// Its seconds of tracing, as estimated.
    pub seconds: f64,
}

/// What a pilot found.
#[derive(Clone, Debug)]
pub struct Pilot {
    /// A way for each sampler.
    pub curves: Vec<Curve>,
}

impl Axis {
    /// That of a scene. Where nothing else is left to chance it is where in a pixel a ray goes, by which edges
    /// alias.
    pub fn of(facts: &Facts) -> Self {
        match facts {
            Facts { antialias: 2.., .. } => Self::Pixel,
            Facts { has_lens: true, .. } => Self::Lens,
            Facts { has_area_lights: true, .. } => Self::Lights,
            _ => Self::Pixel,
        }
    }

    /// The family of settings that a sweep varies it in.
    pub fn family(self) -> &'static str {
        match self {
            Self::Lights => "lights",
            Self::Lens => "lens",
            Self::Pixel => "pixel",
        }
    }

    /// The scene's samples with `points` along this axis. Where a pixel has many rays, each asks a light for
    /// one point.
    pub fn samples(self, points: Points) -> Samples {
        let one = Some(Points { side: 1, ..points });
        let points = Some(points);
        match self {
            Self::Lights => Samples { lights: points, lens: None, pixel: None },
            Self::Lens => Samples { lights: one, lens: points, pixel: None },
            Self::Pixel => Samples { lights: one, lens: one, pixel: points },
        }
    }

    /// What its points are.
    fn name(self) -> &'static str {
        match self {
            Self::Lights => "points on each light",
            Self::Lens => "points on the lens",
            Self::Pixel => "rays a pixel",
        }
    }
}

impl Choice {
    /// The samples to render with.
    pub fn samples(&self) -> Samples {
        self.axis.samples(self.points)
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { points, axis, error, seconds } = self;
        let (count, what, sampler) = (points.count(), axis.name(), points.sampling.name());
        write!(f, "{count} {sampler} {what}: expected error {error:.3e}, {seconds:.2} s of tracing")
    }
}

impl Curve {
    /// The error with `count` points, on the line through the logarithms of the last two that were tried.
    fn error(&self, count: f64) -> f64 {
        let [.., (n, first), (m, last)] = self.errors.as_slice() else { return f64::INFINITY };
        if *last <= 0.0 {
            return 0.0;
        }
        let slope = libm::log(last / first) / libm::log(m / n);
        let slope = if slope.is_finite() { slope.clamp(SLOPES[0], SLOPES[1]) } else { SLOPES[1] };
        last * libm::pow(count / m, slope)
    }

    fn choice(&self, side: u32) -> Choice {
        let points = Points { sampling: self.sampling, side };
        let count = f64::from(points.count());
        let seconds = self.seconds[0] + self.seconds[1] * count;
        Choice { points, axis: self.axis, error: self.error(count), seconds }
    }

    /// The fewest points for `error`; the most that there are where these do not do.
    pub fn for_error(&self, error: f64) -> Choice {
        let choices = (1..=MOST_SIDE).map(|side| self.choice(side));
        choices.into_iter().find(|c| c.error * MARGIN <= error).unwrap_or(self.choice(MOST_SIDE))
    }

    /// The most points for `seconds`; one where there is no time for more.
    pub fn for_time(&self, seconds: f64) -> Choice {
        let choices = (1..=MOST_SIDE).rev().map(|side| self.choice(side));
        choices.into_iter().find(|c| c.seconds <= seconds).unwrap_or(self.choice(1))
    }
}

impl Pilot {
    /// Tries every sampler on `scene`, whose file had `original`, and leaves it as it was. The random numbers
    /// follow from `seed`, and are not those of a render with that seed.
    ///
    /// # Errors
    /// When there is no memory for an image.
    pub fn run(scene: &mut PreparedScene, original: &Original, seed: u64) -> Result<Self> {
        // None of the renders that are timed is to wait for an image.
        scene.appearance.decode()?;
        let axis = Axis::of(&Facts::of(scene));
        let curves = Sampling::ALL.into_iter().map(|s| curve(scene, original, s, axis, seed));
        let curves = curves.collect::<Result<_>>()?;
        scene.resample(original, &Samples::default());
        Ok(Self { curves })
    }

    /// What reaches `error` in the least time.
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

    /// What has the least error in `seconds`.
    pub fn for_time(&self, seconds: f64) -> Option<Choice> {
        let choices = self.curves.iter().map(|curve| curve.for_time(seconds));
        choices.min_by(|a, b| a.error.total_cmp(&b.error))
    }
}

fn curve(
    scene: &mut PreparedScene,
    original: &Original,
    sampling: Sampling,
    axis: Axis,
    seed: u64,
) -> Result<Curve> {
    // The least of several where they are short, taken in turn: other programs can only add to a time.
    let mut times = [f64::INFINITY; TIMED.len()];
    let start = Instant::now();
    for repeat in 0..REPEATS {
        if repeat > 0 && start.elapsed().as_secs_f64() > SHORT {
            break;
        }
        for (side, seconds) in TIMED.into_iter().zip(&mut times) {
            scene.resample(original, &axis.samples(Points { sampling, side }));
            let options = RenderOptions { seed: pilot_seed(seed, 0), ..RenderOptions::default() };
            *seconds = seconds.min(render(scene, &options, &())?.seconds);
        }
    }
    let [few, more] = TIMED.map(|side| f64::from(side * side));
    // What a point costs is not less than a part of the mean: were it nothing, as when a busy machine made the
    // first render the slower one, any number of them would be affordable.
    let each = ((times[1] - times[0]) / (more - few)).max(LEAST_SHARE * times[1] / more);
    let seconds = [(times[0] - each * few).max(0.0), each];
    let mut errors = Vec::new();
    for side in SIDES {
        let points = Points { sampling, side };
        scene.resample(original, &axis.samples(points));
        errors.push((f64::from(points.count()), error(scene, None, seed)?));
    }
    Ok(Curve { sampling, axis, errors, seconds })
}

/// Seeds of pilots, where those of renders are not looked for.
fn pilot_seed(seed: u64, number: u64) -> u64 {
    seed ^ (0x5EED << 40) ^ (number << 32)
}

/// The error of `scene` as it is sampled now, in windows: between two renders of its own, or between `film`,
/// all of the image, and one.
///
/// # Errors
/// When there is no memory for a window.
pub fn error(scene: &PreparedScene, film: Option<&Film>, seed: u64) -> Result<f64> {
    let mut rng = Rng::new(pilot_seed(seed, u64::from(film.is_some())));
    let [width, height] = scene.camera.size();
    let (mut squares, mut values) = (0.0, 0_u64);
    for tile in windows([width, height], &mut rng) {
        let of = |number| {
            let seed = pilot_seed(seed, number);
            let options = RenderOptions { seed, crop: Some(tile), ..RenderOptions::default() };
            render(scene, &options, &()).map(|rendered| rendered.film)
        };
        let one = of(1)?;
        let other = match film {
            Some(film) => film.part([tile.x, tile.y, tile.width, tile.height])?,
            None => of(2)?,
        };
        for (a, b) in one.pixels().iter().zip(other.pixels()) {
            for (a, b) in a.iter().zip(b) {
                let difference = f64::from(*a) - f64::from(*b);
                squares += difference * difference;
                values += 1;
            }
        }
    }
    Ok((squares / 2.0 / values.max(1) as f64).sqrt())
}

/// A window in each part of the image, all of one size; all of the image where it is small.
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
