//! Both tracers timed against each other, in a stable JSON form.
//!
//! [`measure`] runs them and checks their images; [`crate::summary`] says what a median,
//! its interval and a spread are; [`advice`] says what is wrong with a measurement and what to do
//! about it; [`text`] writes it all for a terminal, and [`page`] as a page with charts. [`compare`] times the wavefront against itself,
//! and [`hardware`] asks the processor what it counted.
//!
//! | key | unit | meaning |
//! |---|---|---|
//! | `version`, `command` | | the program, and the arguments that it was given |
//! | `machine.processor`, `.cores`, `.threads`, `.os` | | its model (`null` where the system does not tell), the cores that the program may use, and the threads that it used |
//! | `machine.hardware_missing` | | why the processor counts nothing here, `null` where it does |
//! | `scenes` | | one entry a scene, in the order of the command line: |
//!
//! | key of a scene | unit | meaning |
//! |---|---|---|
//! | `scene`, `seed`, `batch`, `simd`, `kernel`, `precision` | | what was run |
//! | `image.width`, `.height`, `.samples_per_pixel` | pixels, rays | the image |
//! | `triangles`, `quads`, `spheres`, `lights`, `dropped.degenerate` | | what is in the scene, and what was left out |
//! | `preset` | | how the tree was built |
//! | `time.load`, `.build` | seconds | reading and preparing, and building the tree: done once |
//! | `memory.predicted`, `.peak` | bytes | estimated for a render; measured for the process so far, earlier scenes counted (`null` where the system does not tell) |
//! | `equal` | | whether every image was the same to the last bit, and all work but tests the same |
//! | `difference` | | how not, or `null`: see [`measure::Difference`] |
//! | `rays.primary`, `.secondary`, `.shadow` | rays | in one run, of either tracer |
//! | `invalid` | samples | not finite, and counted as black |
//! | `wavefront`, `recursive` | | one tracer's runs, or `null` where the images differ: |
//! | `.seconds.median`, `.min`, `.max`, `.first_quartile`, `.third_quartile`, `.mad`, `.each` | seconds | of a run on the clock; `each` in the order of the runs |
//! | `.mrays_s` | 10^6 rays / s | rays of every kind, by the median of the seconds |
//! | `.rays_s.primary`, `.secondary`, `.shadow` | rays / s | rays of that kind in the median of the seconds of the whole run |
//! | `.passes.NAME.seconds`, `.share` | seconds | median time in the pass, summed over threads, and its share in the sum of all passes |
//! | `.tests.nodes`, `.primitives` | tests | in one run, as in [`crate::statistics`] |
//! | `.tests_per_ray.nodes`, `.primitives` | tests / ray | the same for each ray of any kind |
//! | `.kernels` | | rays by kernel in one run, as in [`crate::statistics`] |
//! | `.hardware.cycles`, `.instructions`, `.cache_references`, `.cache_misses`, `.branch_misses` | | counted by the processor in a run of its own, all threads together; each `null`, or all of `.hardware`, where it does not count |
//! | `ratio.median`, `.low`, `.high`, `.confidence`, `.pairs`, `.method` | | how many times as fast as the recursive tracer the wavefront is: seconds of the recursive run over seconds of the wavefront's, pair by pair; `null` where the images differ |
//! | `comparisons` | | one entry for each thing that was to be compared, see [`compare::Comparison`]: |
//! | `.of`, `.rounds` | | `kernels`, `levels`, `batches` or `plan`; timed rounds, each of one run of every choice |
//! | `.variants` | | the usual choice, then the others: `kernel`, `simd`, `batch`, `planned`, all keys of `wavefront`, and `ratio`, how many times as fast as the usual choice it is, round by round; empty where images differ |
//! | `.difference` | | the choice whose image differs, and how, or `null` |
//! | `warnings` | | what to know before believing it |
//!
//! The `n`th of `wavefront.seconds.each` and the `n`th of `recursive.seconds.each` are a pair.

pub mod advice;
pub mod compare;
pub mod hardware;
pub mod measure;
pub mod page;
mod rows;
#[cfg(test)]
mod tests;
pub mod text;

use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::statistics::{ImageSize, KernelUse, Memory, Rays, Tests};
use crate::summary::{MedianInterval, Summary, median};
use compare::Comparison;
use hardware::HardwareCounts;
use measure::{Difference, Measured, Runs};
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::counters::Counters;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::prepared::{Dropped, PreparedScene};

/// See the module documentation: fields are named as in the JSON.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "the tables above say it once, for the JSON and for the fields")]
pub struct BenchReport {
    pub version: &'static str,
    pub command: Vec<String>,
    pub machine: Machine,
    pub scenes: Vec<SceneBench>,
}

