//! Error against time: the slopes that theory has, and sweeps that go on where they stopped.

use std::path::Path;

use serde_json::{Value, json};
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::Samples;
use wavecrest_report::accuracy::report::{ERRORS, FastestSetting, FastestSettings, SettingResult};
use wavecrest_report::accuracy::setting::{Family, SettingSeries};
use wavecrest_report::accuracy::store::{FILE, Record, Store, SweepHeader};
use wavecrest_report::accuracy::sweep::run;
use wavecrest_report::accuracy::{AccuracyReport, page};
use wavecrest_report::summary::Uncertain;
use wavecrest_report::text::text;

use crate::support::{
    folder, image_of, matte, pinhole, prepare, repository, scene, sphere, thin_lens, wall, with,
};

fn header(longest: u32, most: u32, least: u32) -> SweepHeader {
    SweepHeader { version: "1".to_owned(), longest, most, least }
}

fn findings(header: &SweepHeader, seeds: u32, file: &Path, folder: &Path) -> AccuracyReport {
    let mut store = Store::open(folder, header).expect("a folder");
    let swept = run(&[file.to_owned()], seeds, &mut store, &|_| {}).expect("a sweep");
    AccuracyReport::new(seeds, &store, &swept, &ERRORS)
}

fn family<'a>(findings: &'a AccuracyReport, name: &str) -> &'a Family<SettingResult> {
    findings.scenes[0].family(name).expect("a family")
}

/// Independent points: the variance of their mean. Stratified points lose most of it but at edges, of which
/// the penumbra is made.
#[test]
fn errors_fall_as_theory_has_it() {
    let folder = folder();
    let found = findings(
        &header(40, 121, 2025),
        4,
        &repository("scenes/testareajitter.json"),
        folder.path(),
    );
    let lights = family(&found, "lights");
    let slope = |sampling: Sampling| {
        let series = lights.series.iter().find(|s| s.name == sampling.name()).expect("a series");
        series.slope.expect("a slope").value
    };
    assert!((slope(Sampling::Random) + 1.0).abs() < 0.05, "{}", slope(Sampling::Random));
    assert!(slope(Sampling::Jittered) < -1.3, "{}", slope(Sampling::Jittered));
    assert!(slope(Sampling::Sobol) < -1.3, "{}", slope(Sampling::Sobol));
    // No sampler has a bias: the mean signed error is within its own spread of 0.
    for point in lights.series.iter().flat_map(|series| &series.points) {
        assert!(point.bias.abs() <= point.rmse.value / 4.0, "{}: {}", point.key, point.bias);
    }
    answers_are_the_fastest_settings(&found);
}

/// Each row of an answer is a measured setting that reaches its error, and none that does is faster.
fn answers_are_the_fastest_settings(found: &AccuracyReport) {
    let measured =
        || family(found, "lights").series.iter().flat_map(|s| s.points.iter().map(move |p| (s, p)));
    for at in &found.scenes[0].answer.errors {
        let reached = measured().filter(|(_, p)| p.rmse.high <= at.error);
        let fastest = reached.map(|(_, p)| p.seconds.median).min_by(f64::total_cmp);
        assert!(fastest.is_some() && at.tracing == fastest, "{at:?}");
        let is_own = |(series, p): &(&SettingSeries<SettingResult>, &SettingResult)| {
            at.sampler.as_ref() == Some(&series.name) && at.points == Some(p.x as u64)
        };
        let (_, own) = measured().find(is_own).expect("a measured setting");
        assert_eq!(Some(own.seconds.median), at.tracing, "{at:?}");
    }
}

