//! The findings of a sweep: its records summarised, as stored in JSON and shown.
//!
//! | key of a scene | unit | meaning |
//! |---|---|---|
//! | `scene`, `file`, `fingerprint`, `size`, `primitives` | | the scene and the size of its images in pixels |
//! | `rounds`, `busy` | | rounds of all settings, one for each seed, and how many were busy: the program got clearly less of the processors than in the best one |
//! | `left_out` | | whether times leave out the busy rounds: enough others remain |
//! | `answer` | | see [`answer`](super::answer) |
//! | `references` | | the references of errors: samples of each kind in a pixel, renders, standard error (root mean square), seconds |
//! | `families` | | the variations: `name`, `title`, what is `counted`, the `target`, and `series`: |
//! | `.slope` | | exponent of the mean squared error as a function of the count, from [`SLOPE_FROM`] on, with its interval; `null` if too few points are above the noise of the reference |
//! | `.points[].x`, `.label`, `.key` | | the count, and the setting |
//! | `.points[].seconds` | seconds | from the first ray to the last: median with its interval |
//! | `.points[].rmse` | | root of the mean squared error over all seeds, with its interval |
//! | `.points[].mse`, `.relative_mse`, `.psnr`, `.flip`, `.bias` | | means over seeds; see [`wavecrest_image::compare`] |
//! | `.points[].rays` | rays | of every kind, mean over seeds |
//! | `.points[].above_noise` | | whether the error is at least three standard errors of the reference |
//! | `layers` | | time by precision, effect and pass: see [`layers`] |
//! | `trials` | | for each precision: rays aimed at edges and leaks, rays that leave a surface and self-hits, errors of t, points and normals in ulp ([`HitErrors`](crate::selftest::errors::HitErrors)) |
//! | `steps` | | what exact hits cost: `rays` of a render, `steps` with their counts there and nanoseconds each, and the nanoseconds of a pair in the filter of `fast`; see [`steps`](super::steps) |

#![allow(missing_docs, reason = "the table above says it once, for the JSON and for the fields")]

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::answer::Answer;
use super::fit::{self, Interval};
use super::layers::{self, LayersFindings};
use super::pilot::Axis;
use super::reference::FLOOR;
use super::setting::{self, Family, Series, Setting, Target, converges};
use super::store::{
    PointRecord, Record, ReferenceRecord, SceneRecord, StepsRecord, TrialRecord, all,
};
use super::sweep::Swept;
use crate::measure::{Timing, quiet};
use crate::summary::{ENOUGH, MedianInterval};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_image::compare::psnr;

/// Slopes are fitted from this number of points on: one or two points are not stratified.
pub const SLOPE_FROM: f64 = 4.0;

/// See the module documentation.
#[derive(Clone, Debug, Serialize)]
pub struct SceneFindings {
    #[serde(flatten)]
    pub scene: SceneRecord,
    pub rounds: usize,
    pub busy: usize,
    pub left_out: bool,
    pub answer: Answer,
    pub references: Vec<ReferenceRecord>,
    pub families: Vec<Family<Point>>,
    pub layers: Vec<LayersFindings>,
    pub trials: Vec<TrialRecord>,
    pub steps: Option<StepsRecord>,
}

/// A setting.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    pub x: f64,
    pub label: String,
    pub key: String,
    pub seconds: MedianInterval,
    pub rmse: Interval,
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

impl SceneFindings {
    /// Busy rounds in a sentence; empty without any.
    pub fn busy(&self) -> String {
        let &Self { rounds, busy, left_out, .. } = self;
        match left_out {
            _ if busy == 0 => String::new(),
            true => format!(
                "Times leave out {busy} of {rounds} rounds, in which other programs took the processors."
            ),
            false => format!(
                "In {busy} of {rounds} rounds other programs took the processors: times are not to be relied on."
            ),
        }
    }

    /// Summarises the `records` of `swept`.
    pub fn of(swept: &Swept, records: &[Record], errors: &[f64]) -> Self {
        let Swept { subject, families, .. } = swept;
        let name = &*subject.record.scene;
        let (rounds, busy) = busy_rounds(name, records);
        let left_out = rounds - busy.len() >= ENOUGH.min(rounds);
        let mut found = Self {
            rounds,
            busy: busy.len(),
            left_out,
            scene: subject.record.clone(),
            answer: Answer::default(),
            references: all(records)
                .filter(|r: &&ReferenceRecord| r.scene == name)
                .cloned()
                .collect(),
            families: Vec::new(),
            layers: layers::of(name, records),
            trials: all(records).filter(|t: &&TrialRecord| t.scene == name).cloned().collect(),
            steps: all(records).find(|s: &&StepsRecord| s.scene == name).cloned(),
        };
        let left = if left_out { busy } else { BTreeSet::new() };
        found.families = families.iter().map(|f| found.summary(f, records, &left)).collect();
        let varied = found.family(Axis::of(&subject.facts).name());
        let before = found.layers(Precision::default()).map(|layers| layers.before);
        let before = before.map_or(0.0, |before| before.load + before.build);
        let answer = varied.map(|f| Answer::of(f, before, errors));
        found.answer = answer.unwrap_or_default();
        found
    }

