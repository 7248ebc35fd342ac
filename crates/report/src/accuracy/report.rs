//! The results of a sweep: its records summarised, as stored in JSON and shown.
//!
//! | key of a scene | unit | meaning |
//! |---|---|---|
//! | `scene`, `file`, `fingerprint`, `size`, `primitives` | | the scene and the size of its images in pixels |
//! | `rounds`, `left_out`, `busy` | | rounds of all settings, one for each seed, as in [`crate::bench`]: busy ones are left out of times if enough others remain |
//! | `share` | | the largest share of the processors that the threads got in a round; `null` where the system does not tell |
//! | `answer` | | the sampler and the number of points that reach an error in the least time, in seconds from the command to the image: |
//! | `.least` | | the least error of all measured settings, up to the end of its interval |
//! | `.family`, `.counted` | | what is varied for a smaller error |
//! | `.errors[].error` | | root mean squared error |
//! | `..sampler`, `.points` | | the fastest of all measured settings whose error is at most this one: its sampler and its number of points; `null` if none is |
//! | `..seconds`, `.tracing` | seconds | its time: loading, building and tracing; tracing only |
//! | `..times_as_fast` | | speedup of tracing over the fastest measured setting with random points, with its interval; `null` without either |
//! | `..at_least` | | whether random points did not reach the error: the speedup is then relative to their longest render, and a lower bound |
//! | `references` | | the references of errors: samples of each kind in a pixel, renders, standard error (root mean square), seconds |
//! | `families` | | the variations: `name`, `title`, what is `counted`, the `target`, and `series`: |
//! | `.slope` | | exponent of the mean squared error as a function of the count, from [`SLOPE_FROM`] on, with its interval; `null` if too few points are above the noise of the reference, or the error does not fall any more at the last of them |
//! | `.points[].x`, `.label`, `.key` | | the count, and the setting |
//! | `.points[].seconds` | seconds | from the first ray to the last: median with its interval |
//! | `.points[].rmse` | | root of the mean squared error over all seeds, with its interval |
//! | `.points[].mse`, `.relative_mse`, `.psnr`, `.flip`, `.bias` | | means over seeds; see [`wavecrest_image::compare`] |
//! | `.points[].rays` | rays | of every kind, mean over seeds |
//! | `.points[].above_noise` | | whether the error is at least three standard errors of the reference |
//! | `trials` | | for each precision: rays aimed at edges and leaks, rays that leave a surface and self-hits, the largest errors of t, points and normals in ulp ([`HitErrors`](crate::selftest::errors::HitErrors)) |

#![allow(missing_docs, reason = "the table above says it once, for the JSON and for the fields")]

use std::collections::BTreeSet;

use serde::Serialize;

use super::setting::{Axis, CountedSetting, Family, Setting, SettingSeries, Truth, converges};
use super::store::{
    PointRecord, PreparedRecord, Record, ReferenceRecord, SceneRecord, TrialRecord, busy_rounds,
    largest_share, records_of,
};
use super::subject::{FLOOR, Subject};
use crate::measure::Rounds;
use crate::plot::number::{figure, seconds};
use crate::summary::{self, ENOUGH, MedianInterval, Uncertain, bootstrap, median, of_seeds};
use wavecrest_core::math::sampling::Sampling;
use wavecrest_image::compare::psnr;

/// Slopes are fitted from this number of points on: one or two points are not stratified.
pub const SLOPE_FROM: f64 = 4.0;

/// See the module documentation.
#[derive(Clone, Debug, Serialize)]
pub struct SceneAccuracy {
    #[serde(flatten)]
    pub scene: SceneRecord,
    #[serde(flatten)]
    pub rounds: Rounds,
    pub share: Option<f64>,
    pub answer: FastestSettings,
    pub references: Vec<ReferenceRecord>,
    pub families: Vec<Family<SettingResult>>,
    pub trials: Vec<TrialRecord>,
}

/// A setting.
#[derive(Clone, Debug, Serialize)]
pub struct SettingResult {
    pub x: f64,
    pub label: String,
    pub key: String,
    pub seconds: MedianInterval,
    pub rmse: Uncertain,
    pub mse: f64,
    pub relative_mse: f64,
    pub psnr: Option<f64>,
    pub flip: f64,
    pub bias: f64,
    pub rays: f64,
    pub above_noise: bool,
    #[serde(skip)]
    pub setting: Setting,
    /// The squared error of each seed.
    #[serde(skip)]
    pub each: Vec<f64>,
    /// The seconds of each seed.
    #[serde(skip)]
    pub times: Vec<f64>,
}

