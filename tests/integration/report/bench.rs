//! The report's form, its text, its page and its warnings.

mod costs;

use std::path::Path;

use serde_json::{Value, json};
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_core::tile::TimedPass;
use wavecrest_report::bench::page::{self, gains, overview, page, scene};
use wavecrest_report::bench::variant::{BATCHES, Variant, Varied};
use wavecrest_report::bench::{
    BenchComparison, BenchReport, BenchSetting, Machine, Preparation, RunDifference, SceneBench,
    TimedRender, compare,
};
use wavecrest_report::measure::{RoundLimits, Rounds, Timing};
use wavecrest_report::page::{Block, Page, Section};
use wavecrest_report::plot::Chart;
use wavecrest_report::text::text;
use wavecrest_scene::load::load_str;
use wavecrest_scene::systems;

use crate::approved;

/// A red ball under a point light.
const SCENE: &str = include_str!("bench/ball.json");

fn prepared(scene: &str) -> PreparedScene {
    let loaded = load_str(scene, Path::new("ball.json"), &Default::default()).unwrap();
    systems::extract(loaded.world, Default::default()).unwrap().build(Preset::Fast)
}

fn setting(name: &str) -> BenchSetting {
    BenchSetting {
        scene: name.to_owned(),
        seed: 3,
        batch: 64,
        simd: Level::best(),
        kernel: KernelChoice::Auto,
        precision: Precision::Exact,
        preset: Preset::Fast,
        time: Preparation { load: 0.5, build: 0.25 },
    }
}

fn usual() -> Variant {
    Variant {
        tracer: TracerKind::Wavefront,
        kernel: KernelChoice::Auto,
        simd: Level::best(),
        batch: 1024,
        threads: 4,
        planned: true,
    }
}

fn schedule(most: usize) -> RoundLimits {
    RoundLimits { warmup: 1, most, seconds: 0.0 }
}

/// What is compared, with the `seconds` given, by variant and run, both by their number; `spoil`
/// changes a run of the variant with this number.
fn compared(
    of: Varied,
    rounds: usize,
    seconds: impl Fn(usize, usize) -> f64,
    spoil: impl Fn(usize, &mut TimedRender),
) -> BenchComparison {
    compared_in(&prepared(SCENE), of, rounds, seconds, spoil)
}

fn compared_in(
    scene: &PreparedScene,
    of: Varied,
    rounds: usize,
    seconds: impl Fn(usize, usize) -> f64,
    spoil: impl Fn(usize, &mut TimedRender),
) -> BenchComparison {
    let choices = of.choices(usual(), &BATCHES);
    let mut runs = vec![0; choices.len()];
    let trace = |variant: &Variant| -> Result<TimedRender> {
        let number = choices.iter().position(|choice| choice.variant == *variant).unwrap();
        let &Variant { tracer, batch, .. } = variant;
        let options = RenderOptions { tracer, batch, seed: 3, crop: None };
        let mut run = TimedRender::of(scene, &options)?;
        run.timing = Timing { seconds: seconds(number, runs[number]), processor: None };
        runs[number] += 1;
        spoil(number, &mut run);
        Ok(run)
    };
    compare(of, &choices, &schedule(rounds), trace, &mut |_, _| {}).unwrap()
}

/// A report with this ladder.
fn report(name: &str, ladder: BenchComparison) -> SceneBench {
    SceneBench::of(&prepared(SCENE), setting(name), vec![ladder])
}

/// Each step takes 0.8 of the time of the one before.
fn steady() -> SceneBench {
    let seconds = |variant: usize, _| 0.125 * 0.8_f64.powi(variant as i32);
    report("ball.json", compared(Varied::Ladder, 6, seconds, |_, _| {}))
}

/// A report in which the first step changes a pixel.
fn different() -> SceneBench {
    let spoil = |variant: usize, run: &mut TimedRender| {
        if variant == 1 {
            let [red, _, blue] = run.rendered.film.pixel(5, 2).unwrap();
            run.rendered.film.paste([5, 2], 1, &[[red, 0.5, blue]]);
        }
    };
    report("b.json", compared(Varied::Ladder, 6, |_, _| 0.1, spoil))
}

#[test]
fn the_json_has_the_documented_keys() {
    let mut report = BenchReport::new(vec!["bench".to_owned()]);
    report.scenes.push(steady());
    assert!(report.scenes[0].equal);
    let json = json!({ "report": report });
    approved::compare("tests/integration/report/bench/keys.txt", |path| {
        let keys = json.pointer(path).unwrap().as_object().unwrap().keys();
        keys.map(String::as_str).collect::<Vec<_>>().join(" ")
    });
}

