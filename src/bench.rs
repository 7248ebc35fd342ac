//! `bench`: times both tracers and the steps between them, after checking that all images are
//! equal.

mod args;
mod effects;

use std::path::Path;
use std::time::Instant;

pub(crate) use args::BenchArgs;

use super::common::{Extent, SearchOptions, print, tell, to_json, warn, with_bar, write_text};
use wavecrest_base::error::Result;
use wavecrest_base::replace::{check_differs, check_replaceable};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_report::bench::page::{machine, overview, page, scene, write_figures};
use wavecrest_report::bench::{BenchReport, Preparation, SceneBench, Setting};
use wavecrest_report::page::Block;
use wavecrest_report::text::text;
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
        print(&text(&[Block::Facts(machine(&report.machine))]))?;
    }
    let outcome = args.scenes.iter().try_for_each(|path| {
        let scene = bench(args, path)?;
        tell_scene(args, &report, &scene)?;
        report.scenes.push(scene);
        // After every scene, so that nothing is lost if the next one fails.
        export(args, &report)
    });
    if args.json {
        print(&to_json(&report)?)?;
    } else if report.scenes.len() > 1 {
        print(&text(&overview(&report.scenes)))?;
    }
    outcome.map(|()| report.equal())
}

/// Prepares a scene once, and measures it.
fn bench(args: &BenchArgs, path: &Path) -> Result<SceneBench> {
    let (mut scene, setting) = prepare(args, path)?;
    // The bar moves only between rounds: nothing else runs while they are timed.
    with_bar(args.scene_options.quiet, ROUNDS, |progress| {
        SceneBench::measure(&mut scene, setting, &args.plan(), progress)
    })
}

/// The bar of rounds.
const ROUNDS: &str = "{wide_bar} {pos} of {len} rounds, {eta} left";

fn prepare(args: &BenchArgs, path: &Path) -> Result<(PreparedScene, Setting)> {
    let start = Instant::now();
    let extent = &Extent::whole(args.batch);
    let loaded = args.scene_options.load(path, extent, &[])?;
    let extracted = args.scene_options.extract(loaded, extent)?;
    // Neither tracer should wait for an image.
    extracted.scene().appearance.decode()?;
    let load = start.elapsed().as_secs_f64();
    let preset = args.scene_options.bvh.unwrap_or_else(|| extracted.preset().at_once());
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

fn tell_scene(args: &BenchArgs, report: &BenchReport, found: &SceneBench) -> Result<()> {
    let name = &found.setting.scene;
    if !args.json {
        // Warnings go to standard error.
        let mut blocks = scene(found, &report.machine);
        blocks.retain(|block| !matches!(block, Block::Warning(_)));
        print(&format!("\n{name}\n{}", text(&blocks)))?;
    }
    // Even if quiet: a wrong image must not go unnoticed.
    for different in found.comparisons.iter().filter_map(|compared| compared.difference.as_ref()) {
        tell(&format!("error: {name}: {}", different.words()));
    }
    found.warnings.iter().for_each(|warning| tell(&format!("warning: {name}: {warning}")));
    Ok(())
}

fn export(args: &BenchArgs, report: &BenchReport) -> Result<()> {
    if args.page.is_some() || args.charts.is_some() {
        let page = page(report);
        args.page.iter().try_for_each(|file| page.write(file))?;
        args.charts.iter().try_for_each(|folder| write_figures(&page, folder))?;
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
        let output = folder.path().join("out.json");
        let (s, o) = ("crates/report/src/bench/tests/ball.json", output.display());
        let args = parse(&format!("{s} {s} -q --min-time 0 --threads 2 -o {o}")).unwrap();
        assert!(run(&args).unwrap());
        let text = std::fs::read_to_string(&output).unwrap();
        let written: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(written["machine"]["threads"], 2);
        assert_eq!(written["scenes"].as_array().unwrap().len(), 2);
        assert_eq!(written["scenes"][1]["equal"], true);
        assert_eq!(written["scenes"][1]["comparisons"][0]["rounds"], 6);

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
