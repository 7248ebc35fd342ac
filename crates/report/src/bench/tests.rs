//! The report's form, its text and its warnings.

use std::path::Path;

use serde_json::Value;

use super::compare::{Axis, Variant, compare};
use super::hardware::HardwareCounts;
use super::measure::{Schedule, measure};
use super::page::page;
use super::*;
use crate::bench::machine::processor;
use crate::page::{Block, Page, Section};
use crate::plot::{Chart, StackedBars};
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, TracerKind, render};
use wavecrest_scene::load::load_str;
use wavecrest_scene::systems;

/// A red ball under a point light.
const SCENE: &str = include_str!("tests/ball.json");

pub(super) fn prepared() -> PreparedScene {
    let mut loaded = load_str(SCENE, Path::new("ball.json"), &Default::default()).unwrap();
    systems::extract(&mut loaded.world, Default::default()).unwrap().build(Preset::Fast)
}

fn setting(name: &str) -> Setting {
    Setting {
        scene: name.to_owned(),
        seed: 3,
        batch: 64,
        simd: Level::best(),
        kernel: KernelChoice::Auto,
        precision: Precision::Exact,
        preset: Preset::Fast,
        time: Preparation { load: 0.5, build: 0.25 },
        predicted: 1000,
    }
}

/// A report whose runs take the `seconds` given, tracer after tracer as they run.
fn report(pairs: usize, mut seconds: impl FnMut(TracerKind, usize) -> f64) -> SceneBench {
    let scene = prepared();
    let mut runs = [0, 0];
    let trace = |tracer| -> Result<Rendered> {
        let options = RenderOptions { tracer, batch: 64, seed: 3, ..Default::default() };
        let run = &mut runs[usize::from(tracer == TracerKind::Recursive)];
        *run += 1;
        Ok(Rendered { seconds: seconds(tracer, *run), ..render(&scene, &options, &())? })
    };
    let schedule = Schedule { warmup: 1, most: pairs, seconds: 0.0 };
    let measured = measure(&schedule, trace, &mut |_, _| {}).unwrap();
    SceneBench::new(setting("ball.json"), &scene, &measured, Some(2000))
}

/// The wavefront takes 0.1 s and the recursive tracer 0.125 s.
fn steady() -> SceneBench {
    report(6, |tracer, _| if tracer == TracerKind::Wavefront { 0.1 } else { 0.125 })
}

