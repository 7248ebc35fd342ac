//! `accuracy`, and `render --target-error` and `--time-budget`.

use serde_json::json;

use super::with_scene;
use crate::support::{
    json_in, matte, pinhole, point_light, run, run_well, scene, sphere, text, wall,
};

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
fn a_sweep_prints_its_summary_and_keeps_a_folder_for_itself() {
    let light = point_light(20.0, [3.0, 2.0, 4.0], [1.0; 3]);
    let ball = sphere([0.0; 3], 1.0, matte(0.8, [0.9, 0.4, 0.2]));
    let folder = with_scene(&scene(0, &pinhole([2, 2], 45.0, 6.0), &[light], &[ball]).to_string());
    let output = run(folder.path(), &["accuracy", "ball.json", "-o", "out"]);
    assert_eq!(text(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
    let said = text(&output.stdout);
    assert!(said.starts_with("  ball: "), "{said}");
    assert!(said.trim_end().ends_with("report.html"), "{said}");
    let report = json_in(&folder.path().join("out"), "accuracy.json");
    assert_eq!(report["scenes"][0]["scene"], json!("ball"));
    let output = run(folder.path(), &["accuracy", "ball.json", "-o", "out", "--full", "-q"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("results of another sweep"), "{}", text(&output.stderr));
}

#[test]
fn a_render_for_an_error_tells_its_samples_and_its_error() {
    let folder = with_scene(&soft());
    let arguments = ["ball.json", "out.exr", "--target-error", "0.01", "--stats", "s.json"];
    let said = run_well(folder.path(), &arguments);
    assert!(said.contains(" rays per pixel: error 0.00"), "{said}");
    let goal = json_in(folder.path(), "s.json")["goal"].take();
    assert!(goal["found_error"].as_f64().is_some_and(|found| found <= 0.01), "{goal}");
    assert_eq!((&goal["end"], &goal["asked"]["error"]), (&json!("error"), &json!(0.01)));
    let within = ["ball.json", "out.exr", "--time-budget", "0.5", "--target-error", "1e-9"];
    let said = run_well(
        folder.path(),
        &[&within[..], &["--stats", "s.json", "--crop", "0,0,20,20"]].concat(),
    );
    assert!(said.contains("the target error 0.000000001 was not reached"), "{said}");
    assert_eq!(json_in(folder.path(), "s.json")["goal"]["end"], json!("time"));
    let output = run(folder.path(), &["ball.json", "-", "-q", "--time-budget", "0.3"]);
    assert!(output.stdout.starts_with(b"\x89PNG"), "{}", text(&output.stderr));
}
