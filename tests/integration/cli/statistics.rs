//! The JSON of `--stats`.

use std::path::Path;

use serde_json::{Value, json};

use super::{run_silently, with_ball};
use crate::support::json_in;

/// Every key that the documentation of the statistics names, as JSON pointers.
const STATISTICS: &str = include_str!("../statistics.txt");

fn statistics(folder: &Path, options: &[&str]) -> Value {
    run_silently(folder, &[&["ball.json", "out.exr", "--stats", "stats.json"], options].concat());
    json_in(folder, "stats.json")
}

#[test]
fn statistics_have_every_key_that_their_documentation_names() {
    let folder = with_ball();
    let found = statistics(folder.path(), &["--threads", "2", "--seed", "5"]);
    for key in STATISTICS.lines() {
        assert!(found.pointer(key).is_some(), "{key} is missing");
    }
    assert_eq!(found["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!((&found["scene"], &found["tracer"]), (&json!("ball.json"), &json!("wavefront")));
    assert_eq!((&found["threads"], &found["seed"]), (&json!(2), &json!(5)));
    assert_eq!(found["image"], json!({"width": 16, "height": 12, "samples_per_pixel": 1}));
    assert_eq!(found["rays"]["primary"], 16 * 12);
    let secondary = found["rays"]["secondary"].as_u64().expect("a number");
    assert!(secondary > 0 && secondary < 16 * 12, "only the ball mirrors: {secondary}");
    let time = |key: &str| found["time"][key].as_f64().expect("seconds");
    assert!(time("total") >= time("trace"));
    let estimated = &found["estimated"]["rays"];
    assert_eq!(estimated["primary"], found["rays"]["primary"]);
    for key in ["secondary", "shadow"] {
        assert!(estimated[key].as_u64() >= found["rays"][key].as_u64(), "{key}");
    }
    // A thread that had nothing to do holds no column.
    let [most, held] = ["estimated", "held"].map(|key| found["columns"][key].as_u64());
    assert!(held > Some(0) && held <= most, "{held:?}, {most:?}");
}

#[test]
fn statistics_say_which_kernels_took_the_rays() {
    let folder = with_ball();
    for kernel in ["auto", "packet", "stream", "single"] {
        let found = statistics(folder.path(), &["--kernel", kernel, "--simd", "auto"]);
        assert_eq!(found["kernel"], kernel);
        let closest = &found["kernels"]["closest"];
        let rays = |key: &str| closest[key].as_u64().expect("a number");
        let sum = |value: &Value, keys: [&str; 2]| {
            keys.iter().map(|key| value[key].as_u64().expect("a number")).sum::<u64>()
        };
        let all = sum(&found["rays"], ["primary", "secondary"]);
        assert_eq!(rays("packet") + rays("stream") + rays("single"), all, "{kernel}");
        match kernel {
            "stream" => assert_eq!(rays("stream"), all),
            "single" => assert_eq!(rays("single"), all),
            // Which rays are fit for packets depends on the scene.
            _ => assert_eq!(rays("single"), 0, "{kernel}: {closest}"),
        }
    }
}

#[test]
fn statistics_of_the_recursive_tracer_count_the_same_work() {
    let folder = with_ball();
    let [wavefront, recursive] = ["wavefront", "recursive"]
        .map(|tracer| statistics(folder.path(), &["--tracer", tracer, "--crop", "2,2,9,7"]));
    assert_eq!(recursive["tracer"], "recursive");
    // Rays that go through the tree together are tested together, so that `tests` differ.
    for key in ["image", "rays", "samples", "plan", "dropped"] {
        assert_eq!(wavefront[key], recursive[key], "{key}");
    }
    assert_eq!(recursive["image"]["width"], 9);
    assert!(recursive.pointer("/time/passes/recursive").is_some());
}
