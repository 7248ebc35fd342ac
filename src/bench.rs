//! `bench`: times both tracers, after checking that their images are equal, and variants of the
//! wavefront.

mod args;
mod effects;

use std::path::Path;
use std::time::Instant;

pub(crate) use args::BenchArgs;

use super::common::{Extent, SearchOptions, print, tell, to_json, warn, with_bar, write_text};
use wavecrest_base::error::Result;
use wavecrest_base::replace::{check_differs, check_replaceable};
use wavecrest_core::plan::Plan;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, TracerKind, render};
use wavecrest_report::bench::compare::{Axis, Comparison, Variant, compare};
use wavecrest_report::bench::measure::{Measured, Runs, measure};
use wavecrest_report::bench::page::page;
use wavecrest_report::bench::{BenchReport, Preparation, SceneBench, Setting, hardware, text};
use wavecrest_scene::load::load;
use wavecrest_scene::memory;
use wavecrest_scene::systems;

/// Measures every scene, prints the results, and returns whether all images were equal.
///
/// # Errors
/// If a scene cannot be loaded or prepared, or the report cannot be written.
pub(crate) fn run(args: &BenchArgs) -> Result<bool> {
    args.search.check(args.scene_options.precision)?;
    args.outputs().try_for_each(check_replaceable)?;
    if let (Some(output), Some(page)) = (&args.output, &args.page) {
        check_differs(page, output, "the JSON")?;
    }
    check_scenes(args)?;
    args.scene_options.threads.run(
        || {
            if args.effects { effects::run(args) } else { run_here(args) }
        },
    )
}

/// Refuses to write over a file of a scene. The results of the first scene are written before the second is read, so
/// all are read here if a file is there to be replaced.
fn check_scenes(args: &BenchArgs) -> Result<()> {
    let old: Vec<&Path> = args.outputs().filter(|file| file.exists()).collect();
    if old.is_empty() {
        return Ok(());
    }
    args.scenes.iter().try_for_each(|scene| {
        old.iter().try_for_each(|file| check_differs(file, scene, "the scene"))?;
        let loaded = load(scene, &args.scene_options.load_options())?;
        old.iter().try_for_each(|file| loaded.check_apart(file))
    })
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
    let (mut scene, setting) = prepare(args, path)?;
    let measured = measure_scene(args, &scene)?;
    let mut report = SceneBench::new(setting, &scene, &measured, memory::peak());
    if report.equal {
        for &axis in &args.compare {
            report.comparisons.push(compare_scene(args, &mut scene, axis)?);
        }
    }
    Ok(report)
}

fn prepare(args: &BenchArgs, path: &Path) -> Result<(PreparedScene, Setting)> {
    let start = Instant::now();
    let extent = Extent::whole(args.batch);
    let loaded = args.scene_options.load(path, extent, &[])?;
    let extracted = args.scene_options.extract(loaded, extent)?;
    // Neither tracer should wait for an image.
    extracted.scene().appearance.decode()?;
    let load = start.elapsed().as_secs_f64();
    let preset = args.scene_options.bvh.unwrap_or_else(|| extracted.preset());
    let batch = args.batch as usize;
    let predicted =
        memory::estimate_extracted(&extracted, extracted.pixels(), preset, batch).total();
    let start = Instant::now();
    let file = extracted.file().to_owned();
    let mut scene = args.scene_options.build(extracted, preset)?;
    let time = Preparation { load, build: start.elapsed().as_secs_f64() };
    warn(&systems::warnings(&scene, &file));
    args.search.apply(&mut scene.accel);
    let name = path.display().to_string();
    let SearchOptions { simd, kernel } = args.search;
    let seed = args.seed;
    let precision = args.scene_options.precision;
    let setting =
        Setting { scene: name, seed, batch, simd, kernel, precision, preset, time, predicted };
    Ok((scene, setting))
}

