//! Renders towards a goal: an error, a time, or whichever comes first.
//!
//! Every pixel gets the first points of one Sobol sequence, in passes over the whole image that double their number.
//! Nothing is predicted but the time of the next pass, and nothing is rendered twice: the image after each pass has the
//! bits of a render with that many samples, and its error follows from the pass and what was before ([`Passes`]).
//! Lights keep the points that the file gives them.

use std::path::Path;
use std::time::Instant;

use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_core::film::Film;
use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::work::RenderWork;
use wavecrest_core::render::{RenderOptions, Rendered, Watch};
use wavecrest_core::tile::Tile;
use wavecrest_image::farm::checkpoint::Checkpoint;
use wavecrest_image::farm::{Author, Pass, Passes};

/// The largest number of samples of a pixel that a goal may take.
pub const MOST_SAMPLES: u32 = 1 << 14;

/// The fewest samples whose error is believed, and of an error of 0: something rare may be in none of them.
const LEAST: u32 = 4;
const LEAST_EQUAL: u32 = 16;

/// The parts of a doubling of which the last passes have one or more.
const PARTS: u32 = 8;

/// The share of the remaining time to plan a pass for: one that is not finished is lost, and what is left is for smaller
/// ones.
const PLANNED: f64 = 0.88;

/// What is kept of a time for the end of the process, as a share and in seconds.
const KEPT: [f64; 2] = [0.01, 0.015];

/// Possible slopes of the error: -1/2 for independent points; none fall faster than with the power
/// -3/2 of their number.
const SLOPES: [f64; 2] = [-1.5, -0.5];

/// What ends a render, whichever comes first; without any of it, the most samples that there may be.
#[derive(Clone, Copy, Debug, Default)]
pub struct Goal {
    /// An error of the image: root mean squared error of linear values.
    pub error: Option<f64>,
    /// Seconds, and from when they count.
    pub seconds: Option<(f64, Instant)>,
    /// Samples of each pixel; [`MOST_SAMPLES`] if there are more, or none.
    pub samples: Option<u32>,
}

/// What a render towards a goal is done with.
pub struct Job<'a> {
    /// Receives tiles, progress and finished passes, and may end it.
    pub watch: &'a dyn Watch,
    /// Receives failures of the checkpoint, which do not end it.
    pub warn: &'a (dyn Fn(&Error) + Sync),
    /// The seconds of what is to be done after the last sample, for so many rows of the image, with the samples of the
    /// scene: of layers, and of files.
    pub ending: &'a Rehearsal<'a>,
}

/// Measures the end of a render: see [`Job::ending`].
pub type Rehearsal<'a> = dyn Fn(&PreparedScene, &Film, u32) -> Result<[f64; 2]> + 'a;

impl<'a> Job<'a> {
    /// A render without a checkpoint that needs no time after its last sample.
    pub fn new(watch: &'a dyn Watch) -> Self {
        Self { watch, warn: &|_| {}, ending: &|_, _, _| Ok([0.0; 2]) }
    }
}

/// The seconds that are needed after the last sample: in any case, and for each sample of each pixel.
#[derive(Clone, Copy, Default)]
struct Ending {
    fixed: f64,
    each: f64,
}

/// The part of an image with which is measured what all of it takes, and the samples of its layers.
const BANDS: u32 = 8;
const LAYERED: u32 = 5;

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// Its error is small enough.
    Error,
    /// There is no time for more.
    Time,
    /// It has the most samples.
    Samples,
    /// `watch` ended it.
    Cancelled,
}

/// A render that has come to its end.
#[derive(Clone, Debug)]
pub struct Reached {
    /// The image.
    pub rendered: Rendered,
    /// The samples of each pixel; 0 if the first pass is not finished.
    pub samples: u32,
    /// Its error, if it has two samples or more.
    pub error: Option<f64>,
    /// Why it ended.
    pub end: End,
    /// The passes that this render finished, and their seconds.
    pub passes: u32,
    /// See there.
    pub seconds: f64,
    /// The share of its samples that a checkpoint held.
    pub resumed: f64,
}

impl Goal {
    /// The passes of a render of `scene`, kept in a checkpoint if there is one, with this origin.
    ///
    /// # Errors
    /// If the crop is not within the image, or the checkpoint cannot be used.
    pub fn passes(
        scene: &mut PreparedScene,
        options: RenderOptions,
        (checkpoint, author): (Option<Checkpoint>, Author),
    ) -> Result<Passes> {
        let own = scene.camera;
        scene.camera = own.in_sequence(MOST_SAMPLES);
        let passes = Passes::begin(scene, options, author, None, (checkpoint, true));
        scene.camera = own;
        passes
    }

