//! The results of a benchmark, as written in JSON.

use serde::Serialize;

use super::advice;
use super::compare::Comparison;
use super::machine::Machine;
use super::measure::{Difference, Measured};
use super::tracer::{Ratio, TracerBench};
use crate::statistics::{ImageSize, Memory, Rays};
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::tree::{Tree, Visits};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::prepared::{Dropped, PreparedScene};

/// See [`crate::bench`]: fields have the names of the JSON.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "the tables above say it once, for the JSON and for the fields")]
pub struct BenchReport {
    pub version: &'static str,
    pub command: Vec<String>,
    pub commit: Option<String>,
    pub machine: Machine,
    pub scenes: Vec<SceneBench>,
}

/// The results of one scene.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
pub struct SceneBench {
    pub scene: String,
    pub seed: u64,
    pub batch: usize,
    pub simd: Level,
    pub kernel: KernelChoice,
    pub precision: Precision,
    pub image: ImageSize,
    pub triangles: usize,
    pub quads: usize,
    pub spheres: usize,
    pub lights: usize,
    pub dropped: Dropped,
    pub preset: Preset,
    pub expected_visits: Visits,
    pub time: Preparation,
    pub memory: Memory,
    pub equal: bool,
    pub difference: Option<Difference>,
    pub rays: Rays,
    pub invalid: u64,
    pub wavefront: Option<TracerBench>,
    pub recursive: Option<TracerBench>,
    pub ratio: Option<Ratio>,
    pub comparisons: Vec<Comparison>,
    pub warnings: Vec<String>,
}

/// Seconds before the first ray.
#[derive(Clone, Copy, Debug, Default, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
pub struct Preparation {
    pub load: f64,
    pub build: f64,
}

/// The settings: everything known before the first ray.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The scene's file.
    pub scene: String,
    /// The seed of the random numbers.
    pub seed: u64,
    /// Paths in a batch of the wavefront.
    pub batch: usize,
    /// Instruction sets.
    pub simd: Level,
    /// The kernel of the wavefront's rays.
    pub kernel: KernelChoice,
    /// The precision of hits.
    pub precision: Precision,
    /// The BVH preset.
    pub preset: Preset,
    /// The time of the preparation.
    pub time: Preparation,
    /// Estimated memory in bytes.
    pub predicted: u64,
}

impl BenchReport {
    /// An empty report by this program on this machine.
    pub fn new(command: Vec<String>) -> Self {
        let (machine, commit) = (Machine::this(), crate::accuracy::commit());
        Self { version: env!("CARGO_PKG_VERSION"), command, commit, machine, scenes: Vec::new() }
    }

    /// Whether the tracers and all variants agree in every scene.
    pub fn equal(&self) -> bool {
        let agrees = |compared: &Comparison| compared.difference.is_none();
        self.scenes.iter().all(|scene| scene.equal && scene.comparisons.iter().all(agrees))
    }
}

impl SceneBench {
    /// The report of a `measured` `scene`. `peak` is the measured memory in bytes.
    pub fn new(
        setting: Setting,
        scene: &PreparedScene,
        measured: &Measured,
        peak: Option<u64>,
    ) -> Self {
        let equal = measured.difference.is_none();
        let tracer = |runs| if equal { TracerBench::new(runs, &measured.counters) } else { None };
        let [width, height] = scene.camera.size();
        let geometry = scene.accel.geometry();
        let mut report = Self {
            scene: setting.scene,
            seed: setting.seed,
            batch: setting.batch,
            simd: setting.simd,
            kernel: setting.kernel,
            precision: setting.precision,
            image: ImageSize { width, height, samples_per_pixel: scene.camera.rays_per_pixel() },
            triangles: geometry.triangles.len(),
            quads: geometry.quads.len(),
            spheres: geometry.spheres.len(),
            lights: scene.lights.len(),
            dropped: scene.dropped,
            preset: setting.preset,
            expected_visits: scene.accel.tree().map(Tree::expected_visits).unwrap_or_default(),
            time: setting.time,
            memory: Memory { predicted: setting.predicted, peak },
            equal,
            difference: measured.difference.clone(),
            rays: (&measured.counters).into(),
            invalid: measured.counters.invalid,
            wavefront: tracer(&measured.wavefront),
            recursive: tracer(&measured.recursive),
            ratio: if equal { ratio(measured) } else { None },
            comparisons: Vec::new(),
            warnings: Vec::new(),
        };
        let tracers = [&report.wavefront, &report.recursive].map(Option::as_ref);
        report.warnings = advice::warnings(report.invalid, tracers, report.ratio.as_ref());
        report
    }
}

/// The recursive tracer's seconds over the wavefront's, pair by pair; `None` if there is no pair.
fn ratio(measured: &Measured) -> Option<Ratio> {
    Ratio::of(&measured.recursive.seconds, &measured.wavefront.seconds)
}