/// What it was run on.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Machine {
    pub processor: Option<String>,
    pub cores: usize,
    pub threads: usize,
    pub os: String,
    pub hardware_missing: Option<String>,
}

/// What was measured of one scene.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
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
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Preparation {
    pub load: f64,
    pub build: f64,
}

/// What was measured of one tracer.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct TracerBench {
    pub seconds: Summary,
    pub mrays_s: f64,
    pub rays_s: RaysPerSecond,
    pub passes: Map<String, Value>,
    pub tests: Tests,
    pub tests_per_ray: TestsPerRay,
    pub kernels: KernelUse,
    pub hardware: Option<HardwareCounts>,
}

/// Rays by kind in the time of all.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct RaysPerSecond {
    pub primary: f64,
    pub secondary: f64,
    pub shadow: f64,
}

/// Tests of nodes and of primitives of every kind, for each ray of any kind.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct TestsPerRay {
    pub nodes: f64,
    pub primitives: f64,
}

/// Speed of the wavefront over that of the recursive tracer.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Ratio {
    #[serde(flatten)]
    pub interval: MedianInterval,
    pub pairs: usize,
    pub method: &'static str,
}

/// How the interval of the ratio comes about.
pub const METHOD: &str = "order statistics of paired ratios (Thompson 1936)";

/// What was run: everything that is known before the first ray.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The scene's file.
    pub scene: String,
    /// The seed of the random numbers.
    pub seed: u64,
    /// Paths in a batch of the wavefront.
    pub batch: usize,
    /// The vector instructions.
    pub simd: Level,
    /// How the wavefront's rays are taken through the tree.
    pub kernel: KernelChoice,
    /// How exactly hits are found.
    pub precision: Precision,
    /// How the tree was built.
    pub preset: Preset,
    /// How long it took to get there.
    pub time: Preparation,
    /// Memory estimated, in bytes.
    pub predicted: u64,
}

impl BenchReport {
    /// A report of no scene yet, by this program on this machine.
    pub fn new(command: Vec<String>) -> Self {
        let machine = Machine::this();
        Self { version: env!("CARGO_PKG_VERSION"), command, machine, scenes: Vec::new() }
    }

    /// Whether the tracers agreed in every scene, and all choices that were compared.
    pub fn equal(&self) -> bool {
        let agrees = |compared: &Comparison| compared.difference.is_none();
        self.scenes.iter().all(|scene| scene.equal && scene.comparisons.iter().all(agrees))
    }
}

impl Machine {
    /// The machine that this runs on, with the threads of the current pool.
    pub fn this() -> Self {
        Self {
            processor: std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|t| processor(&t)),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            threads: rayon::current_num_threads(),
            os: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            hardware_missing: hardware::missing(),
        }
    }
}

/// The processor's model in the text of `/proc/cpuinfo`, where there is one.
fn processor(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find_map(|line| line.strip_prefix("model name"))?;
    let name = line.split_once(':')?.1.trim();
    (!name.is_empty()).then(|| name.to_owned())
}

impl SceneBench {
    /// The report of what was `measured` of `scene`. `peak` is the memory measured, in bytes.
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
            time: setting.time,
            memory: Memory { predicted: setting.predicted, peak },
            equal,
            difference: measured.difference.clone(),
            rays: (&measured.counters).into(),
            invalid: measured.counters.invalid,
            wavefront: tracer(&measured.wavefront),
            recursive: tracer(&measured.recursive),
            ratio: if equal { Ratio::new(measured) } else { None },
            comparisons: Vec::new(),
            warnings: Vec::new(),
        };
        report.warnings = advice::warnings(&report);
        report
    }
}

impl TracerBench {
    /// What `runs` tell, each with the work that `counters` say; `None` if there is no run.
    fn new(runs: &Runs, counters: &Counters) -> Option<Self> {
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
    /// Of each pair of tracers, summed up; `None` if there is no pair.
    fn new(measured: &Measured) -> Option<Self> {
        Self::of(&measured.recursive.seconds, &measured.wavefront.seconds)
    }

    /// The seconds of one over those of another, run by run: how many times as fast the other is.
    pub(crate) fn of(one: &[f64], other: &[f64]) -> Option<Self> {
        let ratios: Vec<f64> = one.iter().zip(other).map(|(one, other)| one / other).collect();
        let interval = MedianInterval::of(&ratios)?;
        Some(Self { interval, pairs: ratios.len(), method: METHOD })
    }

    /// What the interval says of who is faster.
    pub fn verdict(&self) -> &'static str {
        match self.interval {
            i if i.confidence < 0.95 => "too few pairs to tell who is faster",
            i if i.low > 1.0 => "the wavefront is faster",
            i if i.high < 1.0 => "the recursive tracer is faster",
            _ => "neither is shown to be faster",
        }
    }
}
