//! Times the variants of a list in rounds, and checks every image.
//!
//! Nothing is timed before the first round has shown that the images are equal, and a different
//! image ends the comparison: the speed of a wrong image does not matter.

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::equal::Difference;
use super::hardware::{self, HardwareCounts};
use super::ratio::Ratio;
use super::run::Run;
use super::variant::{Axis, Choice, Variant};
use crate::measure::{Measured, Schedule, Timing, measure};
use crate::statistics::{KernelUse, Rays, Tests};
use crate::summary::{Summary, median};
use wavecrest_base::error::Result;
use wavecrest_core::counters::Counters;

/// The results of a list.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
pub struct Comparison {
    pub of: Axis,
    pub rounds: usize,
    pub left_out: usize,
    pub busy: usize,
    /// Empty if images differ.
    pub variants: Vec<VariantBench>,
    pub difference: Option<VariantDifference>,
    /// The work of one run; tests are those of the first variant.
    #[serde(skip)]
    pub counters: Counters,
}

/// The results of one variant.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
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
    pub yardstick: f64,
    pub mrays_s: f64,
    pub rays_s: RaysPerSecond,
    pub passes: Map<String, Value>,
    pub batch_bytes: u64,
    pub tests: Tests,
    pub tests_per_ray: TestsPerRay,
    pub kernels: KernelUse,
    pub hardware: Option<HardwareCounts>,
}

/// What a step gains.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
pub struct Gain {
    pub of: &'static str,
    pub from: String,
    #[serde(flatten)]
    pub ratio: Ratio,
}

/// Rays by kind, over the total time.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
pub struct RaysPerSecond {
    pub primary: f64,
    pub secondary: f64,
    pub shadow: f64,
}

/// Tests of nodes and of primitives of every kind, per ray of any kind.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
pub struct TestsPerRay {
    pub nodes: f64,
    pub primitives: f64,
}

/// A difference of an image from the first one.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
pub struct VariantDifference {
    pub label: String,
    pub first: String,
    #[serde(flatten)]
    pub difference: Difference,
}

