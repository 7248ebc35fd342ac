//! The answer of a sweep: the sampler and number of points that reach an error in the least time,
//! in seconds from the command to the image.
//!
//! | key of `answer` | unit | meaning |
//! |---|---|---|
//! | `family`, `counted` | | what is varied for a smaller error, as by `--advise` and `--target-error` |
//! | `errors[].error` | | root mean squared error |
//! | `.sampler`, `.points` | | the fastest of all measured settings whose error is at most this one: its sampler and its number of points; `null` if none is |
//! | `.seconds`, `.tracing` | seconds | its time: loading, building and tracing; tracing only |
//! | `.times_as_fast` | | speedup of tracing over the fastest measured setting with random points, with its interval; `null` without either |
//! | `.at_least` | | whether random points did not reach the error: the speedup is then relative to their longest render, and a lower bound |

#![allow(missing_docs, reason = "the table above says it once, for the JSON and for the fields")]

use serde::Serialize;

use super::findings::Point;
use super::fit::{Interval, bootstrap, of};
use super::setting::{Family, Series};
use crate::plot::number::{figure, seconds};
use crate::summary::median;
use wavecrest_core::math::sampling::Sampling;

/// Default errors of an answer.
pub const ERRORS: [f64; 3] = [0.02, 0.01, 0.005];

/// See the module documentation.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Answer {
    pub family: &'static str,
    pub counted: &'static str,
    pub errors: Vec<AtError>,
}

/// The cost of an error.
#[derive(Clone, Debug, Serialize)]
pub struct AtError {
    pub error: f64,
    pub sampler: Option<String>,
    pub points: Option<u64>,
    pub seconds: Option<f64>,
    pub tracing: Option<f64>,
    pub times_as_fast: Option<Interval>,
    pub at_least: bool,
}

impl Answer {
    /// The answer of a `family` of settings, with the seconds `before` tracing.
    pub fn of(family: &Family<Point>, before: f64, errors: &[f64]) -> Self {
        let errors = errors.iter().map(|error| at_error(family, *error, before)).collect();
        Self { family: family.name, counted: family.counted, errors }
    }

    /// The cost of the error in the middle of those that were asked for, or of the smallest that was
    /// reached, in a sentence.
    pub fn sentence(&self) -> String {
        let middle = self.errors.get(self.errors.len() / 2).filter(|at| at.sampler.is_some());
        let reached = || self.errors.iter().filter(|at| at.sampler.is_some());
        let at = middle.or_else(|| reached().min_by(|a, b| a.error.total_cmp(&b.error)));
        let Some((at, sampler)) = at.and_then(|at| Some((at, at.sampler.as_ref()?))) else {
            return "No measured setting reaches any of the errors.".to_owned();
        };
        let effect = match self.family {
            "lights" => "Soft shadows",
            "lens" => "Depth of field",
            _ => "Antialiasing",
        };
        let (error, points) = (figure(at.error * 100.0), figure(at.points.unwrap_or(0) as f64));
        let time = seconds(at.tracing.unwrap_or(0.0));
        let rival = match at.times_as_fast {
            _ if sampler == Sampling::Random.name() => "no other sampler is faster".to_owned(),
            Some(ratio) if at.at_least => {
                format!("random ones do not reach it in {:.1} times as long", ratio.value)
            }
            Some(ratio) => format!("random ones take {:.1} times as long", ratio.value),
            None => "random ones were not measured".to_owned(),
        };
        format!(
            "{effect} at {error} % error: {points} {sampler} {}, {time}; {rival}.",
            self.counted
        )
    }
}

/// The ratio of the times of one setting to those of another.
fn ratio(one: &Point, other: &Point) -> Option<Interval> {
    let time = |p: &Point, seeds: &[usize]| median(&of(seeds, &p.times).collect::<Vec<_>>());
    let rounds = one.times.len().min(other.times.len());
    bootstrap(rounds, |seeds| Some(time(one, seeds) / time(other, seeds)))
}

impl Series<Point> {
    /// The fastest of the measured settings whose error is at most `error`.
    pub fn reach(&self, error: f64) -> Option<&Point> {
        let reaching = self.points.iter().filter(|point| point.rmse.value <= error);
        reaching.min_by(|a, b| a.seconds.median.total_cmp(&b.seconds.median))
    }

    /// The measured setting with the most points in at most `seconds`, or the one with the fewest.
    pub fn within(&self, seconds: f64) -> Option<&Point> {
        let in_time = |point: &&Point| point.seconds.median <= seconds;
        self.points.iter().rfind(in_time).or(self.points.first())
    }
}

impl Family<Point> {
    /// The fastest of all measured settings whose error is at most `error`.
    pub fn fastest(&self, error: f64) -> Option<(&Series<Point>, &Point)> {
        let reached = self.series.iter().filter_map(|s| Some((s, s.reach(error)?)));
        reached.min_by(|a, b| a.1.seconds.median.total_cmp(&b.1.seconds.median))
    }

    /// Random points.
    pub fn random(&self) -> Option<&Series<Point>> {
        self.series.iter().find(|series| series.name == Sampling::Random.name())
    }
}

fn at_error(family: &Family<Point>, error: f64, before: f64) -> AtError {
    let best = family.fastest(error);
    let random = family.random();
    let rival = random.and_then(|random| random.reach(error).or(random.points.last()));
    let tracing = best.map(|(_, point)| point.seconds.median);
    AtError {
        error,
        sampler: best.map(|(series, _)| series.name.clone()),
        points: best.map(|(_, point)| point.x as u64),
        seconds: tracing.map(|tracing| before + tracing),
        tracing,
        times_as_fast: best.zip(rival).and_then(|((_, point), rival)| ratio(rival, point)),
        at_least: best.is_some() && random.is_some_and(|random| random.reach(error).is_none()),
    }
}
