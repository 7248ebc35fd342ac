//! Statistics, and images on standard output.

use super::{run_silently, with_ball};
use crate::support::{bytes, json_in, run, text};

/// `statistics.txt` has every key that the documentation names, as JSON pointers.
#[test]
fn statistics_have_every_key_that_their_documentation_names() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "out.exr", "--stats", "stats.json"]);
    let found = json_in(folder.path(), "stats.json");
    for key in include_str!("../statistics.txt").lines() {
        assert!(found.pointer(key).is_some(), "{key} is missing");
    }
    let time = |key: &str| found["time"][key].as_f64().expect("seconds");
    assert!(time("total") >= time("trace"));
}

#[test]
fn the_image_on_standard_output_is_that_of_a_file() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "out.png"]);
    let output = run(folder.path(), &["ball.json", "-", "--quiet"]);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    assert_eq!(output.stdout, bytes(folder.path(), "out.png"));
}
