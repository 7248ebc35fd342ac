//! Runs both tracers alternately, and checks every image.
//!
//! The runs form pairs, one of each tracer, so that slow phases of the machine affect both. The
//! first to run alternates, so that neither always finds the caches and the clock as the other left
//! them. Nothing is timed before the warm-up has shown that the images are equal, and a different
//! image ends the measurement: the speed of a wrong image does not matter.

use serde::Serialize;

use super::hardware::HardwareCounts;
use crate::summary::ENOUGH;
use crate::yardstick::yardstick;
use wavecrest_base::error::Result;
use wavecrest_core::counters::Counters;
use wavecrest_core::counters::{Kernels, TestCounts};
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::render::{Rendered, TracerKind};

/// Number and duration of runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Warm-up pairs, at least 1.
    pub warmup: usize,
    /// Largest number of timed pairs.
    pub most: usize,
    /// Total seconds of each tracer, unless `most` is reached before.
    pub seconds: f64,
}

impl Schedule {
    /// The estimated total number of timed pairs after `pairs`, whose faster runs took `shorter`
    /// seconds: enough for an interval, and for the requested seconds.
    pub(crate) fn planned(&self, pairs: usize, shorter: f64) -> usize {
        let wanted = match pairs {
            0 => 1,
            _ if shorter >= self.seconds => pairs,
            _ => (self.seconds / shorter * pairs as f64).ceil().max(pairs as f64 + 1.0) as usize,
        };
        wanted.max(ENOUGH).min(self.most.max(1))
    }
}

/// The runs of one tracer.
#[derive(Clone, Debug, Default)]
pub struct Runs {
    /// Seconds of each run.
    pub seconds: Vec<f64>,
    /// Seconds of a [yardstick] after each run.
    pub yardsticks: Vec<f64>,
    /// Seconds of each pass in each run, summed over threads.
    pub passes: Vec<(&'static str, Vec<f64>)>,
    /// Tests in one run.
    pub tests: TestCounts,
    /// Rays by kernel in one run.
    pub kernels: Kernels,
    /// Hardware counters of a separate run, if available.
    pub hardware: Option<HardwareCounts>,
}

/// The clock's resolution in seconds, used as the smallest time, so that ratios of times are
/// finite.
const CLOCK_STEP: f64 = 1e-9;

/// The duration of a run.
pub(crate) fn seconds_of(run: &Rendered) -> f64 {
    run.seconds.max(CLOCK_STEP)
}

impl Runs {
    pub(super) fn add(&mut self, run: &Rendered) {
        self.seconds.push(seconds_of(run));
        self.yardsticks.push(yardstick());
        (self.tests, self.kernels) = (run.counters.tests, run.counters.kernels);
        if self.passes.is_empty() {
            self.passes = run.pass_seconds.iter().map(|&(name, _)| (name, Vec::new())).collect();
        }
        for ((_, all), &(_, seconds)) in self.passes.iter_mut().zip(&run.pass_seconds) {
            all.push(seconds);
        }
    }
}

/// The results.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// The work of one run; its tests are those of the first wavefront run.
    pub counters: Counters,
    /// The timed runs of the wavefront.
    pub wavefront: Runs,
    /// The timed runs of the recursive tracer, pair by pair with the wavefront's.
    pub recursive: Runs,
    /// The difference that ended the measurement, if the tracers disagree.
    pub difference: Option<Difference>,
}

impl Measured {
    /// The number of complete timed pairs.
    pub fn pairs(&self) -> usize {
        self.wavefront.seconds.len().min(self.recursive.seconds.len())
    }

    /// Seconds of all timed runs of the faster tracer.
    fn shorter(&self) -> f64 {
        let [a, b] = [&self.wavefront, &self.recursive].map(|runs| runs.seconds.iter().sum());
        f64::min(a, b)
    }

    fn runs(&mut self, tracer: TracerKind) -> &mut Runs {
        match tracer {
            TracerKind::Wavefront => &mut self.wavefront,
            TracerKind::Recursive => &mut self.recursive,
        }
    }
}

