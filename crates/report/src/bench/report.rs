//! The results of a benchmark, as written in JSON, with the problems of the measurement and their remedies.
//!
//! The kinds of warnings are those of hyperfine (Peter, *hyperfine*, 2018-): runs too short, a slow
//! first run, outliers. Each names the observation and the option that helps.

#![allow(missing_docs, reason = "the tables of crate::bench say it once")]

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::compare::{BenchComparison, VariantBench, compare, run};
use super::machine::Circumstances;
use super::variant::{Variant, Varied};
use crate::measure::{self, RoundLimits, busy};
use crate::plot::number::plural;
use crate::statistics::{ImageSize, Memory};
use crate::summary::{CONFIDENCE, ENOUGH};
use wavecrest_base::error::Result;
use wavecrest_base::memory;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::counters::{PrimitiveCounts, RayCounts};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::TracerKind;
use wavecrest_core::wavefront::batch::Batch;

/// See [`crate::bench`]: fields have the names of the JSON.
#[derive(Clone, Debug, Serialize)]
pub struct BenchReport {
    pub version: &'static str,
    #[serde(flatten)]
    pub circumstances: Circumstances,
    pub scenes: Vec<SceneBench>,
}

/// The results of one scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneBench {
    #[serde(flatten)]
    pub setting: BenchSetting,
    pub image: ImageSize,
    #[serde(flatten)]
    pub shapes: PrimitiveCounts,
    pub lights: usize,
    pub bytes_per_path: usize,
    pub memory: Memory,
    pub equal: bool,
    pub rays: RayCounts,
    pub invalid: u64,
    pub comparisons: Vec<BenchComparison>,
    pub warnings: Vec<String>,
}

/// Seconds before the first ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Preparation {
    /// Reading the file and the files that it names, and extracting arrays.
    pub load: f64,
    /// Building the tree.
    pub build: f64,
}

/// The settings: everything known before the first ray.
#[derive(Clone, Debug, Serialize)]
pub struct BenchSetting {
    pub scene: String,
    pub seed: u64,
    pub batch: usize,
    pub simd: Level,
    pub kernel: KernelChoice,
    pub precision: Precision,
    pub preset: Preset,
    pub time: Preparation,
}

/// What to compare, and how often.
#[derive(Clone, Debug)]
pub struct BenchPlan {
    /// The lists. The ladder is always the first.
    pub axes: Vec<Varied>,
    /// Batch sizes to compare.
    pub batches: Vec<usize>,
    /// Number and duration of rounds.
    pub schedule: RoundLimits,
}

impl BenchReport {
    /// An empty report by this program on this machine.
    pub fn new(command: Vec<String>) -> Self {
        let circumstances = Circumstances::here(command);
        Self { version: env!("CARGO_PKG_VERSION"), circumstances, scenes: Vec::new() }
    }
}

impl SceneBench {
    /// Measures a `scene` on the threads of the current pool. `progress` receives the runs done
    /// and their expected total, list by list. A different image ends it.
    ///
    /// # Errors
    /// If the scene cannot be rendered, or threads cannot be started.
    pub fn measure(
        scene: &mut PreparedScene,
        setting: BenchSetting,
        plan: &BenchPlan,
        progress: &mut dyn FnMut(u64, u64),
    ) -> Result<Self> {
        let usual = Variant {
            tracer: TracerKind::Wavefront,
            kernel: setting.kernel,
            simd: setting.simd,
            batch: setting.batch,
            threads: rayon::current_num_threads(),
            planned: true,
        };
        let (planned, mut pools) = (scene.plan.clone(), BTreeMap::new());
        let others = plan.axes.iter().copied().filter(|axis| *axis != Varied::Ladder);
        let mut comparisons: Vec<BenchComparison> = Vec::new();
        for axis in std::iter::once(Varied::Ladder).chain(others) {
            let choices = axis.choices(usual, &plan.batches);
            let trace = |variant: &Variant| run(scene, &planned, setting.seed, variant, &mut pools);
            comparisons.push(compare(axis, &choices, &plan.schedule, trace, progress)?);
            if comparisons.iter().any(|found| found.difference.is_some()) {
                break;
            }
        }
        scene.plan = planned;
        Ok(Self::of(scene, setting, comparisons))
    }

