//! The results of one tracer, and the ratio of two.

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::hardware::HardwareCounts;
use super::measure::Runs;
use crate::statistics::{KernelUse, Rays, Tests};
use crate::summary::{MedianInterval, Summary, median};
use wavecrest_core::counters::Counters;

/// The results of one tracer.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
pub struct TracerBench {
    pub seconds: Summary,
    pub yardstick: f64,
    pub mrays_s: f64,
    pub rays_s: RaysPerSecond,
    pub passes: Map<String, Value>,
    pub tests: Tests,
    pub tests_per_ray: TestsPerRay,
    pub kernels: KernelUse,
    pub hardware: Option<HardwareCounts>,
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

/// Speed of the wavefront over that of the recursive tracer.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
pub struct Ratio {
    #[serde(flatten)]
    pub interval: MedianInterval,
    pub pairs: usize,
    pub method: &'static str,
}

/// The method of the ratio's interval.
pub const METHOD: &str = "order statistics of paired ratios (Thompson 1936)";

impl TracerBench {
    /// The results of `runs`, each with the work of `counters`; `None` without runs.
    pub(super) fn new(runs: &Runs, counters: &Counters) -> Option<Self> {
        let seconds = Summary::of(&runs.seconds)?;
        let rays = Rays::from(counters);
        let rate = |rays: u64| rays as f64 / seconds.median;
        let tests = &runs.tests;
        let primitives = tests.triangles + tests.quads + tests.spheres;
        let per_ray = |tests: u64| tests as f64 / rays.all().max(1) as f64;
        Some(Self {
            mrays_s: rate(rays.all()) / 1e6,
            rays_s: RaysPerSecond {
                primary: rate(rays.primary),
                secondary: rate(rays.secondary),
                shadow: rate(rays.shadow),
            },
            passes: passes(runs),
            tests: (&Counters { tests: *tests, ..*counters }).into(),
            kernels: (&Counters { kernels: runs.kernels, ..*counters }).into(),
            hardware: runs.hardware,
            tests_per_ray: TestsPerRay {
                nodes: per_ray(tests.nodes),
                primitives: per_ray(primitives),
            },
            seconds,
            yardstick: median(&runs.yardsticks),
        })
    }
}

/// Median seconds of each pass and its share in their sum.
fn passes(runs: &Runs) -> Map<String, Value> {
    let medians: Vec<_> = runs.passes.iter().map(|(name, each)| (*name, median(each))).collect();
    let sum: f64 = medians.iter().map(|(_, seconds)| seconds).sum();
    let share = |seconds: f64| if sum > 0.0 { seconds / sum } else { 0.0 };
    medians
        .into_iter()
        .map(|(name, s)| (name.to_owned(), json!({ "seconds": s, "share": share(s) })))
        .collect()
}

impl Ratio {
    /// The seconds of one over those of another, run by run: the speed of the other relative to the
    /// first.
    pub(crate) fn of(one: &[f64], other: &[f64]) -> Option<Self> {
        let ratios: Vec<f64> = one.iter().zip(other).map(|(one, other)| one / other).collect();
        let interval = MedianInterval::of(&ratios)?;
        Some(Self { interval, pairs: ratios.len(), method: METHOD })
    }

    /// The interval in words: which is faster.
    pub fn verdict(&self) -> &'static str {
        match self.interval {
            i if i.confidence < 0.95 => "too few pairs of runs to say which is faster",
            i if i.low > 1.0 => "the wavefront is faster",
            i if i.high < 1.0 => "the recursive tracer is faster",
            _ => "the difference is within the noise",
        }
    }
}