/// With a fixed number of rays in a pixel, more points on lights do not help any more: that is no convergence.
/// A sky's points are no points on lights.
#[test]
fn an_error_that_stays_has_no_slope() {
    let folder = folder();
    let file = folder.path().join("sky.json");
    let mut camera = pinhole([24, 18], 45.0, 6.0);
    (camera["antialias"], camera["sampling"]) = (2.into(), "random".into());
    let mut scene = shown(&camera, &[]);
    scene["scene"]["ambient"] =
        json!({"sky": [0.9, 0.9, 1.0], "samples": 2, "sampling": "jittered"});
    std::fs::write(&file, scene.to_string()).expect("a file");
    let found = findings(&header(24, 64, 1024), 3, &file, &folder.path().join("out"));
    let slopes = |name| family(&found, name).series.iter().map(|series| series.slope);
    assert!(slopes("lights").all(|slope| slope.is_none()));
    assert!(slopes("pixel").all(|slope| slope.is_some()));
    let said = text(&page::summary(&found));
    assert_eq!(said.matches("no longer falls above the noise").count(), 3, "{said}");
    assert!(said.contains("number of points of the sky"), "{said}");
    assert!(said.contains("each with one point of the sky"), "{said}");
}

#[test]
fn a_sweep_resumes_where_it_stopped() {
    let (folder, file) = (folder(), repository("scenes/hard/edge-on-light.json"));
    let header = header(8, 4, 16);
    let first = findings(&header, 2, &file, folder.path());
    let path = folder.path().join(FILE);
    let whole = std::fs::read_to_string(&path).expect("records");
    // Again: nothing is left to do.
    findings(&header, 2, &file, folder.path());
    assert_eq!(std::fs::read_to_string(&path).expect("records"), whole);
    // Cut in the middle of a line: what is missing is made again, and says the same but for its times.
    let cut = whole.len() * 2 / 3;
    std::fs::write(&path, &whole[..cut]).expect("a file");
    let again = findings(&header, 2, &file, folder.path());
    let errors = |found: &AccuracyReport| -> Vec<(String, f64)> {
        let series = found.scenes[0].families.iter().flat_map(|family| &family.series);
        series.flat_map(|s| &s.points).map(|p| (p.key.clone(), p.mse)).collect()
    };
    let (mut one, mut other) = (errors(&first), errors(&again));
    one.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    other.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    assert_eq!(one.len(), other.len());
    for (a, b) in one.iter().zip(&other) {
        // The mean is taken in the order of the records.
        assert!(a.0 == b.0 && (a.1 - b.1).abs() <= 1e-12 * a.1.abs(), "{a:?} {b:?}");
    }
    let text = std::fs::read_to_string(&path).expect("records");
    let points = |text: &str| text.lines().filter(|line| line.contains("\"point\"")).count();
    assert_eq!(points(&text), points(&whole));
    // Records are what their type says.
    let records: Vec<Record> =
        text.lines().map(|line| serde_json::from_str(line).expect("a record")).collect();
    assert!(matches!(records[0], Record::Header(_)));
}

/// A square light above a ball: seen from the side, its shadow is soft.
pub(crate) fn square_light(sampling: &str, samples: u32) -> Value {
    let corners = json!([[-1, 4, -1], [-1, 4, 1], [1, 4, 1], [1, 4, -1]]);
    json!({"type": "arealight", "intensity": 60, "color": [1, 1, 1], "sampling": sampling,
           "samples": samples, "shape": {"type": "plane", "points": corners}})
}

pub(crate) fn round_light(sampling: &str, samples: u32) -> Value {
    json!({"type": "arealight", "intensity": 40, "color": [1, 0.9, 0.8], "sampling": sampling,
           "samples": samples, "shape": {"type": "sphere", "center": [2, 3, 3], "radius": 0.7}})
}

pub(crate) fn lens(sampling: &str, side: u32) -> Value {
    with(thin_lens(pinhole([40, 30], 45.0, 6.0), 0.8, 6.5, [side; 2]), "sampling", sampling)
}

pub(crate) fn shown(camera: &Value, lights: &[Value]) -> Value {
    let ball = sphere([0.0, 0.3, 0.5], 1.0, matte(0.8, [0.9, 0.4, 0.2]));
    scene(0, camera, lights, &[ball, wall(5.0, -1.5, matte(0.8, [0.3, 0.5, 0.9]))])
}

