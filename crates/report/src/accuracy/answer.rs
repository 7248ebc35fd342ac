//! The answer of a sweep: the sampler and number of points that reach an error in the least time,
//! in seconds from the command to the image, and the costs of precision and effects.
//!
//! | key of `answer` | unit | meaning |
//! |---|---|---|
//! | `counted` | | what is varied for a smaller error, as by `--advise` and `--target-error` |
//! | `errors[].error` | | root mean squared error |
//! | `.sampler`, `.points` | | the quickest sampler and its number of points, the next square; `null` if no setting reached the error |
//! | `.seconds`, `.tracing` | seconds | loading, building and tracing; tracing only |
//! | `.times_as_fast` | | speedup of tracing over random points, with its interval; `null` without either |
//! | `.at_least` | | whether random points did not reach the error: the speedup is then relative to their longest render, and a lower bound |
//! | `precisions[].name`, `.ratio` | | tracing time relative to `fast`, at the scene's own samples |
//! | `precisions[].worst_t` | ulp | the largest error of t on the scene's triangles (absent without triangles) |
//! | `effects[].name`, `.ratio` | | tracing time relative to that without the effect, or with one point for it |
//! | `pass`, `share` | | the pass that takes most of the tracing time, and its share |

use serde::Serialize;

use super::findings::{FamilyFindings, PointFindings, SceneFindings, SeriesFindings};
use super::fit::{Interval, bootstrap, of};
use super::setting::Setting;
use crate::summary::median;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::sampling::Sampling;

/// Default errors of an answer.
pub const ERRORS: [f64; 3] = [0.02, 0.01, 0.005];

/// See the module documentation.
#[derive(Clone, Debug, Default, Serialize)]
#[allow(missing_docs, reason = "the table above says it once, for the JSON and for the fields")]
pub struct Answer {
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
            answer.counted = family.counted;
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
    /// The number of points and seconds of tracing for an error, interpolated linearly in
    /// logarithms between two settings, over `seeds`, or over all if `None`.
    pub fn reach(&self, error: f64, seeds: Option<&[usize]>) -> Option<[f64; 2]> {
        let values = |p: &PointFindings| match seeds {
            Some(seeds) => [p.x, p.error(seeds), p.time(seeds)],
            None => [p.x, p.rmse.value, p.seconds.median],
        };
        let mut previous: Option<[f64; 3]> = None;
        for point in &self.points {
            let found = values(point);
            if found[1] <= error {
                let Some(before) = previous else { return Some([found[0], found[2]]) };
                let share = libm::log(before[1] / error) / libm::log(before[1] / found[1]);
                let between = |axis: usize| {
                    before[axis] * libm::exp(share * libm::log(found[axis] / before[axis]))
                };
                return Some([between(0), between(2)]);
            }
            previous = Some(found);
        }
        None
    }
}

fn at_error(family: &FamilyFindings, error: f64, before: f64) -> AtError {
    let reached = |series: &&SeriesFindings| series.reach(error, None).is_some();
    let time = |series: &SeriesFindings| series.reach(error, None).map_or(f64::INFINITY, |r| r[1]);
    let best = family.series.iter().filter(reached).min_by(|a, b| time(a).total_cmp(&time(b)));
    let mut answer = AtError {
        error,
        sampler: best.map(|series| series.name.clone()),
        points: None,
        seconds: None,
        tracing: None,
        times_as_fast: None,
        at_least: false,
    };
    let Some((series, [points, tracing])) = best.and_then(|s| Some((s, s.reach(error, None)?)))
    else {
        return answer;
    };
    // Grids are square.
    let side = (points.sqrt() - f64::EPSILON * points).ceil();
    answer.points = Some((side * side) as u64);
    (answer.tracing, answer.seconds) = (Some(tracing), Some(before + tracing));
    let random = family.series.iter().find(|series| series.name == Sampling::Random.name());
    if let Some(random) = random {
        answer.at_least = random.reach(error, None).is_none();
        let rounds = |s: &SeriesFindings| s.points.iter().map(|p| p.times.len()).min();
        let rounds = rounds(series).min(rounds(random)).unwrap_or(0);
        answer.times_as_fast = bootstrap(rounds, |seeds| {
            let slow = random.reach(error, Some(seeds)).map(|reached| reached[1]);
            let slow = slow.or_else(|| random.points.last().map(|p| p.time(seeds)))?;
            Some(slow / series.reach(error, Some(seeds))?[1])
        });
    }
    answer
}