fn measure_scene(args: &BenchArgs, scene: &PreparedScene) -> Result<Measured> {
    // The bar moves only between pairs: nothing else runs while the tracers are timed.
    let trace = |tracer| render(scene, &args.options(tracer), &());
    let mut measured = with_bar(args.scene_options.quiet, &bar_of("pairs"), |progress| {
        measure(&args.schedule(), trace, progress)
    })?;
    if measured.difference.is_none() && hardware::missing().is_none() {
        count(&mut measured.wavefront, || trace(TracerKind::Wavefront))?;
        count(&mut measured.recursive, || trace(TracerKind::Recursive))?;
    }
    Ok(measured)
}

/// The template of a bar that counts these items.
fn bar_of(what: &str) -> String {
    format!("{{wide_bar}} {{pos}} of {{len}} {what}, {{eta}} left")
}

/// Counts hardware events in a separate run, so that counting does not slow timed runs.
fn count(runs: &mut Runs, run: impl FnOnce() -> Result<Rendered>) -> Result<()> {
    let (rendered, counted) = hardware::count(run);
    rendered?;
    runs.hardware = counted.ok();
    Ok(())
}

fn compare_scene(args: &BenchArgs, scene: &mut PreparedScene, axis: Axis) -> Result<Comparison> {
    let SearchOptions { simd, kernel } = args.search;
    let usual = Variant { kernel, simd, batch: args.batch as usize, planned: true };
    let planned = scene.plan.clone();
    let unplanned = Plan::of(planned.decisions().to_vec(), &unplanned(&PASSES));
    let trace = |variant: &Variant| {
        SearchOptions { simd: variant.simd, kernel: variant.kernel }.apply(&mut scene.accel);
        scene.plan.clone_from(if variant.planned { &planned } else { &unplanned });
        let options = RenderOptions { batch: variant.batch, ..args.options(TracerKind::Wavefront) };
        render(scene, &options, &())
    };
    let compared = with_bar(args.scene_options.quiet, &bar_of("rounds"), |progress| {
        compare(axis, &axis.variants(usual), &args.schedule(), trace, progress)
    });
    args.search.apply(&mut scene.accel);
    scene.plan = planned;
    compared
}

fn tell_scene(args: &BenchArgs, scene: &SceneBench) -> Result<()> {
    if !args.json {
        print(&format!("\n{}", text::scene(scene)))?;
    }
    if let Some(difference) = &scene.difference {
        // Even if quiet: a wrong image must not go unnoticed.
        tell(&format!("error: {}: {}", scene.scene, text::verdict(difference)));
    }
    for compared in scene.comparisons.iter().filter(|compared| compared.difference.is_some()) {
        tell(&format!("error: {}: {}", scene.scene, text::comparison(compared).trim()));
    }
    let name = &scene.scene;
    scene.warnings.iter().for_each(|warning| tell(&format!("warning: {name}: {warning}")));
    Ok(())
}

fn export(args: &BenchArgs, report: &BenchReport) -> Result<()> {
    if let Some(file) = &args.page {
        page(report).write(file)?;
    }
    let Some(file) = &args.output else { return Ok(()) };
    let json = to_json(report)?;
    write_text(file, &json)
}

#[cfg(test)]
mod tests {
    use super::args::tests::parse;
    use super::*;

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

        let page = folder.path().join("page.html");
        let p = page.display();
        let args = parse(&format!("{s} -q --min-time 0 --repeats 2 --page {p}")).unwrap();
        assert!(run(&args).unwrap());
        let html = std::fs::read_to_string(&page).unwrap();
        assert!(
            html.starts_with("<!doctype html>") && html.contains("Wavefront against recursive")
        );
        let args = parse(&format!("{s} -q -o {p} --page {p}")).unwrap();
        let error = run(&args).unwrap_err().to_string();
        assert!(error.contains("this file is also the JSON"), "{error}");
        assert_eq!(std::fs::read_to_string(&page).unwrap(), html, "it is as it was");
    }
}