#[test]
fn images_that_differ_have_no_times() {
    let found = different();
    let shown = text(&scene(&found, &Machine::this()));
    for part in ["THE IMAGES DIFFER, first at column 5, row 2", "has 0.", "3f000000"] {
        assert!(shown.contains(part), "{part}\n{shown}");
    }
    let json = serde_json::to_value(&found).unwrap();
    assert_eq!(json["equal"], false);
    let ladder = &json["comparisons"][0];
    assert_eq!((&ladder["rounds"], &ladder["variants"]), (&json!(0), &json!([])));
    let difference = &ladder["difference"];
    assert_eq!(difference["first"], "column 5, row 2");
    assert_eq!((&difference["is_image"], &difference["over"]), (&json!(true), &json!("recursive")));
    assert!(found.tracers().is_none());
}

#[test]
fn work_that_differs_ends_a_comparison_unless_all_passes_run() {
    let spoil = |variant: usize, run: &mut TimedRender| {
        run.rendered.counters.tests.nodes = variant as u64;
        run.rendered.counters.samples.footprints = variant as u64;
    };
    let found = compared(Varied::Kernels, 2, |_, _| 0.1, spoil).difference.unwrap();
    let [first, expected, found_there] = ["footprints", "0", "1"].map(str::to_owned);
    let (label, over) = ("packet".to_owned(), found.over.clone());
    let difference =
        RunDifference { label, over, is_image: false, first, expected, found: found_there };
    assert_eq!(found, difference);
    assert_eq!(compared(Varied::Plan, 2, |_, _| 0.1, spoil).difference, None);
    let spoil = |variant: usize, run: &mut TimedRender| {
        run.rendered.film.paste([4, 5], 1, &[[variant as f32; 3]]);
    };
    assert!(compared(Varied::Plan, 2, |_, _| 0.1, spoil).difference.is_some());
}

#[test]
fn the_text_has_the_answer_first_and_work_beside_time() {
    let found = steady();
    let shown = text(&scene(&found, &Machine::this()));
    let ladder = found.ladder().unwrap();
    let ratio = ladder.variants.iter().rfind(|v| v.gain.is_some()).unwrap().ratio;
    let start = format!("  The wavefront is {:.2} times as fast", ratio.interval.median);
    assert!(shown.starts_with(&start), "{shown}");
    assert!(shown.contains("order 1.25") && gains(&ladder.variants).starts_with("order 1.25"));
    for part in [
        "24 × 16 pixels, 1 camera ray each but for background\n",
        "1 sphere, 1 light\n",
        "loaded in 0.500 s, BVH (fast) built in 0.250 s",
        "6 rounds, all images",
        "125.000",
        "order 1.250",
        "1.250 (1.250 to 1.250)",
    ] {
        assert!(shown.contains(part), "{part}\n{shown}");
    }
    assert!(!shown.contains("look-up of a map"), "no row for what the scene has not:\n{shown}");
    assert!(shown.lines().all(|line| line.chars().count() <= 100), "{shown}");
}

#[test]
fn warnings_say_what_to_do() {
    let told = |rounds, seconds: fn(usize, usize) -> f64, words: &str| {
        let found = report("a", compared(Varied::Ladder, rounds, seconds, |_, _| {}));
        found.warnings.iter().any(|warning| warning.contains(words))
    };
    for words in ["--warmup", "close other programs", "--repeats", "--width"] {
        assert!(!told(6, |_, _| 0.1, words), "{words}");
    }
    // The first timed run is each variant's second.
    assert!(told(8, |_, run| if run == 1 { 0.3 } else { 0.1 }, "took 3.00 times the median"));
    let wide = |_, run| 0.1 + 0.01 * run as f64;
    assert!(told(8, wide, "close other programs") && !told(8, wide, "--warmup"));
    assert!(told(2, |_, _| 0.1, "2 rounds cannot give 95 % confidence"));
    assert!(told(6, |_, _| 0.001, "takes 1.00 ms"));
}

/// The report of these scenes.
fn report_of(scenes: Vec<SceneBench>) -> BenchReport {
    BenchReport { scenes, ..BenchReport::new(vec!["bench".to_owned(), "a scene.json".to_owned()]) }
}

fn section<'a>(page: &'a Page, title: &str) -> &'a Section {
    let found = page.sections.iter().find(|section| section.title == title);
    found.unwrap_or_else(|| panic!("no section {title}"))
}

/// The charts of a section.
fn charts(section: &Section) -> Vec<&Chart> {
    let charts = section.blocks.iter().filter_map(|block| match block {
        Block::Chart(found) => Some(found),
        _ => None,
    });
    charts.collect()
}

