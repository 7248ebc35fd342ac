//! Times the variants of a list in rounds, and checks every image.
//!
//! Nothing is timed before the first round has shown that the images are equal, and a different
//! image ends the comparison: the speed of a wrong image does not matter.

#![allow(missing_docs, reason = "the tables of crate::bench say it once")]

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;

use super::equal::RunDifference;
use super::variant::{ListedVariant, Variant, Varied};
use crate::measure::{RoundLimits, Rounds, TimedRuns, Timing, measure};
use crate::page::Cell;
use crate::statistics::as_map;
use crate::summary::{MedianInterval, Summary, median};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::counters::{Counters, Kernels, TestCounts};
use wavecrest_core::plan::Plan;
use wavecrest_core::plan::schedule::UNPLANNED;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, TracerKind, render};
use wavecrest_core::tile::TimedPass;

/// The results of a list.
#[derive(Clone, Debug, Serialize)]
pub struct BenchComparison {
    pub of: Varied,
    #[serde(flatten)]
    pub rounds: Rounds,
    /// Empty if images differ.
    pub variants: Vec<VariantBench>,
    pub difference: Option<RunDifference>,
    /// The work of one run; tests are those of the first variant.
    #[serde(skip)]
    pub counters: Counters,
}

impl BenchComparison {
    /// The last variant of the wavefront.
    pub fn wavefront(&self) -> Option<&VariantBench> {
        self.variants.iter().rfind(|v| v.variant.tracer == TracerKind::Wavefront)
    }
}

/// The results of one variant.
#[derive(Clone, Debug, Serialize)]
pub struct VariantBench {
    pub label: String,
    #[serde(flatten)]
    pub variant: Variant,
    pub over: String,
    pub ratio: Ratio,
    pub gain: Option<Gain>,
    pub seconds: Summary,
    pub processors: Option<f64>,
    pub processor_seconds: Vec<Option<f64>>,
    pub mrays_s: f64,
    /// The median time in each, summed over threads, in seconds.
    #[serde(serialize_with = "as_map")]
    pub passes: Vec<(&'static str, f64)>,
    pub costs: Vec<PassCost>,
    pub batch_bytes: u64,
    pub tests: TestCounts,
    pub kernels: Kernels,
}

/// The speed of one variant over that of another.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Ratio {
    /// Median and interval.
    #[serde(flatten)]
    pub interval: MedianInterval,
    /// Number of rounds.
    pub pairs: usize,
}

impl Ratio {
    /// The speed of the variant `of` over that of `over`: the `seconds` of `over` in each round
    /// over those of the other; `None` without rounds.
    ///
    /// Medians of ratios do not multiply. So that they do, the ratio of any two variants is that of
    /// their speeds relative to the first one. It rarely is outside of its own interval, which is
    /// then extended to it.
    pub(crate) fn of(seconds: &[Vec<f64>], over: usize, of: usize) -> Option<Self> {
        let pairs = |over: usize, of: usize| {
            let each = seconds[over].iter().zip(&seconds[of]);
            MedianInterval::of(&each.map(|(over, of)| over / of).collect::<Vec<_>>())
        };
        let median = pairs(0, of)?.median / pairs(0, over)?.median;
        let i = pairs(over, of)?;
        let (low, high) = (i.low.min(median), i.high.max(median));
        let interval = MedianInterval { median, low, high, ..i };
        Some(Self { interval, pairs: seconds[of].len() })
    }

    /// Median and interval, for a table.
    pub(crate) fn cell(&self) -> Cell {
        let i = &self.interval;
        Cell::number(i.median, format!("{:.3} ({:.3} to {:.3})", i.median, i.low, i.high))
    }
}

/// What a step gains.
#[derive(Clone, Debug, Serialize)]
pub struct Gain {
    pub of: &'static str,
    pub from: String,
    #[serde(flatten)]
    pub ratio: Ratio,
}

/// The cost of a pass for one of what it handles.
#[derive(Clone, Debug, Serialize)]
pub struct PassCost {
    pub pass: &'static str,
    pub of: &'static str,
    pub count: u64,
    pub nanoseconds: f64,
}

/// The resolution of the clock in seconds: no run is shorter, so that ratios of times are finite.
const CLOCK_STEP: f64 = 1e-9;

/// A render with its time.
#[derive(Clone, Debug)]
pub struct TimedRender {
    /// Its duration.
    pub timing: Timing,
    /// Its image and its work.
    pub rendered: Rendered,
}

impl TimedRender {
    /// Renders `scene` on the threads of the current pool.
    ///
    /// # Errors
    /// Those of [`render`].
    pub fn of(scene: &PreparedScene, options: &RenderOptions) -> Result<Self> {
        let (rendered, Timing { processor, .. }) = Timing::of(|| render(scene, options, &()));
        let rendered = rendered?;
        let seconds = rendered.seconds.max(CLOCK_STEP);
        Ok(Self { timing: Timing { seconds, processor }, rendered })
    }
}