/// A report of tracers that disagree.
fn different() -> SceneBench {
    let scene = prepared();
    let trace = |tracer| {
        let mut run = render(&scene, &RenderOptions { tracer, ..Default::default() }, &())?;
        if tracer == TracerKind::Recursive {
            run.film.pixel_mut(5, 2).unwrap()[1] = 0.5;
        }
        Ok(run)
    };
    let schedule = Schedule { warmup: 1, most: 6, seconds: 0.0 };
    let measured = measure(&schedule, trace, &mut |_, _| {}).unwrap();
    SceneBench::new(setting("b.json"), &scene, &measured, None)
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn the_json_has_the_documented_keys() {
    let mut report = BenchReport::new(vec!["bench".to_owned()]);
    report.scenes.push(steady());
    assert!(report.equal());
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(keys(&json), ["version", "command", "commit", "machine", "scenes"]);
    assert_eq!(keys(&json["machine"]), ["processor", "cores", "threads", "os", "hardware_missing"]);
    let scene = &json["scenes"][0];
    assert_eq!(
        keys(scene).join(" "),
        "scene seed batch simd kernel precision image triangles quads spheres lights dropped preset expected_visits time \
         memory equal difference rays invalid wavefront recursive ratio comparisons warnings"
    );
    assert_eq!((scene["equal"].clone(), scene["difference"].clone()), (true.into(), Value::Null));
    let wavefront = &scene["wavefront"];
    assert_eq!(
        keys(wavefront),
        [
            "seconds",
            "yardstick",
            "mrays_s",
            "rays_s",
            "passes",
            "tests",
            "tests_per_ray",
            "kernels",
            "hardware"
        ]
    );
    assert_eq!(
        keys(&wavefront["seconds"]),
        ["median", "min", "max", "first_quartile", "third_quartile", "mad", "each"]
    );
    assert_eq!(keys(&wavefront["passes"]), wavecrest_core::tile::TIMED);
    assert_eq!(keys(&scene["recursive"]["passes"]), ["recursive"]);
    let ratio = &scene["ratio"];
    assert_eq!(keys(ratio), ["median", "low", "high", "confidence", "pairs", "method"]);
}

#[test]
fn rates_are_work_over_the_median() {
    let scene = steady();
    let (wavefront, recursive) = (scene.wavefront.unwrap(), scene.recursive.unwrap());
    assert_eq!((scene.rays.primary, scene.rays.secondary), (24 * 16, 0));
    assert!(scene.rays.shadow > 0);
    assert_eq!(wavefront.rays_s.primary, 24.0 * 16.0 / 0.1);
    assert_eq!(recursive.mrays_s, scene.rays.all() as f64 / 0.125 / 1e6);
    assert_eq!(wavefront.tests_per_ray.nodes, 0.0, "one sphere needs no inner node");
    assert!(wavefront.tests_per_ray.primitives > 0.0);
    let ratio = scene.ratio.unwrap();
    assert_eq!((ratio.interval.low, ratio.interval.high, ratio.pairs), (1.25, 1.25, 6));
    assert_eq!(ratio.verdict(), "the wavefront is faster");
    let shares = wavefront.passes.values().map(|pass| pass["share"].as_f64().unwrap());
    assert!((shares.sum::<f64>() - 1.0).abs() < 1e-9);
}

#[test]
fn tracers_that_disagree_have_no_times() {
    let scene = different();
    let text = text::scene(&scene);
    assert!(text.contains("THE IMAGES DIFFER"), "{text}");
    assert!(text.contains("a Recursive run") && text.contains("column 5, row 2"), "{text}");
    assert!(text.contains("0.5") && text.contains("3f000000"), "{text}");
    let json = serde_json::to_value(&scene).unwrap();
    assert_eq!(json["equal"], false);
    assert_eq!(json["difference"]["what"], "pixel");
    assert_eq!(json["difference"]["tracer"], "recursive");
    assert_eq!(json["difference"]["x"], 5);
    for key in ["wavefront", "recursive", "ratio"] {
        assert!(json[key].is_null(), "{key}");
    }
    let mut report = BenchReport::new(Vec::new());
    report.scenes = vec![steady(), scene];
    assert!(!report.equal());
    assert!(text::summary(&report.scenes).contains("THE TRACERS DISAGREE"));
}

#[test]
fn the_text_has_work_beside_time() {
    let text = text::scene(&steady());
    for part in [
        "24 x 16 pixels, 1 camera ray per pixel\n",
        "1 sphere, 1 light\n",
        "loaded in 0.500 s, BVH (fast) built in 0.250 s",
        "6 pairs of runs, all images bit-identical",
        "  median                       100.000     125.000  ms\n",
        "Mrays/s",
        "intersect",
        "1.250 (1.250 to 1.250 with 96.9 % confidence, 6 pairs of runs); the wavefront is faster",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert!(!text.contains("secondary rays"), "no row for what the scene has not:\n{text}");
    assert!(text.lines().all(|line| line.len() <= 100), "{text}");
}

#[test]
fn warnings_say_what_to_do() {
    let said = |report: &SceneBench, words: &str| {
        report.warnings.iter().filter(|warning| warning.contains(words)).count()
    };
    let quiet = steady();
    for words in ["--warmup", "close other programs", "--repeats", "--width"] {
        assert_eq!(said(&quiet, words), 0, "{words}");
    }
    // The first timed run is each tracer's second.
    let slow = report(8, |_, run| if run == 2 { 0.3 } else { 0.1 });
    assert_eq!(said(&slow, "took 3.00 times the median"), 2);
    let wide = report(8, |_, run| 0.1 + 0.01 * run as f64);
    assert_eq!((said(&wide, "close other programs"), said(&wide, "--warmup")), (2, 0));
    assert_eq!(said(&report(2, |_, _| 0.1), "2 pairs of runs cannot give 95 % confidence"), 1);
    assert_eq!(said(&report(6, |_, _| 0.001), "takes 1.00 ms"), 2);
}

#[test]
fn the_processor_is_found_where_it_is_named() {
    let text = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\nmodel name\t: other\n";
    assert_eq!(processor(text).as_deref(), Some("Some CPU @ 2 GHz"));
    assert_eq!(processor("model name\t:\n"), None);
    assert_eq!(processor("CPU part : 0xd40\n"), None);
}

/// The report of these scenes.
fn report_of(scenes: Vec<SceneBench>) -> BenchReport {
    BenchReport { scenes, ..BenchReport::new(vec!["bench".to_owned(), "a scene.json".to_owned()]) }
}

fn section<'a>(page: &'a Page, title: &str) -> &'a Section {
    let found = page.sections.iter().find(|section| section.title == title);
    found.unwrap_or_else(|| panic!("no section {title}"))
}

fn charts(section: &Section) -> Vec<&Chart> {
    let blocks = section.blocks.iter();
    blocks
        .filter_map(|block| if let Block::Chart(found) = block { Some(found) } else { None })
        .collect()
}

fn bars(section: &Section) -> Vec<&StackedBars> {
    let blocks = section.blocks.iter();
    blocks
        .filter_map(|block| if let Block::Bars(found) = block { Some(found) } else { None })
        .collect()
}

#[test]
fn the_page_begins_with_the_ratio() {
    let page = page(&report_of(vec![steady()]));
    assert_eq!(
        page.lead,
        "The wavefront is 1.250 times as fast as the recursive tracer (1.250 to 1.250 with 96.9\u{a0}% \
         confidence, 6 pairs of runs): the wavefront is faster. All images are bit-identical."
    );
}