/// A scene that is sampled anew is the scene whose file says so.
#[test]
fn resampling_gives_what_the_file_would() {
    let lights = |sampling: &str, n| [round_light(sampling, n), square_light(sampling, n)];
    let pixel = |mut camera: Value, sampling: &str, side: u32| {
        (camera["antialias"], camera["sampling"]) = (side.into(), sampling.into());
        camera
    };
    let base = pixel(pinhole([40, 30], 45.0, 6.0), "jittered", 2);
    for sampling in Sampling::ALL {
        let name = sampling.name();
        let side = 3;
        let count = if sampling == Sampling::Jittered { side } else { side * side };
        let points = Some(Points { sampling, side });
        let mut scene = prepare(&shown(&base, &lights("random", 2)));
        let original = scene.original();
        let samples = Samples { lights: points, pixel: points, lens: None };
        scene.resample(&original, &samples);
        let file = pixel(pinhole([40, 30], 45.0, 6.0), name, side);
        let expected = image_of(&prepare(&shown(&file, &lights(name, count))), 3);
        assert!(image_of(&scene, 3).same_bits(&expected), "{name}");
        scene.resample(&original, &Samples::default());
        let usual = image_of(&prepare(&shown(&base, &lights("random", 2))), 3);
        assert!(image_of(&scene, 3).same_bits(&usual), "{name}: not as it was");

        let mut scene = prepare(&shown(&lens("random", 2), &[]));
        let original = scene.original();
        scene.resample(&original, &Samples { lens: points, ..Samples::default() });
        // A lens's own key is no matter for a pixel of one ray.
        let expected = image_of(&prepare(&shown(&lens(name, side), &[])), 3);
        assert!(image_of(&scene, 3).same_bits(&expected), "{name}: lens");
    }
}

#[test]
fn an_answer_has_its_interval_and_the_lack_of_one_its_reason() {
    let mut at = FastestSetting { sampler: Some("sobol".to_owned()), ..Default::default() };
    at.times_as_fast = Some(Uncertain { value: 1.1, low: 1.0, high: 67.4 });
    let mut answer = FastestSettings { least: Some(0.35), ..FastestSettings::default() };
    answer.errors.push(at);
    let told = answer.sentence();
    assert!(told.ends_with("random ones take 1.1 times (1.0 to 67.4) as long."), "{told}");
    answer.errors.clear();
    let told = answer.sentence();
    assert!(told.contains("the least is 35 %. White is 100 %, and a lamp in view"), "{told}");
}

/// CSV and page have the figures of the JSON.
#[test]
fn a_page_is_written_with_the_same_figures_in_other_forms() {
    let (folder, file) = (folder(), repository("scenes/testareajitter.json"));
    let mut store = Store::open(folder.path(), &header(16, 9, 64)).expect("a folder");
    let mut swept = run(&[file], 2, &mut store, &|_| {}).expect("a sweep");
    let found = AccuracyReport::new(2, &store, &swept, &ERRORS);
    page::write(&found, &mut swept, folder.path()).expect("a page");
    let said = text(&page::summary(&found));
    assert!(said.starts_with("  testareajitter: Soft shadows at "), "{said}");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect(name);
    let page = read("report.html");
    for heading in [
        "Soft shadows at ",
        "What each time buys",
        "Points on lights",
        "Rays in a pixel",
        "Cost and accuracy of each precision",
    ] {
        assert!(page.contains(heading), "{heading}");
    }
    let found: Value = serde_json::from_str(&read("accuracy.json")).expect("JSON");
    let points = &found["scenes"][0]["families"][0]["series"][0]["points"];
    assert_eq!(points.as_array().map(Vec::len), Some(3));
    let csv = read("testareajitter-lights-samples.csv");
    for point in points.as_array().expect("points") {
        let value = point["rmse"]["value"].as_f64().expect("a number");
        assert!(csv.contains(&format!("{value}")), "{value}\n{csv}");
    }
    assert!(read("testareajitter-lights-time.svg").starts_with("<svg"));
}
