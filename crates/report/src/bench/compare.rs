//! Variants of the wavefront: kernels, vector instructions, batch sizes, or a plan that skips
//! nothing.
//!
//! Each variant runs once in each round, so that slow phases of the machine affect all of them
//! alike, and the first to run alternates. The ratio of each to the default is taken round by
//! round. As between tracers, every image is checked, and a different one ends the comparison.

use serde::Serialize;

use super::hardware;
use super::measure::{Difference, Runs, Schedule, difference};
use super::tracer::{Ratio, TracerBench};
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::counters::Counters;
use wavecrest_core::math::simd::Level;
use wavecrest_core::render::{Rendered, TracerKind};

/// Batch sizes to compare other than the default.
const BATCHES: [usize; 4] = [64, 256, 1024, 4096];

wavecrest_base::choices! {
    /// The property that differs between the variants.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Axis {
        /// Traversal kernels.
        Kernels = "kernels",
        /// Instruction sets.
        Levels = "levels",
        /// Batch sizes.
        Batches = "batches",
        /// Unneeded passes left out, or all forced on.
        Plan = "plan",
    }
}

/// A variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Variant {
    /// Traversal kernels.
    pub kernel: KernelChoice,
    /// Instruction sets.
    pub simd: Level,
    /// Paths in a batch.
    pub batch: usize,
    /// Whether passes, columns and code that the scene does not need are skipped.
    pub planned: bool,
}

impl Axis {
    /// The variants: the `usual` one, then those that differ from it.
    pub fn variants(self, usual: Variant) -> Vec<Variant> {
        let others: Vec<Variant> = match self {
            Self::Kernels => {
                let kernels = KernelChoice::FOR_RENDERS.into_iter();
                kernels.map(|kernel| Variant { kernel, ..usual }).collect()
            }
            Self::Levels => {
                Level::available().into_iter().map(|simd| Variant { simd, ..usual }).collect()
            }
            Self::Batches => BATCHES.into_iter().map(|batch| Variant { batch, ..usual }).collect(),
            Self::Plan => vec![Variant { planned: !usual.planned, ..usual }],
        };
        let others = others.into_iter().filter(|other| *other != usual);
        std::iter::once(usual).chain(others).collect()
    }

    /// The label of `variant` among the others.
    pub fn label(self, variant: &Variant) -> String {
        match self {
            Self::Kernels => variant.kernel.name().to_owned(),
            Self::Levels => variant.simd.name().to_owned(),
            Self::Batches => variant.batch.to_string(),
            Self::Plan => if variant.planned { "planned" } else { "unplanned" }.to_owned(),
        }
    }
}

/// Several variants, timed in rounds.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// The property that differs.
    pub of: Axis,
    /// Timed rounds.
    pub rounds: usize,
    /// The results of each, the default first; empty if images differ.
    pub variants: Vec<VariantBench>,
    /// The difference that ended the comparison, if any.
    pub difference: Option<VariantDifference>,
}

/// The results of one variant.
#[derive(Clone, Debug, Serialize)]
pub struct VariantBench {
    /// The choice.
    #[serde(flatten)]
    pub variant: Variant,
    /// Its runs.
    #[serde(flatten)]
    pub bench: TracerBench,
    /// Its speed over that of the default.
    pub ratio: Ratio,
}

/// A difference of an image from the first one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VariantDifference {
    /// The variant that rendered it.
    #[serde(flatten)]
    pub variant: Variant,
    /// The difference.
    pub difference: Difference,
}

/// Runs `trace` with each of `variants` in turn as in `schedule`, with rounds instead of pairs, and
/// once more for the hardware counters, if available.
///
/// # Errors
/// Those of `trace`.
pub fn compare(
    of: Axis,
    variants: &[Variant],
    schedule: &Schedule,
    mut trace: impl FnMut(&Variant) -> Result<Rendered>,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Comparison> {
    let mut runs = vec![Runs::default(); variants.len()];
    let mut first: Option<Rendered> = None;
    for round in 0.. {
        for turn in 0..variants.len() {
            let index = (turn + round) % variants.len();
            let run = trace(&variants[index])?;
            let first = first.get_or_insert_with(|| run.clone());
            let found = difference(TracerKind::Wavefront, first, &run);
            // Without the plan there is more work, for the same image.
            let is_image = |found: &Difference| matches!(found, Difference::Pixel { .. });
            let counts = |found: &Difference| of != Axis::Plan || is_image(found);
            if let Some(difference) = found.filter(counts) {
                let difference = Some(VariantDifference { variant: variants[index], difference });
                return Ok(Comparison { of, rounds: 0, variants: Vec::new(), difference });
            }
            if round >= schedule.warmup.max(1) {
                runs[index].add(&run);
            }
        }
        let done = runs.first().map_or(0, |runs| runs.seconds.len());
        let shortest = runs.iter().map(|runs| runs.seconds.iter().sum()).reduce(f64::min);
        let planned = schedule.planned(done, shortest.unwrap_or_default());
        progress(done as u64, planned as u64);
        if done >= planned || variants.is_empty() {
            break;
        }
    }
    count(&mut runs, variants, trace)?;
    let counters = first.map(|first| first.counters).unwrap_or_default();
    Ok(Comparison::new(of, variants, &runs, &counters))
}

/// Runs each variant separately for the hardware counters, so that counting does not slow timed
/// runs.
fn count(
    runs: &mut [Runs],
    variants: &[Variant],
    mut trace: impl FnMut(&Variant) -> Result<Rendered>,
) -> Result<()> {
    for (runs, variant) in runs.iter_mut().zip(variants) {
        if hardware::missing().is_none() {
            let (rendered, counted) = hardware::count(|| trace(variant));
            rendered?;
            runs.hardware = counted.ok();
        }
    }
    Ok(())
}

impl Comparison {
    fn new(of: Axis, variants: &[Variant], runs: &[Runs], counters: &Counters) -> Self {
        let usual = runs.first().map(|runs| runs.seconds.clone()).unwrap_or_default();
        let each = variants.iter().zip(runs).filter_map(|(&variant, runs)| {
            let ratio = Ratio::of(&usual, &runs.seconds)?;
            Some(VariantBench { variant, bench: TracerBench::new(runs, counters)?, ratio })
        });
        Self { of, rounds: usual.len(), variants: each.collect(), difference: None }
    }
}

#[cfg(test)]
mod tests;