impl SceneAccuracy {
    /// Summarises the `records` of a scene.
    pub fn of(subject: &Subject, records: &[Record], errors: &[f64]) -> Self {
        let name = &*subject.record.scene;
        let (all_rounds, busy) = busy_rounds(name, records);
        let is_enough = all_rounds - busy.len() >= ENOUGH.min(all_rounds);
        let left = if is_enough { busy.clone() } else { BTreeSet::new() };
        let (rounds, left_out) = (all_rounds - left.len(), left.len());
        let references = records_of(records).filter(|r: &&ReferenceRecord| r.scene == name);
        let trials = records_of(records).filter(|t: &&TrialRecord| t.scene == name);
        let prepared = records_of(records).filter(|p: &&PreparedRecord| p.scene == name);
        let before: Vec<f64> = prepared.map(|p| p.time.load + p.time.build).collect();
        let mut found = Self {
            scene: subject.record.clone(),
            rounds: Rounds { rounds, left_out, busy: busy.len() - left_out },
            share: largest_share(name, records),
            answer: FastestSettings::default(),
            references: references.cloned().collect(),
            families: Vec::new(),
            trials: trials.cloned().collect(),
        };
        found.families =
            subject.families.iter().map(|f| found.summary(f, records, &left)).collect();
        let counted = Axis::of(&subject.facts).things();
        if let Some(varied) = found.families.iter().find(|family| family.counted == counted) {
            let costs = errors.iter().map(|error| varied.cost(*error, median(&before)));
            let (family, errors) = (varied.name, costs.collect());
            let least = varied.points().map(|point| point.rmse.high).reduce(f64::min);
            found.answer = FastestSettings { family, counted, least, errors };
        }
        found
    }

    /// The error up to which those against the reference of `target` are noise.
    pub fn floor(&self, target: Truth) -> f64 {
        let of = self.references.iter().find(|reference| reference.target == target);
        of.map_or(0.0, |reference| FLOOR * reference.standard_error)
    }

    /// The family of this name.
    pub fn family(&self, name: &str) -> Option<&Family<SettingResult>> {
        self.families.iter().find(|family| family.name == name)
    }

    fn summary(
        &self,
        family: &Family<CountedSetting>,
        records: &[Record],
        busy: &BTreeSet<u64>,
    ) -> Family<SettingResult> {
        let &Family { name, title, ref counted, target, .. } = family;
        let floor = self.floor(target);
        let line = |line: &SettingSeries<CountedSetting>| {
            let point = |point: &CountedSetting| {
                let (scene, key) = (&self.scene.scene, point.2.key());
                let is_it =
                    |p: &&PointRecord| p.scene == *scene && p.target == target && p.key == key;
                let renders: Vec<&PointRecord> = records_of(records).filter(is_it).collect();
                SettingResult::of(point, &renders, floor, busy)
            };
            let points: Vec<SettingResult> = line.points.iter().filter_map(point).collect();
            let counts =
                |p: &&SettingResult| p.above_noise && p.x >= SLOPE_FROM && converges(&p.key);
            let falling: Vec<_> = points.iter().filter(counts).map(|p| (p.x, &*p.each)).collect();
            let slope = summary::slope(&falling).filter(|_| !summary::stays(&falling));
            SettingSeries { name: line.name.clone(), slope, points }
        };
        let series = family.series.iter().map(line).collect();
        Family { name, title, counted: counted.clone(), target, series }
    }
}

impl SettingResult {
    /// The results of a setting; times are those of rounds that were not busy.
    fn of(
        (x, label, setting): &CountedSetting,
        renders: &[&PointRecord],
        floor: f64,
        busy: &BTreeSet<u64>,
    ) -> Option<Self> {
        let all = |of: fn(&PointRecord) -> f64| renders.iter().map(move |r| of(r));
        let mean = |of: fn(&PointRecord) -> f64| all(of).sum::<f64>() / renders.len() as f64;
        let each: Vec<f64> = all(|r| r.error.mse).collect();
        let quiet = renders.iter().filter(|record| !busy.contains(&record.seed));
        let times: Vec<f64> = quiet.map(|record| record.seconds).collect();
        let rmse = summary::rmse(&each);
        let mse = mean(|r| r.error.mse);
        Some(Self {
            x: *x,
            label: label.clone(),
            key: setting.key(),
            seconds: MedianInterval::of(&times)?,
            rmse,
            mse,
            relative_mse: mean(|r| r.error.relative_mse),
            psnr: (mse > 0.0).then(|| psnr(mse)),
            flip: mean(|r| r.error.flip),
            bias: mean(|r| r.error.bias),
            rays: mean(|r| r.rays as f64),
            above_noise: rmse.value >= floor,
            setting: *setting,
            each,
            times,
        })
    }
}

