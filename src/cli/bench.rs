//! `bench`: both tracers timed against each other, once their images are known to be the same.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::common::{SceneOptions, print, progress_bar, tell, to_json};
use crate::error::Result;
use crate::memory;
use crate::prepared::PreparedScene;
use crate::render::{RenderOptions, TracerKind, render};
use crate::replace::{check_replaceable, replace_file, write_error};
use crate::report::bench::measure::{Measured, Schedule, measure};
use crate::report::bench::{BenchReport, Preparation, SceneBench, Setting, text};
use crate::systems;
use crate::wavefront::DEFAULT_BATCH;

/// Times both tracers on each scene, after checking that their images are the same bit for bit.
///
/// The answer is no (exit code 1) where they are not.
#[derive(Clone, Debug, clap::Args)]
pub struct BenchArgs {
    /// The scenes, in JSON
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// Timed pairs of runs at most; fewer where --min-time is reached, but then at least 6
    #[arg(long, value_name = "N", default_value_t = 50,
          value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub repeats: u16,
    /// Pairs of runs before the first that is timed
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub warmup: u16,
    /// Time that each tracer is to run for in all, as far as --repeats allows
    #[arg(long, value_name = "SECONDS", default_value = "1", value_parser = seconds)]
    pub min_time: f64,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Write the JSON to a file, after every scene
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Paths in a batch of the wavefront
    #[arg(long, value_name = "PATHS", default_value_t = DEFAULT_BATCH as u32,
          value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub batch: u32,
    /// Choose other random numbers
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// What is read and how
    #[command(flatten)]
    pub scene_options: SceneOptions,
}

impl BenchArgs {
    fn schedule(&self) -> Schedule {
        let (warmup, most) = (usize::from(self.warmup), usize::from(self.repeats));
        Schedule { warmup, most, seconds: self.min_time }
    }

    fn options(&self, tracer: TracerKind) -> RenderOptions {
        RenderOptions { tracer, crop: None, seed: self.seed, batch: self.batch as usize }
    }
}

/// Measures every scene, tells what was found, and returns whether the tracers agreed in all.
///
/// # Errors
/// When a scene cannot be loaded or prepared, or the report cannot be written.
pub fn run(args: &BenchArgs) -> Result<bool> {
    if let Some(output) = &args.output {
        check_replaceable(output)?;
    }
    args.scene_options.threads.run(|| run_here(args))
}

fn run_here(args: &BenchArgs) -> Result<bool> {
    let command = std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned());
    let mut report = BenchReport::new(command.collect());
    if !args.json {
        print(&text::machine(&report.machine))?;
    }
    let outcome = args.scenes.iter().try_for_each(|path| {
        let scene = bench(args, path)?;
        tell_scene(args, &scene)?;
        report.scenes.push(scene);
        // After every scene, so that nothing is lost if the next one fails.
        export(args, &report)
    });
    if args.json {
        print(&to_json(&report)?)?;
    } else if report.scenes.len() > 1 {
        print(&format!("\n{}", text::summary(&report.scenes)))?;
    }
    outcome.map(|()| report.equal())
}

/// Prepares a scene once and runs both tracers on it.
fn bench(args: &BenchArgs, path: &Path) -> Result<SceneBench> {
    let (scene, setting) = prepare(args, path)?;
    let measured = measure_scene(args, &scene)?;
    Ok(SceneBench::new(setting, &scene, &measured, memory::peak()))
}

fn prepare(args: &BenchArgs, path: &Path) -> Result<(PreparedScene, Setting)> {
    let start = Instant::now();
    let mut loaded = args.scene_options.load(path)?;
    let extracted = systems::extract(&mut loaded.world)?;
    drop(loaded);
    args.scene_options.warn(&extracted.warnings);
    let load = start.elapsed().as_secs_f64();
    let preset = args.scene_options.bvh.unwrap_or_else(|| extracted.preset());
    let batch = args.batch as usize;
    let predicted = memory::predict(&extracted, extracted.pixels(), preset, batch).total();
    let start = Instant::now();
    let scene = extracted.build(preset);
    let time = Preparation { load, build: start.elapsed().as_secs_f64() };
    let name = path.display().to_string();
    Ok((scene, Setting { scene: name, seed: args.seed, batch, preset, time, predicted }))
}