    /// The report on these `comparisons`, the ladder first.
    pub fn of(
        scene: &PreparedScene,
        setting: BenchSetting,
        comparisons: Vec<BenchComparison>,
    ) -> Self {
        let counters = comparisons.first().map(|ladder| ladder.counters).unwrap_or_default();
        // One for each remedy is enough.
        let remedy = |words: &str| words.rsplit(": ").next().map(str::to_owned);
        let mut told: Vec<String> = Vec::new();
        for warning in comparisons.iter().flat_map(warnings) {
            if told.iter().all(|known| remedy(known) != remedy(&warning)) {
                told.push(warning);
            }
        }
        Self {
            setting,
            image: ImageSize::of(scene),
            shapes: scene.accel.geometry().counts(),
            lights: scene.lights.len(),
            bytes_per_path: Batch::bytes_per_path(scene).iter().map(|(_, bytes)| bytes).sum(),
            memory: Memory { peak: memory::peak() },
            equal: comparisons.iter().all(|found| found.difference.is_none()),
            rays: counters.rays,
            invalid: counters.invalid,
            comparisons,
            warnings: told,
        }
    }

    /// The ladder, if its images are equal.
    pub fn ladder(&self) -> Option<&BenchComparison> {
        self.comparisons.first().filter(|ladder| !ladder.variants.is_empty())
    }

    /// The two tracers: the recursive one, and the wavefront, whose ratio is the answer.
    pub fn tracers(&self) -> Option<[&VariantBench; 2]> {
        let ladder = self.ladder()?;
        Some([ladder.variants.first()?, ladder.wavefront()?])
    }
}

/// A run shorter than this in seconds mostly starts threads and allocates buffers.
const SHORT: f64 = 0.005;
/// Quartiles farther apart than this share of the median are far apart.
const WIDE: f64 = 0.1;
/// A first run is slow if it is above the median by more than this many median absolute deviations,
/// ten standard deviations of a normal distribution ...
const SLOW_DEVIATIONS: f64 = 14.826;
/// ... and by more than this share of the median: if all runs are alike, a small difference is not
/// slow.
const SLOW_SHARE: f64 = 0.1;

/// The warnings about a comparison.
fn warnings(found: &BenchComparison) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut warn = |is_so: bool, text: String| warnings.extend(is_so.then_some(text));
    warn(cfg!(debug_assertions), "this is a debug build: build with --release".to_owned());
    let invalid = found.counters.invalid;
    warn(invalid > 0, format!("{invalid} samples were not finite: run check on the scene"));
    let most = |value: fn(&VariantBench) -> f64| {
        found.variants.iter().max_by(|a, b| value(a).total_cmp(&value(b)))
    };
    if let Some(v) = most(|v| -v.seconds.median) {
        let (label, median) = (&v.label, v.seconds.median);
        let what = "much of it startup: render a larger image with --width and --height";
        warn(median < SHORT, format!("a run ({label}) takes {:.2} ms, {what}", median * 1e3));
    }
    let first =
        |v: &VariantBench| v.seconds.each.first().map_or(0.0, |first| first / v.seconds.median);
    if let Some(v) = most(first) {
        let above = (first(v) - 1.0) * v.seconds.median;
        let is_slow = above > SLOW_DEVIATIONS * v.seconds.mad && first(v) > 1.0 + SLOW_SHARE;
        let (label, times) = (&v.label, first(v));
        let what = "warm up for longer with --warmup";
        warn(is_slow, format!("the first run ({label}) took {times:.2} times the median: {what}"));
    }
    if let Some(v) = most(|v| v.seconds.spread()) {
        let (label, spread) = (&v.label, 100.0 * v.seconds.spread());
        let what = "close other programs, or run for longer with --min-time";
        let text =
            format!("times ({label}) vary: half of them are within {spread:.0} % of the median");
        warn(v.seconds.spread() > WIDE, format!("{text}: {what}"));
    }
    let rounds = found.rounds.rounds;
    let percent = 100.0 * CONFIDENCE;
    warn(
        (1..ENOUGH).contains(&rounds),
        format!(
            "{} cannot give {percent:.0} % confidence: run {ENOUGH} or more with --repeats",
            plural(rounds, "round")
        ),
    );
    let used = busy([found.rounds]).filter(|_| found.rounds.busy > 0);
    warnings.extend(used.into_iter().chain(waiting(found)).map(|words| words.to_lowercase()));
    warnings
}

/// That threads waited for processors, or for work.
pub(super) fn waiting(found: &BenchComparison) -> Option<String> {
    let share = |v: &VariantBench| Some(v.processors? / v.variant.threads as f64);
    measure::waiting(found.variants.iter().filter_map(share))
}