    /// Renders `scene` in [`Self::passes`]. Its camera then has the samples of the image, so that its layers have the same.
    ///
    /// # Errors
    /// If there is no memory for the image, an image cannot be decoded, or `job.ending` fails.
    pub fn render(
        &self,
        scene: &mut PreparedScene,
        passes: &Passes,
        job: &Job<'_>,
    ) -> Result<Reached> {
        let camera = scene.camera;
        scene.camera = camera.in_sequence(MOST_SAMPLES);
        let reached = Pursuit { goal: self, job, camera, passes }.follow(scene);
        scene.camera = camera.in_sequence(passes.pass().from.max(1));
        passes.save(job.warn);
        reached
    }

    /// Whether the image is good enough.
    fn is_reached(&self, Pass { from, error, .. }: Pass) -> bool {
        let (Some(target), Some(error)) = (self.error, error) else { return false };
        error <= target && from >= if error > 0.0 { LEAST } else { LEAST_EQUAL }
    }

    /// The warning that an error of the image of `file` was not reached, if one was asked for.
    pub fn unreached(&self, reached: &Reached, file: &Path) -> Option<Warning> {
        let target = self.error.filter(|_| reached.end != End::Error)?;
        let found = match reached.error {
            Some(error) if error > target => format!("it is {error:.3e}"),
            _ => format!("it is not certain after {} samples", reached.samples),
        };
        let message = format!("the target error {target} was not reached: {found}");
        let remedy = match reached.end {
            End::Samples => "choose a larger error, or more samples if there are any",
            _ => "choose a larger error, or give more time",
        };
        let error = Error::new(ErrorKind::Usage, message).in_file(file).remedy(remedy);
        Some(Warning::from_error(&error))
    }
}

/// The passes of a render.
struct Pursuit<'a> {
    goal: &'a Goal,
    job: &'a Job<'a>,
    /// The scene's own.
    camera: Camera,
    passes: &'a Passes,
}

impl Pursuit<'_> {
    fn follow(&self, scene: &mut PreparedScene) -> Result<Reached> {
        let begun = self.passes.pass();
        let held = self.passes.resumed().map_or(0.0, |share| match begun.to - begun.from {
            0 => f64::from(begun.from),
            more => f64::from(begun.from) + share * f64::from(more),
        });
        let (mut work, mut count, mut all) = (None::<RenderWork>, 0, 0.0);
        let (mut pace, mut slope) = (None, SLOPES[1]);
        let mut ending = if begun.from > 0 { self.ending(scene)? } else { Ending::default() };
        let end = loop {
            let pass = self.passes.pass();
            let left = self.left(&ending, pass.from);
            let next = if pass.to > pass.from {
                Ok(pass.to)
            } else {
                let each = pace.map(|seconds: f64| left / (seconds + ending.each));
                next(self.goal, pass, slope, each)
            };
            let to = match next {
                Ok(to) => to,
                Err(end) => break end,
            };
            // The first pass makes an image at least.
            let left = match pass.from {
                0 => f64::INFINITY,
                from => left - ending.each * f64::from(to - from),
            };
            let start = Instant::now();
            let until = Until { watch: self.job.watch, start, left };
            let done = self.passes.advance(scene, to, &until, self.job.warn)?;
            let seconds = start.elapsed().as_secs_f64();
            match &mut work {
                Some(work) => work.add(done),
                None => work = Some(done),
            }
            let now = self.passes.pass();
            if now.from < to {
                let is_cancelled = self.job.watch.cancelled();
                break if is_cancelled { End::Cancelled } else { End::Time };
            }
            (count, all) = (count + 1, all + seconds);
            // Of a pass that a checkpoint held in part the time says nothing.
            let is_whole = pass.to == pass.from || self.passes.resumed().is_none();
            pace = is_whole.then(|| seconds / f64::from(to - pass.from));
            if let (Some(before), Some(error)) = (pass.error, now.error) {
                let more = f64::from(to) / f64::from(pass.from);
                let ratio = libm::log(error / before) / libm::log(more);
                slope = if ratio.is_finite() { ratio.clamp(SLOPES[0], SLOPES[1]) } else { slope };
            }
            self.job.watch.pass(now.from, now.error);
            if pass.from == 0 {
                ending = self.ending(scene)?;
            }
        };
        let Pass { from: samples, error, .. } = self.passes.pass();
        let work = work.unwrap_or_else(|| RenderWork::none(scene));
        let rendered = Rendered::new(self.passes.painted()?, work);
        let resumed = if samples > 0 { held / f64::from(samples) } else { 0.0 };
        Ok(Reached { rendered, samples, error, end, passes: count, seconds: all, resumed })
    }

    /// What is to be done after the last sample, if there is a time for that; nothing if it cannot be measured.
    fn ending(&self, scene: &mut PreparedScene) -> Result<Ending> {
        if self.goal.seconds.is_none() {
            return Ok(Ending::default());
        }
        let of_all = scene.camera;
        let film = self.passes.painted()?.film;
        let mut measure = |samples, rows| {
            scene.camera = self.camera.in_sequence(samples);
            (self.job.ending)(scene, &film, rows)
        };
        let band = film.height().div_ceil(BANDS);
        let measured = measure(1, 1)
            .and_then(|row| Ok([row, measure(1, band)?, measure(LAYERED, band)?]))
            .inspect_err(self.job.warn);
        scene.camera = of_all;
        let [[row_layers, row_files], [layers, files], [more, _]] = measured.unwrap_or_default();
        // What even one row takes does not grow with their number.
        let times = f64::from(film.height()) / f64::from(band);
        let of_all = |row: f64, band: f64| row + times * (band - row).max(0.0);
        let each = times * (more - layers).max(0.0) / f64::from(LAYERED - 1);
        let start = Instant::now();
        self.passes.save(self.job.warn);
        let fixed = of_all(row_files, files) + (of_all(row_layers, layers) - each).max(0.0);
        Ok(Ending { fixed: fixed + start.elapsed().as_secs_f64(), each })
    }

    /// The seconds that are left for passes after this number of samples.
    fn left(&self, ending: &Ending, samples: u32) -> f64 {
        let Some((seconds, start)) = self.goal.seconds else { return f64::INFINITY };
        let last = ending.fixed + ending.each * f64::from(samples);
        seconds * (1.0 - KEPT[0]) - KEPT[1] - last - start.elapsed().as_secs_f64()
    }
}