/// Renders `scene`, whose own plan is `planned`, as `variant`; `pools` are those of other numbers of threads than that of
/// the current one.
pub(super) fn run(
    scene: &mut PreparedScene,
    planned: &Plan,
    seed: u64,
    variant: &Variant,
    pools: &mut BTreeMap<usize, ThreadPool>,
) -> Result<TimedRender> {
    let &Variant { tracer, kernel, simd, batch, threads, planned: is_planned } = variant;
    scene.accel.kernel = kernel;
    if let Some(level) = simd.token() {
        scene.accel.level = level;
    }
    scene.plan = match is_planned {
        true => planned.clone(),
        false => Plan::of(planned.decisions().to_vec(), &UNPLANNED),
    };
    let options = RenderOptions { tracer, batch, seed, crop: None };
    if threads == rayon::current_num_threads() {
        return TimedRender::of(scene, &options);
    }
    let pool = match pools.entry(threads) {
        Entry::Occupied(pool) => pool.into_mut(),
        Entry::Vacant(place) => {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            place.insert(pool.map_err(|e| {
                Error::new(ErrorKind::Usage, format!("cannot start threads: {e}"))
                    .remedy("raise the limits of the process (ulimit -u, -v)")
            })?)
        }
    };
    pool.install(|| TimedRender::of(scene, &options))
}

/// What is kept of a run.
struct KeptRun {
    passes: Vec<(&'static str, f64)>,
    counters: Counters,
    columns: u64,
}

/// Runs `trace` with each of `choices` in turn as in `schedule`.
///
/// # Errors
/// Those of `trace`.
pub fn compare(
    of: Varied,
    choices: &[ListedVariant],
    schedule: &RoundLimits,
    mut trace: impl FnMut(&Variant) -> Result<TimedRender>,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<BenchComparison> {
    let (mut first, mut difference) = (None, None);
    let run = |variant: usize| {
        let choice = &choices[variant];
        let TimedRender { timing, rendered } = trace(&choice.variant)?;
        let first = first.get_or_insert_with(|| rendered.clone());
        // Without the plan there is more work, for the same image.
        let counts = |found: &RunDifference| of != Varied::Plan || found.is_image;
        let names = [&*choice.label, &choices[0].label];
        difference = RunDifference::of(names, &rendered, first).filter(counts);
        if difference.is_some() {
            return Ok(None);
        }
        let (passes, columns) = (rendered.pass_seconds, rendered.columns);
        Ok(Some((timing, KeptRun { passes, counters: rendered.counters, columns })))
    };
    let (runs, rounds) = measure(choices.len(), schedule, run, progress)?.unwrap_or_default();
    Ok(BenchComparison {
        of,
        rounds,
        variants: variants(choices, &runs),
        difference,
        counters: first.map(|first| first.counters).unwrap_or_default(),
    })
}

/// The results of each variant, given its runs.
fn variants(choices: &[ListedVariant], measured: &TimedRuns<KeptRun>) -> Vec<VariantBench> {
    let seconds = |runs: &Vec<(Timing, KeptRun)>| runs.iter().map(|(t, _)| t.seconds).collect();
    let seconds: Vec<Vec<f64>> = measured.iter().map(seconds).collect();
    let one = |(index, runs): (usize, &Vec<(Timing, KeptRun)>)| {
        let ListedVariant { label, variant, over, step } = &choices[index];
        let gain = step.and_then(|(from, of)| {
            let ratio = Ratio::of(&seconds, from, index)?;
            Some(Gain { of, from: choices[from].label.clone(), ratio })
        });
        let (_, last) = runs.last()?;
        let summary = Summary::of(&seconds[index])?;
        let passes = passes(runs);
        let together: Timing = runs.iter().map(|(timing, _)| *timing).sum();
        Some(VariantBench {
            label: label.clone(),
            variant: *variant,
            over: choices[*over].label.clone(),
            ratio: Ratio::of(&seconds, *over, index)?,
            gain,
            processors: together.processors(),
            processor_seconds: runs.iter().map(|(timing, _)| timing.processor).collect(),
            mrays_s: last.counters.rays.all() as f64 / summary.median / 1e6,
            costs: costs(&passes, &last.counters),
            passes,
            batch_bytes: last.columns / variant.threads.max(1) as u64,
            tests: last.counters.tests,
            kernels: last.counters.kernels,
            seconds: summary,
        })
    };
    measured.iter().enumerate().filter_map(one).collect()
}

/// Median seconds of each pass.
fn passes(runs: &[(Timing, KeptRun)]) -> Vec<(&'static str, f64)> {
    let names = runs.first().into_iter().flat_map(|(_, kept)| &kept.passes).map(|(name, _)| *name);
    let each = |pass: usize| runs.iter().map(|(_, kept)| kept.passes[pass].1).collect::<Vec<_>>();
    names.enumerate().map(|(pass, name)| (name, median(&each(pass)))).collect()
}

/// The costs of those of the `passes` that have work, with their seconds. The recursive tracer has none.
fn costs(passes: &[(&'static str, f64)], c: &Counters) -> Vec<PassCost> {
    let handled = [
        (TimedPass::Generate, "camera ray", c.rays.primary),
        (TimedPass::Intersect, "ray", c.rays.primary + c.rays.secondary),
        (TimedPass::Shade, "plain hit", c.samples.plain),
        (TimedPass::Maps, "mapped hit", c.samples.mapped),
        (TimedPass::Maps, "look-up of a map", c.samples.maps),
        (TimedPass::Shadow, "shadow ray", c.rays.shadow),
        (TimedPass::Resolve, "sample", c.rays.primary),
    ];
    let with_work = handled.into_iter().filter(|(.., count)| *count > 0);
    let cost = |(pass, of, count): (TimedPass, _, _)| {
        let &(pass, seconds) = passes.iter().find(|(name, _)| *name == pass.name())?;
        Some(PassCost { pass, of, count, nanoseconds: 1e9 * seconds / count as f64 })
    };
    with_work.filter_map(cost).collect()
}