fn measure_scene(args: &BenchArgs, scene: &PreparedScene) -> Result<Measured> {
    let bar = progress_bar(args.scene_options.quiet, "{wide_bar} {pos} of {len} pairs, {eta} left");
    // The bar moves between pairs alone: nothing but the tracers is at work while they are timed.
    let trace = |tracer| render(scene, &args.options(tracer), &|_, _| {});
    let measured = measure(&args.schedule(), trace, &mut |done, planned| {
        bar.set_length(planned as u64);
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    measured
}

fn tell_scene(args: &BenchArgs, scene: &SceneBench) -> Result<()> {
    if !args.json {
        print(&format!("\n{}", text::scene(scene)))?;
    }
    if let Some(difference) = &scene.difference {
        // However quiet: a wrong image is never passed over in silence.
        tell(&format!("error: {}: {}", scene.scene, text::verdict(difference)));
    }
    if !args.scene_options.quiet {
        let name = &scene.scene;
        scene.warnings.iter().for_each(|warning| tell(&format!("warning: {name}: {warning}")));
    }
    Ok(())
}

fn export(args: &BenchArgs, report: &BenchReport) -> Result<()> {
    let Some(file) = &args.output else { return Ok(()) };
    let json = to_json(report)?;
    write_text(file, &json)
}

fn write_text(file: &Path, text: &str) -> Result<()> {
    replace_file(file, |sink| sink.write_all(text.as_bytes()).map_err(|e| write_error(file, e)))
}

/// A number of seconds, 0 or more.
fn seconds(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("use a number of seconds, such as 2.5".into()),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Whole {
        #[command(flatten)]
        args: BenchArgs,
    }

    fn parse(line: &str) -> std::result::Result<BenchArgs, clap::Error> {
        Whole::try_parse_from(std::iter::once("bench").chain(line.split_whitespace()))
            .map(|whole| whole.args)
    }

    #[test]
    fn scenes_and_options_are_read() {
        let args = parse("a.json b.json --repeats 3 --min-time 0.5 -o out.json -q").unwrap();
        assert_eq!(args.scenes, ["a.json", "b.json"].map(PathBuf::from));
        assert_eq!(args.schedule(), Schedule { warmup: 1, most: 3, seconds: 0.5 });
        for bad in ["", "a --repeats 0", "a --warmup 0", "a --min-time=-1", "a --min-time nan"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn scenes_are_measured_and_written_as_json() {
        let folder = tempfile::tempdir().unwrap();
        let (scene, output) = (folder.path().join("s.json"), folder.path().join("out.json"));
        let json = r#"{
            "nbounces": 0,
            "camera": {"type": "pinhole", "width": 8, "height": 8, "fov": 60,
                       "location": [0, 0, 5], "look": [0, 0, 0]},
            "scene": {"backgroundcolor": [0.5, 0, 0], "lightsources": [], "shapes": []}
        }"#;
        std::fs::write(&scene, json).unwrap();
        let (s, o) = (scene.display(), output.display());
        let args = parse(&format!("{s} {s} -q --min-time 0 --threads 2 -o {o}")).unwrap();
        assert!(run(&args).unwrap());
        let text = std::fs::read_to_string(&output).unwrap();
        let written: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(written["machine"]["threads"], 2);
        assert_eq!(written["scenes"].as_array().unwrap().len(), 2);
        assert_eq!(written["scenes"][1]["equal"], true);
        assert_eq!(written["scenes"][1]["ratio"]["pairs"], 6);
        assert_eq!(written["scenes"][1]["rays"]["primary"], 64);
    }
}
