//! The answer of a sweep: the sampler and number of points that reach an error in the least time,
//! in seconds from the command to the image, and the costs of precision and effects.
//!
//! | key of `answer` | unit | meaning |
//! |---|---|---|
//! | `family`, `counted` | | what is varied for a smaller error, as by `--advise` and `--target-error` |
//! | `errors[].error` | | root mean squared error |
//! | `.sampler`, `.points` | | the fastest of all measured settings whose error is at most this one: its sampler and its number of points; `null` if none is |
//! | `.seconds`, `.tracing` | seconds | its time: loading, building and tracing; tracing only |
//! | `.times_as_fast` | | speedup of tracing over the fastest measured setting with random points, with its interval; `null` without either |
//! | `.at_least` | | whether random points did not reach the error: the speedup is then relative to their longest render, and a lower bound |
//! | `precisions[].name`, `.ratio` | | tracing time relative to `fast`, at the scene's own samples |
//! | `precisions[].worst_t` | ulp | the largest error of t on the scene's triangles (absent without triangles) |
//! | `effects[].name`, `.ratio` | | tracing time relative to that without the effect, or with one point for it |
//! | `pass`, `share` | | the pass that takes most of the tracing time, and its share |

use serde::Serialize;

use super::findings::{FamilyFindings, PointFindings, SceneFindings, SeriesFindings};
use super::fit::{Interval, bootstrap, of};
use super::setting::Setting;
use crate::plot::number::{figure, seconds};
use crate::summary::median;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::sampling::Sampling;

/// Default errors of an answer.
pub const ERRORS: [f64; 3] = [0.02, 0.01, 0.005];

/// See the module documentation.
#[derive(Clone, Debug, Default, Serialize)]
#[allow(missing_docs, reason = "the table above says it once, for the JSON and for the fields")]
pub struct Answer {
    pub family: &'static str,
    pub counted: &'static str,
    pub errors: Vec<AtError>,
    pub precisions: Vec<Price>,
    pub effects: Vec<Price>,
    pub pass: Option<String>,
    pub share: f64,
}

/// The cost of an error.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct AtError {
    pub error: f64,
    pub sampler: Option<String>,
    pub points: Option<u64>,
    pub seconds: Option<f64>,
    pub tracing: Option<f64>,
    pub times_as_fast: Option<Interval>,
    pub at_least: bool,
}

/// The cost of a choice.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Price {
    pub name: String,
    pub ratio: Interval,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst_t: Option<f64>,
}

impl Answer {
    /// The answer for a scene; `family` is varied for a smaller error.
    pub fn of(scene: &SceneFindings, family: &str, errors: &[f64]) -> Self {
        let mut answer = Self::default();
        if let Some(family) = scene.families.iter().find(|found| found.name == family) {
            (answer.family, answer.counted) = (family.name, family.counted);
            let before = scene.seconds_before();
            answer.errors = errors.iter().map(|error| at_error(family, *error, before)).collect();
        }
        let own = scene.own();
        let precisions = scene.families.iter().filter(|family| family.name == "precision");
        let precisions = precisions.flat_map(|family| &family.series).flat_map(|s| &s.points);
        let precisions: Vec<&PointFindings> = precisions.collect();
        let fast = precisions.iter().find(|p| p.label == Precision::Fast.name());
        let price = |name: String, point: &PointFindings, without: &PointFindings| {
            let trial = scene.trials.iter().find(|trial| trial.precision == name);
            let worst_t = trial.and_then(|trial| Some(trial.errors.as_ref()?.t.worst));
            Some(Price { name, ratio: ratio(point, without)?, worst_t })
        };
        let others = precisions.iter().filter(|p| p.label != Precision::Fast.name());
        answer.precisions = others.filter_map(|p| price(p.label.clone(), p, fast?)).collect();
        let effects =
            [("soft shadows", "lights"), ("depth of field", "lens"), ("mirrors", "bounces")];
        let effect = |(name, family): (&str, &str)| {
            let family = scene.families.iter().find(|found| found.name == family)?;
            price(name.to_owned(), own?, family.series.first()?.points.first()?)
        };
        answer.effects = effects.into_iter().filter_map(effect).collect();
        answer.effects.sort_by(|a, b| b.ratio.value.total_cmp(&a.ratio.value));
        if let Some(stage) =
            scene.stages.iter().find(|s| s.precision == Precision::default().name())
        {
            let most = stage.passes.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            let all: f64 = stage.passes.iter().map(|(_, seconds)| seconds).sum();
            answer.pass = most.map(|(name, _)| name.clone());
            answer.share = most.map_or(0.0, |(_, seconds)| seconds / all.max(f64::MIN_POSITIVE));
        }
        answer
    }
}

impl Answer {
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

impl SceneFindings {
    /// Seconds of loading and building.
    pub fn seconds_before(&self) -> f64 {
        let usual = self.stages.iter().find(|s| s.precision == Precision::default().name());
        usual.map_or(0.0, |stage| stage.before.load + stage.before.build)
    }

    /// The point with the scene's own settings.
    fn own(&self) -> Option<&PointFindings> {
        let key = Setting::default().key();
        let points = self.families.iter().flat_map(|family| &family.series).flat_map(|s| &s.points);
        points.into_iter().find(|point| point.key == key)
    }
}

/// The ratio of the times of one setting to those of another.
fn ratio(one: &PointFindings, other: &PointFindings) -> Option<Interval> {
    let rounds = one.times.len().min(other.times.len());
    bootstrap(rounds, |seeds| Some(one.time(seeds) / other.time(seeds)))
}

impl PointFindings {
    /// The median tracing time of these seeds.
    pub fn time(&self, seeds: &[usize]) -> f64 {
        median(&of(seeds, &self.times).collect::<Vec<_>>())
    }

    /// The root mean squared error of these seeds.
    pub fn error(&self, seeds: &[usize]) -> f64 {
        (of(seeds, &self.each).sum::<f64>() / seeds.len() as f64).sqrt()
    }
}

impl SeriesFindings {
    /// The fastest of the measured settings whose error is at most `error`.
    pub fn reach(&self, error: f64) -> Option<&PointFindings> {
        let reaching = self.points.iter().filter(|point| point.rmse.value <= error);
        reaching.min_by(|a, b| a.seconds.median.total_cmp(&b.seconds.median))
    }

    /// The measured setting with the most points in at most `seconds`, or the one with the fewest.
    pub fn within(&self, seconds: f64) -> Option<&PointFindings> {
        let in_time = |point: &&PointFindings| point.seconds.median <= seconds;
        self.points.iter().rfind(in_time).or(self.points.first())
    }
}

impl FamilyFindings {
    /// The fastest of all measured settings whose error is at most `error`.
    pub fn fastest(&self, error: f64) -> Option<(&SeriesFindings, &PointFindings)> {
        let reached = self.series.iter().filter_map(|s| Some((s, s.reach(error)?)));
        reached.min_by(|a, b| a.1.seconds.median.total_cmp(&b.1.seconds.median))
    }
}

fn at_error(family: &FamilyFindings, error: f64, before: f64) -> AtError {
    let best = family.fastest(error);
    let random = family.series.iter().find(|series| series.name == Sampling::Random.name());
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