/// What is kept of a run.
struct Kept {
    yardstick: f64,
    passes: Vec<(&'static str, f64)>,
    counters: Counters,
    columns: u64,
}

/// Runs `trace` with each of `choices` in turn as in `schedule`, and once more for the hardware
/// counters, if available.
///
/// # Errors
/// Those of `trace`.
pub fn compare(
    of: Axis,
    choices: &[Choice],
    schedule: &Schedule,
    mut trace: impl FnMut(&Variant, bool) -> Result<Run>,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Comparison> {
    let (mut first, mut difference) = (None, None);
    let run = |turn: crate::measure::Turn| {
        let choice = &choices[turn.variant];
        let Run { timing, yardstick, rendered, .. } = trace(&choice.variant, false)?;
        let first = first.get_or_insert_with(|| rendered.clone());
        // Without the plan there is more work, for the same image.
        let is_image = |found: &Difference| matches!(found, Difference::Pixel { .. });
        let counts = |found: &Difference| of != Axis::Plan || is_image(found);
        if let Some(found) = Difference::of(first, &rendered).filter(counts) {
            let (label, first) = (choice.label.clone(), choices[0].label.clone());
            difference = Some(VariantDifference { label, first, difference: found });
            return Ok(None);
        }
        let (passes, columns) = (rendered.pass_seconds, rendered.columns);
        let kept = Kept { yardstick, passes, counters: rendered.counters, columns };
        Ok(Some((timing, kept)))
    };
    let measured = measure(choices.len(), schedule, run, progress)?;
    let counters = first.map(|first| first.counters).unwrap_or_default();
    let mut comparison = Comparison {
        of,
        rounds: 0,
        left_out: 0,
        busy: 0,
        variants: Vec::new(),
        difference,
        counters,
    };
    if let Some(measured) = measured {
        comparison.take(choices, &measured);
        for found in comparison.variants.iter_mut().filter(|_| hardware::missing().is_none()) {
            found.hardware = trace(&found.variant, true)?.hardware;
        }
    }
    Ok(comparison)
}

impl Comparison {
    fn take(&mut self, choices: &[Choice], measured: &Measured<Kept>) {
        let seconds: Vec<Vec<f64>> = measured
            .variants
            .iter()
            .map(|runs| runs.iter().map(|(timing, _)| timing.seconds).collect())
            .collect();
        let name = |variant: usize| choices[variant].label.clone();
        let one = |(index, runs): (usize, &Vec<(Timing, Kept)>)| {
            let Choice { over, step, .. } = choices[index];
            let ratio = Ratio::of(&seconds, over, index)?;
            let gain = step.and_then(|step| {
                let ratio = Ratio::of(&seconds, step.from, index)?;
                Some(Gain { of: step.gain, from: name(step.from), ratio })
            });
            VariantBench::new(&choices[index], name(over), ratio, gain, runs)
        };
        self.variants = measured.variants.iter().enumerate().filter_map(one).collect();
        (self.rounds, self.left_out, self.busy) =
            (measured.rounds(), measured.left_out, measured.busy);
    }
}

impl VariantBench {
    fn new(
        choice: &Choice,
        over: String,
        ratio: Ratio,
        gain: Option<Gain>,
        runs: &[(Timing, Kept)],
    ) -> Option<Self> {
        let (_, last) = runs.last()?;
        let seconds: Vec<f64> = runs.iter().map(|(timing, _)| timing.seconds).collect();
        let seconds = Summary::of(&seconds)?;
        let rays = Rays::from(&last.counters);
        let rate = |rays: u64| rays as f64 / seconds.median;
        let tests = Tests::from(&last.counters);
        let primitives =
            tests.primitives.triangles + tests.primitives.quads + tests.primitives.spheres;
        let per_ray = |tests: u64| tests as f64 / rays.all().max(1) as f64;
        let together: Timing = runs.iter().map(|(timing, _)| *timing).sum();
        let yardsticks: Vec<f64> = runs.iter().map(|(_, kept)| kept.yardstick).collect();
        Some(Self {
            label: choice.label.clone(),
            variant: choice.variant,
            over,
            ratio,
            gain,
            processors: together.processors(),
            processor_seconds: runs.iter().map(|(timing, _)| timing.processor).collect(),
            yardstick: median(&yardsticks),
            mrays_s: rate(rays.all()) / 1e6,
            rays_s: RaysPerSecond {
                primary: rate(rays.primary),
                secondary: rate(rays.secondary),
                shadow: rate(rays.shadow),
            },
            passes: passes(runs),
            batch_bytes: last.columns / choice.variant.threads.max(1) as u64,
            tests_per_ray: TestsPerRay {
                nodes: per_ray(tests.nodes),
                primitives: per_ray(primitives),
            },
            tests,
            kernels: (&last.counters).into(),
            hardware: None,
            seconds,
        })
    }

    /// The median time in each pass, summed over threads, in seconds.
    pub fn pass_seconds(&self) -> impl Iterator<Item = (&str, f64)> {
        let seconds = |pass: &Value| pass["seconds"].as_f64().unwrap_or_default();
        self.passes.iter().map(move |(name, pass)| (name.as_str(), seconds(pass)))
    }
}

/// Median seconds of each pass and its share in their sum.
fn passes(runs: &[(Timing, Kept)]) -> Map<String, Value> {
    let names = runs.first().into_iter().flat_map(|(_, kept)| &kept.passes).map(|(name, _)| *name);
    let each = |pass: usize| runs.iter().map(|(_, kept)| kept.passes[pass].1).collect::<Vec<_>>();
    let medians: Vec<(&str, f64)> =
        names.enumerate().map(|(pass, name)| (name, median(&each(pass)))).collect();
    let sum: f64 = medians.iter().map(|(_, seconds)| seconds).sum();
    let share = |seconds: f64| if sum > 0.0 { seconds / sum } else { 0.0 };
    let entry =
        |(name, s): (&str, f64)| (name.to_owned(), json!({"seconds": s, "share": share(s)}));
    medians.into_iter().map(entry).collect()
}
