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
//! | `.points[].flip_95` | | the FLIP value that one pixel of twenty exceeds |
//! | `.points[].rays` | rays | of every kind, mean over seeds |
//! | `.points[].above_noise` | | whether the error is at least three standard errors of the reference |
//! | `stages` | seconds | for each precision: loading, building, and each pass at the scene's own samples, summed over threads: medians |
//! | `layers` | | time by precision, effect and pass: see [`layers`] |
//! | `trials` | | for each precision: rays aimed at edges and leaks, rays that leave a surface and self-hits, errors of t, points and normals in ulp ([`HitErrors`](crate::selftest::errors::HitErrors)) |
//! | `steps` | | what exact hits cost: `rays` of a render, `steps` with their counts there and nanoseconds each, and the nanoseconds of a pair in the filter of `fast`; see [`steps`](super::steps) |

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::answer::Answer;
use super::fit::{self, Interval};
use super::layers::{self, LayersFindings};
use super::pilot::Axis;
use super::setting::{Family, Line, Target};
use super::store::{
    PointRecord, PreparedRecord, Record, ReferenceRecord, SceneRecord, StepsRecord, TrialRecord,
    all,
};
use super::subject::Stages;
use super::sweep::Swept;
use crate::measure::{Timing, quiet};
use crate::summary::{ENOUGH, MedianInterval, median};
use wavecrest_image::compare::psnr;

/// Slopes are fitted from this number of points on: one or two points are not stratified.
pub const SLOPE_FROM: f64 = 4.0;

/// See the module documentation.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "the table above says it once, for the JSON and for the fields")]
pub struct SceneFindings {
    #[serde(flatten)]
    pub scene: SceneRecord,
    pub rounds: usize,
    pub busy: usize,
    pub left_out: bool,
    pub answer: Answer,
    pub references: Vec<ReferenceRecord>,
    pub families: Vec<FamilyFindings>,
    pub stages: Vec<StageFindings>,
    pub layers: Vec<LayersFindings>,
    pub trials: Vec<TrialRecord>,
    pub steps: Option<StepsRecord>,
}

/// One variation of a scene.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct FamilyFindings {
    pub name: &'static str,
    pub title: &'static str,
    pub counted: &'static str,
    pub target: Target,
    pub series: Vec<SeriesFindings>,
}

/// Settings in the order of the count.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct SeriesFindings {
    pub name: String,
    pub slope: Option<Interval>,
    pub points: Vec<PointFindings>,
}

/// A setting.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct PointFindings {
    pub x: f64,
    pub label: String,
    pub key: String,
    pub seconds: MedianInterval,
    pub rmse: Interval,
    pub mse: f64,
    pub relative_mse: f64,
    pub psnr: Option<f64>,
    pub flip: f64,
    pub flip_95: f64,
    pub bias: f64,
    pub rays: f64,
    pub above_noise: bool,
    /// The squared error of each seed.
    #[serde(skip)]
    pub each: Vec<f64>,
    /// The seconds of each seed.
    #[serde(skip)]
    pub times: Vec<f64>,
}

/// The time of a render by stage.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct StageFindings {
    pub precision: String,
    #[serde(flatten)]
    pub before: Stages,
    pub passes: Vec<(String, f64)>,
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
    pub fn of(swept: &Swept, records: &[Record], errors: &[f64]) -> Option<Self> {
        let name = swept.subject.name();
        let (rounds, busy) = busy_rounds(&name, records);
        let left_out = rounds - busy.len() >= ENOUGH.min(rounds);
        let mut found = Self {
            rounds,
            busy: busy.len(),
            left_out,
            scene: all(records).find(|scene: &&SceneRecord| scene.scene == name)?.clone(),
            answer: Answer::default(),
            references: all(records)
                .filter(|r: &&ReferenceRecord| r.scene == name)
                .cloned()
                .collect(),
            families: Vec::new(),
            stages: stages(swept, &name, records),
            layers: layers::of(&name, records),
            trials: all(records).filter(|t: &&TrialRecord| t.scene == name).cloned().collect(),
            steps: all(records).find(|s: &&StepsRecord| s.scene == name).cloned(),
        };
        let left = if left_out { busy } else { BTreeSet::new() };
        found.families =
            swept.families.iter().map(|f| found.family(f, &name, records, &left)).collect();
        let axis = Axis::of(&swept.subject.facts());
        found.answer = Answer::of(&found, axis.family(), errors);
        Some(found)
    }

    /// The standard error of the reference of `target`.
    pub fn standard_error(&self, target: Target) -> f64 {
        let of = self.references.iter().find(|reference| reference.target == target);
        of.map_or(0.0, |reference| reference.standard_error)
    }

    fn family(
        &self,
        family: &Family,
        scene: &str,
        records: &[Record],
        busy: &BTreeSet<u64>,
    ) -> FamilyFindings {
        let floor = super::reference::FLOOR * self.standard_error(family.target);
        let line = |line: &Line| {
            let points = line.points.iter().filter_map(|(x, label, setting)| {
                let records = of_setting(scene, family.target, &setting.key(), records);
                PointFindings::of((*x, label, &setting.key()), &records, floor, busy)
            });
            SeriesFindings { name: line.name.clone(), slope: None, points: points.collect() }
        };
        let mut series: Vec<SeriesFindings> = family.series.iter().map(line).collect();
        for line in series.iter_mut().filter(|_| family.has_slope) {
            line.slope = line.fit();
        }
        let Family { name, title, counted, target, .. } = *family;
        FamilyFindings { name, title, counted, target, series }
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

/// The renders of a setting.
fn of_setting<'a>(
    scene: &str,
    target: Target,
    key: &str,
    records: &'a [Record],
) -> Vec<&'a PointRecord> {
    let is_it = |p: &&PointRecord| p.scene == scene && p.target == target && p.key == key;
    all(records).filter(is_it).collect()
}