/// The number of samples after the next pass, of which there is time for so many more; or why there is none.
fn next(
    goal: &Goal,
    pass: Pass,
    slope: f64,
    affordable: Option<f64>,
) -> std::result::Result<u32, End> {
    let Pass { from, error, .. } = pass;
    if from == 0 {
        return Ok(1);
    }
    if goal.is_reached(pass) {
        return Err(End::Error);
    }
    let most = goal.samples.unwrap_or(MOST_SAMPLES).min(MOST_SAMPLES);
    if from >= most {
        return Err(End::Samples);
    }
    let doubled = (from + 1).next_power_of_two();
    let step = (doubled / 2 / PARTS).max(1);
    let steps = |samples: f64| (samples / f64::from(step)).clamp(0.0, f64::from(PARTS)) as u32;
    let mut more = doubled.min(most) - from;
    if let (Some(target), Some(error)) = (goal.error, error)
        && from >= LEAST
        && error > target
    {
        let wanted = f64::from(from) * (libm::pow(target / error, 1.0 / slope) - 1.0);
        more = more.min(step * steps(wanted + f64::from(step)).max(1));
    }
    if goal.seconds.is_some() {
        // Where no pass has told its time, after a resumption, the smallest does.
        let affordable = affordable.map_or(f64::from(step), |samples| PLANNED * samples);
        if affordable < f64::from(more) {
            more = more.min(step * steps(affordable));
        }
    }
    if more == 0 { Err(End::Time) } else { Ok(from + more) }
}

/// Ends a pass at the end of its time.
struct Until<'a> {
    watch: &'a dyn Watch,
    start: Instant,
    /// The seconds from then.
    left: f64,
}

impl Watch for Until<'_> {
    fn progress(&self, done: u64, all: u64) {
        self.watch.progress(done, all);
    }

    fn tile(&self, tile: &Tile, pixels: &[[f32; 3]]) {
        self.watch.tile(tile, pixels);
    }

    fn cancelled(&self) -> bool {
        self.watch.cancelled() || self.start.elapsed().as_secs_f64() > self.left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pass_is_as_long_as_its_time_or_its_error_asks_for() {
        let timed = Goal { seconds: Some((9.0, Instant::now())), ..Goal::default() };
        let aimed = Goal { error: Some(1.0), ..Goal::default() };
        let at = |from, error| Pass { from, to: from, error: Some(error), ..Pass::default() };
        let next = |goal: &Goal, pass, affordable| next(goal, pass, SLOPES[1], affordable);
        assert_eq!(next(&timed, at(64, 1.0), Some(1000.0)), Ok(128));
        // In eighths of a doubling, of which 0.88 of what there is time for.
        assert_eq!(next(&timed, at(64, 1.0), Some(40.0)), Ok(96));
        assert_eq!(next(&timed, at(80, 1.0), Some(8.0)), Err(End::Time));
        // Nothing is known after a resumption.
        assert_eq!(next(&timed, at(64, 1.0), None), Ok(72));
        // 1.1 squared times 64 is 77.
        assert_eq!(next(&aimed, at(64, 1.1), None), Ok(80));
        assert_eq!(next(&aimed, at(64, 1.0), None), Err(End::Error));
        assert_eq!(next(&aimed, at(2, 0.5), None), Ok(4));
        assert_eq!(next(&aimed, at(8, 0.0), None), Ok(16));
        let few = Goal { samples: Some(13), ..aimed };
        assert_eq!(next(&few, at(8, 5.0), None), Ok(13));
        assert_eq!(next(&few, at(13, 5.0), None), Err(End::Samples));
    }
}