/// A difference of a run from the first.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "what", rename_all = "kebab-case")]
pub enum Difference {
    /// In its image.
    Pixel {
        /// The tracer of the run that differs.
        tracer: TracerKind,
        /// The first pixel that differs, row by row from the top: its column.
        x: u32,
        /// Its row.
        y: u32,
        /// Its value in the first image, a wavefront's.
        expected: Pixel,
        /// Its value in the different image.
        found: Pixel,
    },
    /// Only in its work.
    Work {
        /// The tracer of the run that differs.
        tracer: TracerKind,
        /// The first count that differs, by its name in [`Counters`].
        count: &'static str,
        /// That count in the first run, a wavefront's.
        expected: u64,
        /// That count in the different run.
        found: u64,
    },
}

/// A pixel to the last bit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pixel {
    /// Red, green and blue.
    pub values: [f32; 3],
    /// The bits of each, in hexadecimal.
    pub bits: [String; 3],
}

impl Pixel {
    fn new(values: [f32; 3]) -> Self {
        Self { values, bits: values.map(|v| format!("{:08x}", v.to_bits())) }
    }
}

/// Runs `trace` with both tracers alternately as in `schedule`. `progress` receives the pairs timed
/// and the expected total.
///
/// # Errors
/// Those of `trace`.
pub fn measure(
    schedule: &Schedule,
    mut trace: impl FnMut(TracerKind) -> Result<Rendered>,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Measured> {
    let first = trace(TracerKind::Wavefront)?;
    let mut measured = Measured { counters: first.counters, ..Measured::default() };
    for pair in 0.. {
        for tracer in order(pair) {
            if pair == 0 && tracer == TracerKind::Wavefront {
                continue; // That was the first run.
            }
            let run = trace(tracer)?;
            measured.difference = difference(tracer, &first, &run);
            if measured.difference.is_some() {
                return Ok(measured);
            }
            if pair >= schedule.warmup.max(1) {
                measured.runs(tracer).add(&run);
            }
        }
        let planned = schedule.planned(measured.pairs(), measured.shorter());
        progress(measured.pairs() as u64, planned as u64);
        if measured.pairs() >= planned {
            break;
        }
    }
    Ok(measured)
}

/// The first tracer alternates.
pub(crate) fn order(pair: usize) -> [TracerKind; 2] {
    if pair.is_multiple_of(2) {
        [TracerKind::Wavefront, TracerKind::Recursive]
    } else {
        [TracerKind::Recursive, TracerKind::Wavefront]
    }
}

/// The difference of `run` from the `first`, if any. In fast precision kernels and levels may differ
/// at edges, so nothing is compared.
pub(crate) fn difference(
    tracer: TracerKind,
    first: &Rendered,
    run: &Rendered,
) -> Option<Difference> {
    if run.precision == Precision::Fast {
        return None;
    }
    if !first.film.same_bits(&run.film) {
        return Some(first_pixel(tracer, &first.film, &run.film));
    }
    let mut counts = work(&first.counters).into_iter().zip(work(&run.counters));
    counts.find(|(a, b)| a != b).map(|((count, expected), (_, found))| Difference::Work {
        tracer,
        count,
        expected,
        found,
    })
}

/// Every count except tests and kernels, which differ between the tracers.
fn work(counters: &Counters) -> [(&'static str, u64); 10] {
    let c = counters;
    [
        ("primary_rays", c.primary_rays),
        ("secondary_rays", c.secondary_rays),
        ("shadow_rays", c.shadow_rays),
        ("lens_samples", c.lens_samples),
        ("light_samples", c.light_samples),
        ("colors", c.colors),
        ("texels", c.texels),
        ("footprints", c.footprints),
        ("invalid", c.invalid),
        ("lights_at_surface", c.lights_at_surface),
    ]
}

/// The first pixel that differs between two images of one size, which are known to differ.
fn first_pixel(tracer: TracerKind, expected: &Film, found: &Film) -> Difference {
    let same = |(a, b): (&[f32; 3], &[f32; 3])| a.map(f32::to_bits) == b.map(f32::to_bits);
    let pairs = expected.pixels().iter().zip(found.pixels());
    let index = pairs.take_while(|&pair| same(pair)).count() as u32;
    let (x, y) = (index % expected.width(), index / expected.width());
    let pixel = |film: &Film| Pixel::new(film.pixel(x, y).unwrap_or_default());
    Difference::Pixel { tracer, x, y, expected: pixel(expected), found: pixel(found) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rendered(seconds: f64, pixel: f32) -> Rendered {
        let mut film = Film::new(3, 2).unwrap();
        film.pixel_mut(1, 1).unwrap()[2] = pixel;
        let counters = Counters { primary_rays: 6, ..Counters::default() };
        Rendered {
            film,
            finished: true,
            tiles: Vec::new(),
            counters,
            columns: 0,
            pass_seconds: vec![("all", seconds)],
            seconds,
            precision: Precision::Exact,
        }
    }

    fn schedule(warmup: usize, most: usize, seconds: f64) -> Schedule {
        Schedule { warmup, most, seconds }
    }

    /// The tracers in the order in which they ran, and what was measured.
    fn run(schedule: Schedule, seconds: f64) -> (String, Measured) {
        let mut log = String::new();
        let trace = |tracer| {
            log.push(if tracer == TracerKind::Wavefront { 'W' } else { 'R' });
            Ok(rendered(seconds, 0.5))
        };
        let measured = measure(&schedule, trace, &mut |_, _| {}).unwrap();
        (log, measured)
    }

    #[test]
    fn runs_are_interleaved_and_take_turns() {
        let (log, measured) = run(schedule(1, 4, 0.0), 1.0);
        assert_eq!(log, "WRRWWRRWWR");
        assert_eq!((measured.pairs(), measured.difference), (4, None));
        assert_eq!(measured.wavefront.seconds, [1.0; 4]);
        assert_eq!(measured.recursive.passes, [("all", vec![1.0; 4])]);
    }

    #[test]
    fn short_runs_are_repeated_until_there_are_seconds_enough() {
        assert_eq!(run(schedule(1, 50, 1.0), 10.0).1.pairs(), ENOUGH);
        assert_eq!(run(schedule(1, 50, 1.0), 0.0625).1.pairs(), 16);
        assert_eq!(run(schedule(3, 50, 1.0), 0.001).1.pairs(), 50);
        assert_eq!(run(schedule(1, 2, 1.0), 10.0).1.pairs(), 2);
        assert_eq!(run(schedule(1, 50, 1.0), 0.0).1.pairs(), 50);
        assert_eq!(run(schedule(0, 1, 0.0), 1.0).0, "WRRW", "never without a warm-up");
    }

    #[test]
    fn progress_rises_to_what_is_planned() {
        let mut reported = Vec::new();
        let trace = |_| Ok(rendered(0.25, 0.0));
        measure(&schedule(1, 50, 2.0), trace, &mut |done, all| reported.push((done, all))).unwrap();
        assert_eq!(
            reported.first(),
            Some(&(0, ENOUGH as u64)),
            "nothing is known before the first timed pair"
        );
        assert_eq!(reported[1..3], [(1, 8), (2, 8)]);
        assert_eq!(reported.last(), Some(&(8, 8)));
    }

    #[test]
    fn the_first_pixel_that_differs_ends_it() {
        let mut count = 0;
        let trace = |_| {
            count += 1;
            Ok(rendered(1.0, if count == 7 { -0.0 } else { 0.0 }))
        };
        let measured = measure(&schedule(1, 50, 0.0), trace, &mut |_, _| {}).unwrap();
        assert_eq!(count, 7);
        let Some(Difference::Pixel { tracer, x, y, expected, found }) = measured.difference else {
            panic!("{measured:?}")
        };
        assert_eq!((tracer, x, y), (TracerKind::Recursive, 1, 1));
        assert_eq!((expected.bits[2].as_str(), found.bits[2].as_str()), ("00000000", "80000000"));
    }

    #[test]
    fn work_that_differs_ends_it_too() {
        let trace = |tracer| {
            let mut run = rendered(1.0, 0.0);
            run.counters.tests.nodes = if tracer == TracerKind::Wavefront { 3 } else { 4 };
            run.counters.shadow_rays = u64::from(tracer == TracerKind::Recursive);
            Ok(run)
        };
        let measured = measure(&schedule(1, 50, 0.0), trace, &mut |_, _| {}).unwrap();
        let (tracer, count) = (TracerKind::Recursive, "shadow_rays");
        let difference = Difference::Work { tracer, count, expected: 0, found: 1 };
        assert_eq!(measured.difference, Some(difference));
        assert_eq!(measured.pairs(), 0);
    }
}
