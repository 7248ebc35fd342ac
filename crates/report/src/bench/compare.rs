//! The wavefront against itself: with each kernel, each set of vector instructions, batches of several
//! sizes, or with nothing left out.
//!
//! Each choice runs once a round, so that what slows the machine down for a while slows all of them
//! down, and who goes first takes turns. The ratio of each to the default is taken round by
//! round. As between tracers, every image is checked, and one that differs ends it.

use serde::Serialize;

use super::hardware;
use super::measure::{Difference, Runs, Schedule, difference};
use super::tracer::{Ratio, TracerBench};
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::counters::Counters;
use wavecrest_core::math::simd::Level;
use wavecrest_core::render::{Rendered, TracerKind};

/// Sizes of batches that are compared besides the usual one.
const BATCHES: [usize; 4] = [64, 256, 1024, 4096];

wavecrest_base::choices! {
    /// What differs between the choices that are compared.
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

/// One choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Variant {
    /// Traversal kernels.
    pub kernel: KernelChoice,
    /// Instruction sets.
    pub simd: Level,
    /// Paths in a batch.
    pub batch: usize,
    /// Whether passes, columns and code that the scene does not call for are left out.
    pub planned: bool,
}

impl Axis {
    /// What is compared: the `usual` choice, then those that differ from it.
    pub fn variants(self, usual: Variant) -> Vec<Variant> {
        let others: Vec<Variant> = match self {
            Self::Kernels => {
                KernelChoice::ALL.into_iter().map(|kernel| Variant { kernel, ..usual }).collect()
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

    /// What sets `variant` apart from the others.
    pub fn label(self, variant: &Variant) -> String {
        match self {
            Self::Kernels => variant.kernel.name().to_owned(),
            Self::Levels => variant.simd.name().to_owned(),
            Self::Batches => variant.batch.to_string(),
            Self::Plan => if variant.planned { "planned" } else { "everything" }.to_owned(),
        }
    }
}

/// Several choices, timed in rounds.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// What differs between them.
    pub of: Axis,
    /// Timed rounds.
    pub rounds: usize,
    /// What was found of each, the default first; empty where images differ.
    pub variants: Vec<VariantBench>,
    /// What ended the comparison, if anything did.
    pub difference: Option<VariantDifference>,
}

/// What was found of one choice.
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

/// How an image differs from the first one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VariantDifference {
    /// The choice that gave it.
    #[serde(flatten)]
    pub variant: Variant,
    /// How it differs.
    pub difference: Difference,
}

/// Runs `trace` with each of `variants` in turn as `schedule` says, with rounds in place of pairs, and
/// once more to be counted by the processor where it counts.
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
            if let Some(difference) = difference(TracerKind::Wavefront, first, &run) {
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

/// Has the processor count each variant in a run of its own, so that counting slows none that is timed.
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
