//! Progress, and the image while it is not finished.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::{ball, run_silently, with_ball, with_scene};
use crate::support::{bytes, edited, film, folder, put, run, text};

/// The ball in so many pixels.
fn of_size(width: u32, height: u32) -> Value {
    edited(ball(), &format!("/camera/width {width}\n/camera/height {height}"))
}

#[test]
fn progress_is_printed_as_lines_of_json() {
    let folder = with_scene(&of_size(170, 130).to_string());
    let start = Instant::now();
    let output = run(folder.path(), &["ball.json", "out.exr", "--progress", "json", "--quiet"]);
    let spent = start.elapsed().as_secs_f64();
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(0), ""));
    let parse = |line: &str| serde_json::from_str::<Value>(line).expect("JSON");
    let lines: Vec<Value> = text(&output.stderr).lines().map(parse).collect();
    let mut stages: Vec<&str> = lines.iter().map(|l| l["stage"].as_str().expect("text")).collect();
    stages.dedup();
    assert_eq!(stages, ["load", "build", "trace", "write", "done"]);
    assert!((lines.len() as f64) < 10.0 * spent + 8.0, "{} lines in {spent} s", lines.len());
    let seconds = |line: &Value| line["seconds"].as_f64().expect("a number");
    assert!(lines.windows(2).all(|pair| seconds(&pair[0]) <= seconds(&pair[1])));
    let traced: Vec<_> = lines.iter().filter(|line| line["stage"] == "trace").collect();
    assert_eq!((&traced[0]["done"], &traced[0]["all"]), (&json!(0), &Value::Null));
    let last = traced[traced.len() - 1];
    assert_eq!((&last["done"], &last["all"]), (&json!(170 * 130), &json!(170 * 130)));
    assert_eq!(last["left"], 0.0);
    for line in &lines {
        let keys: Vec<_> = line.as_object().expect("an object").keys().collect();
        assert_eq!(keys, ["stage", "frame", "frames", "done", "all", "seconds", "left"]);
        assert_eq!([&line["frame"], &line["frames"]], [&Value::Null; 2]);
    }
}

/// The lines of progress of a command that succeeds.
fn progress(folder: &Path, line: &str) -> Vec<Value> {
    let arguments: Vec<&str> = line.split(' ').collect();
    let output = run(folder, &[&arguments[..], &["--progress", "json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{line}: {}", text(&output.stderr));
    let lines = text(&output.stderr).lines();
    // Notes are no JSON.
    lines.filter_map(|line| serde_json::from_str(line).ok()).collect()
}

#[test]
fn progress_names_the_frame_of_animations() {
    let folder = folder();
    put(folder.path(), "t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for views in ["a.gif --turntable 3", "a#.png --turntable 3"] {
        let lines = progress(folder.path(), &format!("t.obj {views} --size 64x48"));
        let traced = lines.iter().filter(|line| line["stage"] == "trace");
        let mut frames: Vec<_> = traced.map(|line| (&line["frame"], &line["frames"])).collect();
        frames.dedup();
        let expected = [json!(1), json!(2), json!(3)];
        assert_eq!(frames, expected.each_ref().map(|frame| (frame, &expected[2])), "{views}");
    }
}

#[test]
fn reading_and_building_are_counted() {
    let folder = folder();
    run_silently(folder.path(), &["generate", "knot", "mesh.ply", "-n", "1M", "-q"]);
    let bytes = bytes(folder.path(), "mesh.ply").len();
    let lines = progress(folder.path(), "mesh.ply a.png --size 8x6 --bvh fast");
    for (stage, all) in [("load", bytes), ("build", 1_000_000)] {
        let of_stage: Vec<_> = lines.iter().filter(|line| line["stage"] == stage).collect();
        let last = of_stage[of_stage.len() - 1];
        assert!(of_stage.len() > 1, "{stage} takes longer than a tenth of a second: {lines:?}");
        let found = last["all"].as_u64().expect("a number") as usize;
        assert!((all..all + all / 50).contains(&found), "{stage}: {found}, not {all}");
        let done = of_stage.iter().map(|line| line["done"].as_u64());
        assert!(done.is_sorted() && last["done"].as_u64() > Some(0), "{of_stage:?}");
    }
}

/// What a command prints on a terminal; none where no program gives it one.
fn on_a_terminal(folder: &Path, arguments: &str) -> Option<String> {
    let mut script = Command::new("script");
    let command = format!("{} {arguments}", env!("CARGO_BIN_EXE_wavecrest"));
    script.args(["-qec", &command, "/dev/null"]).current_dir(folder).stdin(Stdio::null());
    let output = script.output().ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
#[cfg(target_os = "linux")]
fn a_terminal_shows_each_stage_and_frame_from_the_start() {
    let folder = with_ball();
    // Each stage takes longer than a bar takes to be drawn again.
    run_silently(folder.path(), &["generate", "knot", "mesh.ply", "-n", "1M", "-q"]);
    for (arguments, expected) in [
        ("mesh.ply a.png --size 8x6 --bvh medium", &["reading", "building the BVH"][..]),
        ("mesh.ply a.gif --size 300x200 --turntable 2", &["image 1 of 2", "image 2 of 2"]),
        ("ball.json a.png -q", &[]),
    ] {
        let Some(shown) = on_a_terminal(folder.path(), arguments) else {
            eprintln!("there is no program script: bars are not tried");
            return;
        };
        assert!(expected.iter().all(|words| shown.contains(words)), "{arguments}: {shown}");
        assert!(!expected.is_empty() || shown.is_empty(), "{arguments}: {shown}");
    }
}

/// A child that is killed when the test ends.
struct Killed(Child);

impl Drop for Killed {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn the_image_is_written_while_it_is_rendered() {
    // So many rays that the test is over before the render is.
    let mut scene = of_size(200, 150);
    scene["camera"]["antialias"] = json!(64);
    let folder = with_scene(&scene.to_string());
    let mut command = Command::new(env!("CARGO_BIN_EXE_wavecrest"));
    command.args(["ball.json", "out.pfm", "--also", "out.exr", "--save-every", "0.05", "-q"]);
    let child = command.current_dir(folder.path()).stderr(Stdio::piped()).spawn();
    let _child = Killed(child.expect("the command starts"));
    let start = Instant::now();
    // The second output is there as soon as the first is whole.
    while !folder.path().join("out.exr").exists() {
        assert!(start.elapsed() < Duration::from_secs(120), "no image is written");
        std::thread::sleep(Duration::from_millis(20));
    }
    let found = film(folder.path(), "out.exr");
    assert_eq!((found.width(), found.height()), (200, 150));
    let done = found.pixels().iter().filter(|pixel| **pixel != [0.0; 3]).count();
    assert!(done > 0 && done < 200 * 150, "{done}");
    let bytes = bytes(folder.path(), "out.exr");
    let said = String::from_utf8_lossy(&bytes);
    assert!(said.contains("wavecrest.unfinished") && said.contains("% is rendered"));
    assert!(folder.path().join("out.pfm").exists());
}