#[test]
fn the_page_has_the_figures_of_the_report() {
    let report = report_of(vec![steady()]);
    let scene = &report.scenes[0];
    let (wavefront, recursive) =
        (scene.wavefront.as_ref().unwrap(), scene.recursive.as_ref().unwrap());
    let page = page(&report);
    let [ratio, rates] = charts(section(&page, "Speed"))[..] else { panic!("two charts") };
    let point = &ratio.series[0].points[0];
    let interval = scene.ratio.unwrap().interval;
    assert_eq!(
        (point.y, point.low, point.high),
        (interval.median, Some(interval.low), Some(interval.high))
    );
    let drawn: Vec<f64> = rates.series.iter().flat_map(|s| s.points.iter().map(|p| p.y)).collect();
    let rate = |tracer: &TracerBench| [tracer.rays_s.primary / 1e6, tracer.rays_s.shadow / 1e6];
    assert_eq!(drawn, [rate(wavefront), rate(recursive)].concat(), "no row for rays that are none");

    let own = section(&page, "`ball.json`");
    let passes = bars(own)[0];
    let stages: Vec<_> = passes.bars[0].segments.iter().map(|s| s.stage.as_str()).collect();
    assert_eq!(stages, ["generate", "intersect", "shade", "shadow", "resolve"]);
    let seconds = wavefront.passes["intersect"]["seconds"].as_f64().unwrap();
    assert_eq!(passes.bars[0].segments[1].seconds, seconds);
    let runs = charts(own)[0];
    assert_eq!(runs.y.unit, "ms");
    let each: Vec<f64> = runs.series[1].points.iter().map(|point| point.y).collect();
    assert_eq!(each, [125.0; 6]);
    let html = page.html().unwrap();
    for words in [
        "<td class=\"right\" data-value=\"125\">125.000</td>",
        "wavecrest bench &#39;a scene.json&#39;",
    ] {
        assert!(html.contains(words), "{words}");
    }
}

#[test]
fn the_page_tells_of_several_scenes_and_of_those_that_disagree() {
    let slow = report(6, |tracer, _| if tracer == TracerKind::Wavefront { 0.2 } else { 0.1 });
    let slow = SceneBench { scene: "slow.json".to_owned(), ..slow };
    let page = page(&report_of(vec![steady(), slow, different()]));
    assert_eq!(
        page.lead,
        "Of 2 scenes, the wavefront is faster in 1 and the recursive tracer in 1; in 0 the \
         difference is within noise. The wavefront is 0.500 to 1.250 times as fast as the recursive tracer. The \
         tracers disagree in 1 scene: no times are given there."
    );
    assert_eq!(charts(section(&page, "Speed"))[0].series[0].points.len(), 2);
    let wrong = section(&page, "`b.json`");
    assert!(charts(wrong).is_empty() && bars(wrong).is_empty());
    let html = page.html().unwrap();
    assert!(html.contains("THE IMAGES DIFFER"));
    let nothing = super::page::page(&report_of(vec![different()]));
    assert!(nothing.sections.iter().all(|section| section.title != "Speed"));
    assert_eq!(super::page::page(&report_of(Vec::new())).lead, "Nothing was measured.");
}

/// Each choice takes a quarter longer than the one before.
#[test]
fn the_page_has_comparisons_and_what_the_processor_counted() {
    let mut scene = steady();
    let usual =
        Variant { kernel: KernelChoice::Auto, simd: Level::best(), batch: 1024, planned: true };
    let variants = Axis::Kernels.variants(usual);
    let prepared = prepared();
    let trace = |variant: &Variant| -> Result<Rendered> {
        let place = variants.iter().position(|v| v == variant).unwrap();
        let run = render(&prepared, &RenderOptions::default(), &())?;
        Ok(Rendered { seconds: 0.1 * 1.25_f64.powi(place as i32), ..run })
    };
    let schedule = Schedule { warmup: 1, most: 6, seconds: 0.0 };
    let mut found = compare(Axis::Kernels, &variants, &schedule, trace, &mut |_, _| {}).unwrap();
    let rays = scene.rays.all();
    let counts = HardwareCounts { cycles: Some(7 * rays), ..HardwareCounts::default() };
    found.variants.iter_mut().for_each(|each| each.bench.hardware = Some(counts));
    scene.wavefront.as_mut().unwrap().hardware = Some(counts);
    scene.recursive.as_mut().unwrap().hardware = Some(counts);
    scene.comparisons.push(found);
    let page = page(&report_of(vec![scene]));
    let own = section(&page, "`ball.json`");
    let compared = charts(own)[1];
    let medians: Vec<f64> = compared.series[0].points.iter().map(|point| point.y).collect();
    assert_eq!(medians.len(), variants.len());
    assert!(medians[0] == 1.0 && medians.is_sorted_by(|a, b| a > b), "{medians:?}");
    assert_eq!(bars(own)[1].bars.len(), variants.len());
    let html = page.html().unwrap();
    assert!(html.contains("cycles per ray</th><td class=\"right\" data-value=\"7\">7.000</td>"));
    assert_eq!(html.matches("data-value=\"7\">7.000").count(), 2 + variants.len());
}
