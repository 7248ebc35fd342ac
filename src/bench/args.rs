//! The arguments of `bench`.

use std::path::{Path, PathBuf};

use crate::choice::choice;
use crate::common::{SceneOptions, SearchOptions, number, whole};
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_report::bench::Plan;
use wavecrest_report::bench::variant::{Axis, BATCHES};
use wavecrest_report::measure::Schedule;

/// Time both tracers and the steps between them on each scene, after checking that all images are identical.
///
/// The exit code is 1 if images differ. With `--effects`, measure instead what each effect costs, on
/// built-in scenes that add one effect at a time.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct BenchArgs {
    /// Scenes (.json, .gltf, .glb) or meshes (.ply, .obj, .stl)
    #[arg(required_unless_present = "effects", value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,
    /// Measure what each effect costs in time and memory
    #[arg(long, conflicts_with_all = ["scenes", "compare"])]
    pub(crate) effects: bool,
    /// Greatest number of timed rounds; fewer if --min-time is reached, but at least 6
    #[arg(long, value_name = "N", default_value_t = 50,
          value_parser = whole(1..=10_000_u16))]
    pub(crate) repeats: u16,
    /// Untimed rounds at the start
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = whole(1..=10_000_u16))]
    pub(crate) warmup: u16,
    /// Least total time of the runs of each variant, up to --repeats rounds
    #[arg(long, value_name = "SECONDS", default_value = "1", value_parser = seconds)]
    pub(crate) min_time: f64,
    /// Also compare the wavefront tracer across kernels, the steps to it across instruction sets, batch sizes,
    /// both tracers across threads, or with every pass forced on (plan); comma-separated
    #[arg(long, value_name = "WHAT", value_parser = choice::<Axis>(), value_delimiter = ',')]
    pub(crate) compare: Vec<Axis>,
    /// Compare these batch sizes, such as 16,64,1024,65536
    #[arg(long, value_name = "PATHS", value_parser = whole(1..=1_u32 << 20), value_delimiter = ',',
          conflicts_with = "effects")]
    pub(crate) batches: Vec<u32>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Write JSON to this file, updated after every scene
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Write an HTML page with charts, updated after every scene
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Write each chart of the page to this folder, as SVG and CSV
    #[arg(long, value_name = "FOLDER", conflicts_with = "effects")]
    pub(crate) charts: Option<PathBuf>,
    /// Paths in a batch of the wavefront tracer
    #[arg(long, value_name = "PATHS", default_value_t = DEFAULT_BATCH as u32,
          value_parser = whole(1..=1_u32 << 20))]
    pub(crate) batch: u32,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole(0..=u64::MAX))]
    pub(crate) seed: u64,
    /// Traversal
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// Scene
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

impl BenchArgs {
    /// The files to write.
    pub(super) fn outputs(&self) -> impl Iterator<Item = &Path> {
        self.output.iter().chain(&self.page).map(PathBuf::as_path)
    }

    /// Number and duration of timed rounds.
    pub(super) fn schedule(&self) -> Schedule {
        let (warmup, most) = (usize::from(self.warmup), usize::from(self.repeats));
        Schedule { warmup, most, seconds: self.min_time }
    }

    /// What to compare.
    pub(super) fn plan(&self) -> Plan {
        let mut axes = self.compare.clone();
        let named: Vec<usize> = self.batches.iter().map(|paths| *paths as usize).collect();
        if !named.is_empty() && !axes.contains(&Axis::Batches) {
            axes.push(Axis::Batches);
        }
        let batches = if named.is_empty() { BATCHES.to_vec() } else { named };
        Plan { axes, batches, schedule: self.schedule() }
    }

    /// The render options with `tracer`.
    pub(super) fn options(&self, tracer: TracerKind) -> RenderOptions {
        let (seed, batch) = (self.seed, self.batch as usize);
        RenderOptions { tracer, seed, batch, ..Default::default() }
    }
}

/// A number of seconds, 0 or more.
fn seconds(text: &str) -> std::result::Result<f64, String> {
    let fits = |value: &f64| value.is_finite() && *value >= 0.0;
    number(text, fits, "use a number of seconds, such as 2.5")
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::bench) fn parse(line: &str) -> std::result::Result<BenchArgs, clap::Error> {
        crate::common::parse(line)
    }

    #[test]
    fn scenes_and_options_are_read() {
        let args = parse("a.json b.json --repeats 3 --min-time 0.5 -o out.json -q").unwrap();
        assert_eq!(args.compare, []);
        assert_eq!((args.plan().axes, args.plan().batches), (Vec::new(), BATCHES.to_vec()));
        let compared = parse("a --compare kernels,batches --compare levels").unwrap().compare;
        assert_eq!(compared, [Axis::Kernels, Axis::Batches, Axis::Levels]);
        let plan = parse("a --compare threads --batches 16,65536").unwrap().plan();
        assert_eq!(plan.axes, [Axis::Threads, Axis::Batches]);
        assert_eq!(plan.batches, [16, 65536]);
        assert_eq!(args.scenes, ["a.json", "b.json"].map(PathBuf::from));
        assert_eq!(args.schedule(), Schedule { warmup: 1, most: 3, seconds: 0.5 });
        for bad in [
            "",
            "a --repeats 0",
            "a --warmup 0",
            "a --min-time=-1",
            "a --min-time nan",
            "a --compare trees",
            "a --batches 0",
            "a --batches 2097152",
        ] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}