/// Default errors of an answer.
pub const ERRORS: [f64; 3] = [0.02, 0.01, 0.005];

/// See the module documentation.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FastestSettings {
    pub family: &'static str,
    pub counted: String,
    pub least: Option<f64>,
    pub errors: Vec<FastestSetting>,
}

/// The cost of an error.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FastestSetting {
    pub error: f64,
    pub sampler: Option<String>,
    pub points: Option<u64>,
    pub seconds: Option<f64>,
    pub tracing: Option<f64>,
    pub times_as_fast: Option<Uncertain>,
    pub at_least: bool,
}

impl FastestSettings {
    /// The cost of the error in the middle of those that were asked for, or of the smallest that was
    /// reached, in a sentence.
    pub fn sentence(&self) -> String {
        let middle = self.errors.get(self.errors.len() / 2).filter(|at| at.sampler.is_some());
        let reached = || self.errors.iter().filter(|at| at.sampler.is_some());
        let at = middle.or_else(|| reached().min_by(|a, b| a.error.total_cmp(&b.error)));
        let Some((at, sampler)) = at.and_then(|at| Some((at, at.sampler.as_ref()?))) else {
            let least = figure(100.0 * self.least.unwrap_or(f64::INFINITY));
            return format!(
                "No measured setting reaches any of the errors: the least is {least} %. White is 100 %, and a lamp in \
                 view counts with all its light."
            );
        };
        let effect =
            match (self.family, self.counted.contains("light"), self.counted.contains("sky")) {
                ("lights", true, true) => "Soft shadows and light from the sky",
                ("lights", _, true) => "Light from the sky (ambient occlusion)",
                ("lights", ..) => "Soft shadows",
                ("lens", ..) => "Depth of field",
                _ => "Antialiasing",
            };
        let (error, points) = (figure(at.error * 100.0), figure(at.points.unwrap_or(0) as f64));
        let time = seconds(at.tracing.unwrap_or(0.0));
        let rival = match at.times_as_fast {
            _ if sampler == Sampling::Random.name() => "no other sampler is faster".to_owned(),
            Some(ratio) if at.at_least && ratio.value >= 1.0 => {
                format!("random ones do not reach it even in {} the time", ratio.times())
            }
            Some(_) if at.at_least => "random ones do not reach it".to_owned(),
            Some(ratio) => format!("random ones take {} as long", ratio.times()),
            None => "random ones were not measured".to_owned(),
        };
        format!(
            "{effect} at {error} % error: {points} {sampler} {}, {time}; {rival}.",
            self.counted
        )
    }
}

impl SettingSeries<SettingResult> {
    /// The fastest of the measured settings whose error, up to the end of its interval, is at most `error`.
    pub fn reach(&self, error: f64) -> Option<&SettingResult> {
        let reaching = self.points.iter().filter(|point| point.rmse.high <= error);
        reaching.min_by(|a, b| a.seconds.median.total_cmp(&b.seconds.median))
    }
}

impl Family<SettingResult> {
    /// The fastest of all measured settings whose error, up to the end of its interval, is at most `error`.
    pub fn fastest(&self, error: f64) -> Option<(&SettingSeries<SettingResult>, &SettingResult)> {
        let reached = self.series.iter().filter_map(|s| Some((s, s.reach(error)?)));
        reached.min_by(|a, b| a.1.seconds.median.total_cmp(&b.1.seconds.median))
    }

    /// Random points.
    pub fn random(&self) -> Option<&SettingSeries<SettingResult>> {
        self.series.iter().find(|series| series.name == Sampling::Random.name())
    }

    /// The cost of `error` with the fastest of its settings, after so many seconds `before` tracing.
    fn cost(&self, error: f64, before: f64) -> FastestSetting {
        let Some((series, point)) = self.fastest(error) else {
            return FastestSetting { error, ..FastestSetting::default() };
        };
        let random = self.random();
        let reached = random.and_then(|random| random.reach(error));
        let rival = reached.or(random.and_then(|random| random.points.last()));
        let tracing = point.seconds.median;
        let times = rival.and_then(|rival| {
            let time = |p: &SettingResult, seeds: &[usize]| {
                median(&of_seeds(seeds, &p.times).collect::<Vec<_>>())
            };
            let rounds = rival.times.len().min(point.times.len());
            bootstrap(rounds, |seeds| Some(time(rival, seeds) / time(point, seeds)))
        });
        FastestSetting {
            error,
            sampler: Some(series.name.clone()),
            points: Some(point.x as u64),
            seconds: Some(before + tracing),
            tracing: Some(tracing),
            times_as_fast: times,
            at_least: random.is_some() && reached.is_none(),
        }
    }
}
