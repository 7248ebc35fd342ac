//! `accuracy`, and `render --target-error` and `--time-budget`.

use serde_json::{Value, json};

use super::with_scene;
use crate::support::{json_in, matte, pinhole, run, run_well, scene, sphere, text, wall};

/// A ball under a square light.
fn soft() -> String {
    let corners = json!([[-1, 4, -1], [-1, 4, 1], [1, 4, 1], [1, 4, -1]]);
    let light = json!({"type": "arealight", "intensity": 60, "color": [1, 1, 1], "sampling": "random",
                       "samples": 2, "shape": {"type": "plane", "points": corners}});
    let shapes = [
        sphere([0.0, 0.3, 0.5], 1.0, matte(0.8, [0.9, 0.4, 0.2])),
        wall(5.0, -1.5, matte(0.8, [0.3, 0.5, 0.9])),
    ];
    scene(0, &pinhole([40, 30], 45.0, 6.0), &[light], &shapes).to_string()
}

#[test]
fn a_sweep_writes_a_page_and_the_same_figures_in_other_forms() {
    let folder = with_scene(&soft());
    let arguments = ["accuracy", "ball.json", "-o", "out", "--side-pixels", "16", "--seeds", "2"];
    let small = ["--most", "9", "--reference", "64", "--no-effects"];
    let output = run(folder.path(), &[&arguments[..], &small].concat());
    assert_eq!(text(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
    let said = text(&output.stdout);
    assert!(said.starts_with("  ball: Soft shadows at "), "{said}");
    let read =
        |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).expect(name);
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
    // CSV has the figures of the JSON.
    let csv = read("ball-lights-samples.csv");
    for point in points.as_array().expect("points") {
        let value = point["rmse"]["value"].as_f64().expect("a number");
        assert!(csv.contains(&format!("{value}")), "{value}\n{csv}");
    }
    assert!(read("ball-lights-time.svg").starts_with("<svg"));
    // With other options the folder has another sweep.
    let output = run(folder.path(), &["accuracy", "ball.json", "-o", "out", "--most", "4", "-q"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("results of another sweep"), "{}", text(&output.stderr));
}

#[test]
fn a_render_for_an_error_prints_its_choice_and_the_measured_error() {
    let folder = with_scene(&soft());
    let arguments = ["ball.json", "out.exr", "--target-error", "0.01", "--stats", "s.json"];
    let said = run_well(folder.path(), &arguments);
    assert!(
        said.contains("points on each light: expected error") && said.contains("measured error"),
        "{said}"
    );
    let goal = json_in(folder.path(), "s.json")["goal"].take();
    let found = goal["found_error"].as_f64().expect("a number");
    assert!(found <= 0.01, "{goal}");
    let left_out = "the aliasing of one ray through the centre of each pixel";
    assert_eq!(goal["left_out"], json!([left_out]));
    assert_eq!(
        run_well(folder.path(), &["ball.json", "out.exr", "--time-budget", "0.5", "-q"]),
        ""
    );
}

#[test]
fn advice_names_the_cheapest_sampler() {
    let folder = with_scene(&soft());
    let output =
        run(folder.path(), &["accuracy", "ball.json", "--advise", "--target-error", "0.01"]);
    let said = text(&output.stdout);
    assert_eq!(said.lines().filter(|line| line.starts_with('*')).count(), 1, "{said}");
    for sampler in ["random", "jittered", "sobol"] {
        assert!(said.contains(sampler), "{said}");
    }
}