impl SeriesFindings {
    fn fit(&self) -> Option<Interval> {
        let counts = |p: &&PointFindings| p.above_noise && p.x >= SLOPE_FROM;
        let points: Vec<_> =
            self.points.iter().filter(counts).map(|p| (p.x, p.each.clone())).collect();
        fit::slope(&points)
    }
}

impl PointFindings {
    /// The findings of a setting: its count, label and key; times are those of rounds that were not
    /// busy.
    fn of(
        (x, label, key): (f64, &str, &str),
        records: &[&PointRecord],
        floor: f64,
        busy: &BTreeSet<u64>,
    ) -> Option<Self> {
        let all =
            |of: fn(&PointRecord) -> f64| -> Vec<f64> { records.iter().map(|r| of(r)).collect() };
        let mean = |of: fn(&PointRecord) -> f64| all(of).iter().sum::<f64>() / records.len() as f64;
        let each = all(|r| r.error.mse);
        let quiet = records.iter().filter(|record| !busy.contains(&record.seed));
        let times: Vec<f64> = quiet.map(|record| record.seconds).collect();
        let seconds = MedianInterval::of(&times)?;
        let rmse = fit::rmse(&each);
        let mse = mean(|r| r.error.mse);
        Some(Self {
            x,
            label: label.to_owned(),
            key: key.to_owned(),
            seconds,
            rmse,
            mse,
            relative_mse: mean(|r| r.error.relative_mse),
            psnr: (mse > 0.0).then(|| psnr(mse)),
            flip: mean(|r| r.error.flip),
            flip_95: mean(|r| r.error.flip_95),
            bias: mean(|r| r.error.bias),
            rays: mean(|r| r.rays as f64),
            above_noise: rmse.value >= floor,
            each,
            times,
        })
    }
}

fn stages(swept: &Swept, scene: &str, records: &[Record]) -> Vec<StageFindings> {
    let Some(family) = swept.families.iter().find(|family| family.name == "precision") else {
        return Vec::new();
    };
    let of = |setting: &super::setting::Setting| {
        let structure = super::setting::Setting { samples: Default::default(), ..*setting };
        let is_it = |p: &&PreparedRecord| p.scene == scene && p.key == structure.key();
        let before: Vec<Stages> = all(records).filter(is_it).map(|p| p.time).collect();
        let renders = of_setting(scene, family.target, &setting.key(), records);
        let first = renders.first()?;
        let pass = |index: usize| {
            let each: Vec<f64> =
                renders.iter().filter_map(|r| r.passes.get(index).map(|p| p.1)).collect();
            median(&each)
        };
        let passes = first.passes.iter().enumerate().map(|(i, p)| (p.0.clone(), pass(i))).collect();
        let each = |of: fn(&Stages) -> f64| median(&before.iter().map(of).collect::<Vec<_>>());
        Some(StageFindings {
            precision: setting.structure.precision.name().to_owned(),
            before: Stages { load: each(|s| s.load), build: each(|s| s.build) },
            passes,
        })
    };
    let points = family.series.iter().flat_map(|line| &line.points);
    points.filter_map(|(.., setting)| of(setting)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::store::Errors;

    #[test]
    fn a_round_with_less_of_the_processors_is_busy() {
        let point = |(seed, processor)| {
            let error = Errors { mse: 0.1, relative_mse: 0.1, bias: 0.0, flip: 0.0, flip_95: 0.0 };
            Record::Point(PointRecord {
                scene: "a".to_owned(),
                target: Target::Scene,
                key: "exact".to_owned(),
                seed,
                seconds: 0.5,
                yardstick: 0.0,
                timing: Some(Timing { seconds: 0.5, processor: Some(processor) }),
                passes: Vec::new(),
                rays: 1,
                error,
            })
        };
        // Two settings in each round, of which another program disturbs the second of seed 2.
        let times = [(0, 1.0), (0, 0.9), (1, 0.99), (1, 0.89), (2, 1.0), (2, 0.5)];
        let records: Vec<Record> = times.into_iter().map(point).collect();
        assert_eq!(busy_rounds("a", &records), (3, BTreeSet::from([2])));
        assert_eq!(busy_rounds("b", &records), (0, BTreeSet::new()));
    }
}