    /// The error up to which those against the reference of `target` are noise.
    pub fn floor(&self, target: Target) -> f64 {
        let of = self.references.iter().find(|reference| reference.target == target);
        of.map_or(0.0, |reference| FLOOR * reference.standard_error)
    }

    /// The layers in this precision.
    pub fn layers(&self, precision: Precision) -> Option<&LayersFindings> {
        self.layers.iter().find(|layers| layers.precision == precision.name())
    }

    /// The family of this name.
    pub fn family(&self, name: &str) -> Option<&Family<Point>> {
        self.families.iter().find(|family| family.name == name)
    }

    fn summary(
        &self,
        family: &Family<setting::Point>,
        records: &[Record],
        busy: &BTreeSet<u64>,
    ) -> Family<Point> {
        let &Family { name, title, counted, target, .. } = family;
        let floor = self.floor(target);
        let line = |line: &Series<setting::Point>| {
            let point = |point: &setting::Point| {
                let (scene, key) = (&self.scene.scene, point.2.key());
                let is_it =
                    |p: &&PointRecord| p.scene == *scene && p.target == target && p.key == key;
                let renders: Vec<&PointRecord> = all(records).filter(is_it).collect();
                Point::of(point, &renders, floor, busy)
            };
            let points: Vec<Point> = line.points.iter().filter_map(point).collect();
            let counts = |p: &&Point| p.above_noise && p.x >= SLOPE_FROM && converges(&p.key);
            let falling: Vec<_> = points.iter().filter(counts).map(|p| (p.x, &*p.each)).collect();
            Series { name: line.name.clone(), slope: fit::slope(&falling), points }
        };
        let series = family.series.iter().map(line).collect();
        Family { name, title, counted, target, series }
    }
}

/// The number of rounds of a scene, and the seeds of those that were busy.
pub(crate) fn busy_rounds(scene: &str, records: &[Record]) -> (usize, BTreeSet<u64>) {
    let mut rounds: BTreeMap<u64, Vec<Timing>> = BTreeMap::new();
    for point in all::<PointRecord>(records).filter(|point| point.scene == scene) {
        rounds.entry(point.seed).or_default().extend(point.timing);
    }
    let sums: Vec<Timing> = rounds.values().map(|all| all.iter().copied().sum()).collect();
    let quiet = quiet(&sums);
    let busy = rounds.keys().zip(&quiet).filter(|(_, quiet)| !**quiet).map(|(seed, _)| *seed);
    (rounds.len(), busy.collect())
}

impl Point {
    /// The findings of a setting; times are those of rounds that were not busy.
    fn of(
        (x, label, setting): &setting::Point,
        renders: &[&PointRecord],
        floor: f64,
        busy: &BTreeSet<u64>,
    ) -> Option<Self> {
        let all = |of: fn(&PointRecord) -> f64| renders.iter().map(move |r| of(r));
        let mean = |of: fn(&PointRecord) -> f64| all(of).sum::<f64>() / renders.len() as f64;
        let each: Vec<f64> = all(|r| r.error.mse).collect();
        let quiet = renders.iter().filter(|record| !busy.contains(&record.seed));
        let times: Vec<f64> = quiet.map(|record| record.seconds).collect();
        let rmse = fit::rmse(&each);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::store::tests::sample;

    #[test]
    fn a_round_with_less_of_the_processors_is_busy() {
        let point = |(seed, processor)| {
            let timing = Some(Timing { seconds: 0.5, processor: Some(processor) });
            Record::Point(PointRecord { timing, ..sample(seed) })
        };
        // Two settings in each round, of which another program disturbs the second of seed 2.
        let times = [(0, 1.0), (0, 0.9), (1, 0.99), (1, 0.89), (2, 1.0), (2, 0.5)];
        let records: Vec<Record> = times.into_iter().map(point).collect();
        assert_eq!(busy_rounds("a", &records), (3, BTreeSet::from([2])));
        assert_eq!(busy_rounds("b", &records), (0, BTreeSet::new()));
    }
}