#[test]
fn the_page_has_the_figures_of_the_report() {
    let mut measured = steady();
    let batches = |variant: usize, _| [1.0, 2.0, 1.0, 0.5, 0.5, 0.5][variant];
    measured.comparisons.push(compared(Varied::Batches, 6, batches, |_, _| {}));
    let report = report_of(vec![measured]);
    let [_, wavefront] = report.scenes[0].tracers().unwrap();
    let page = page(&report);
    assert!(page.lead.ends_with("All images are bit-identical."), "{}", page.lead);
    let speed = charts(section(&page, "Speed"))[0];
    let (point, interval) = (&speed.series[0].points[0], wavefront.ratio.interval);
    assert_eq!([point.y, point.low, point.high], [interval.median, interval.low, interval.high]);
    let own = section(&page, "`ball.json`");
    let [ladder, sizes] = charts(own)[..] else { panic!("two charts") };
    let ratios: Vec<f64> = ladder.series[0].points.iter().map(|point| point.y).collect();
    assert!(ratios.is_sorted() && ratios.last() == Some(&interval.median), "{ratios:?}");
    let places: Vec<[f64; 2]> = sizes.series[0].points.iter().map(|p| [p.x, p.y]).collect();
    assert_eq!(places, [[16.0, 0.5], [64.0, 1.0], [256.0, 2.0], [1024.0, 2.0], [4096.0, 2.0]]);
    let table = |block: &&Block| matches!(block, Block::Table(table) if table.caption.starts_with("Time by pass"));
    let Some(Block::Table(passes)) = own.blocks.iter().find(table) else { panic!("no passes") };
    let names: Vec<_> = passes.columns[1..].iter().map(|column| column.name.as_str()).collect();
    let plain = TimedPass::ALL.map(TimedPass::name).into_iter();
    let plain = plain.filter(|pass| !["maps", "decode"].contains(pass));
    assert_eq!(names, plain.collect::<Vec<_>>(), "no pass without time");
    let html = page.html();
    for words in [
        "<td class=\"right\" data-value=\"125\">125.000</td>",
        "wavecrest bench &#39;a scene.json&#39;",
    ] {
        assert!(html.contains(words), "{words}");
    }
}

#[test]
fn a_busy_machine_is_told_first_and_scenes_have_the_names_of_their_files() {
    let quiet = page(&report_of(vec![steady()]));
    assert!(quiet.first.len() == 1 && !quiet.lead.contains("busy"), "{}", quiet.lead);
    assert_eq!(quiet.html().matches(page::STEPS).count(), 1);
    let of = |name: &str, left_out, busy| {
        let mut found = steady();
        found.setting.scene = name.to_owned();
        found.comparisons[0].rounds = Rounds { rounds: 6, left_out, busy };
        found
    };
    let found = page(&report_of(vec![of("a/s.json", 2, 1), of("b/t.json", 1, 0)]));
    let [Block::Warning(words), _] = &found.first[..] else { panic!("{:?}", found.first) };
    let busy = "The machine was busy in 4 of 15 rounds, 3 of them left out";
    assert!(words.starts_with(busy), "{words}");
    assert!(found.lead.contains(&format!(" {busy}. ")), "{}", found.lead);
    let titles = |page: &Page| page.sections.iter().map(|s| s.title.clone()).collect::<Vec<_>>();
    assert_eq!(titles(&found)[1..3], ["`s.json`", "`t.json`"]);
    let alike = page(&report_of(vec![of("a/s.json", 0, 0), of("b/s.json", 0, 0)]));
    assert_eq!(titles(&alike)[1..3], ["`a/s.json`", "`b/s.json`"]);
}

#[test]
fn the_page_tells_of_several_scenes_and_of_those_that_differ() {
    let slow = report("slow.json", compared(Varied::Ladder, 6, |v, _| 0.1 + v as f64, |_, _| {}));
    let scenes = vec![steady(), slow, different()];
    let found = page(&report_of(scenes.clone()));
    assert!(found.lead.starts_with("In 2 scenes, the wavefront is 0."), "{}", found.lead);
    assert!(found.lead.ends_with("Images differ in 1 scene."), "{}", found.lead);
    assert_eq!(charts(section(&found, "Speed"))[0].series[0].points.len(), 2);
    let wrong = section(&found, "`b.json`");
    assert!(charts(wrong).is_empty());
    assert!(found.html().contains("THE IMAGES DIFFER"));
    let shown = text(&overview(&scenes));
    assert!(shown.contains("slow.json") && !shown.contains("b.json"), "{shown}");
    let nothing = page(&report_of(vec![different()]));
    assert!(nothing.sections.iter().all(|section| section.title != "Speed"));
    assert_eq!(page(&report_of(Vec::new())).lead, "Nothing was measured.");
}
