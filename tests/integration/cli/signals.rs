//! What SIGINT, SIGTERM and SIGKILL leave behind.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

use super::{files, run_silently, with_scene};
use crate::parts::ball;
use crate::support::{
    bytes, edited, film, folder, matte, pinhole, point_light, put, scene, text, wall, wavecrest,
    with,
};

/// How long to wait for a file, at most: machines may be slow.
const PATIENCE: Duration = Duration::from_secs(120);

/// A scene whose render takes some seconds of a processor: 64 x 64 pixels of 576 samples, in two blocks.
fn long() -> Value {
    ball([64, 64], 24)
}

/// What becomes of a command that gets these signals so many seconds after there is a file, or one whose name begins so.
/// It has to end soon after.
fn interrupted(
    folder: &Path,
    arguments: &[&str],
    (file, wait): (&str, f64),
    signals: &[&str],
) -> Output {
    let mut command = wavecrest(folder);
    command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command runs");
    let begun = Instant::now();
    let is_there =
        || folder.join(file).exists() || files(folder).iter().any(|f| f.starts_with(file));
    while !is_there() {
        assert!(child.try_wait().expect("a child").is_none(), "it ended too early");
        assert!(begun.elapsed() < PATIENCE, "there is no {file}");
        std::thread::sleep(Duration::from_millis(2));
    }
    std::thread::sleep(Duration::from_secs_f64(wait));
    let id = child.id().to_string();
    for signal in signals {
        let sent = Command::new("kill").args(["-s", signal, &id]).status().expect("kill runs");
        assert!(sent.success());
    }
    let sent = Instant::now();
    let output = child.wait_with_output().expect("a child");
    assert!(sent.elapsed() < Duration::from_secs(20), "{arguments:?}: {:?}", sent.elapsed());
    output
}

/// A folder with a long scene, and its image as one process makes it.
fn with_long() -> (TempDir, Vec<u8>) {
    let folder = with_scene(&long().to_string());
    run_silently(folder.path(), &["ball.json", "usual.exr"]);
    let usual = bytes(folder.path(), "usual.exr");
    (folder, usual)
}

const RENDER: [&str; 8] =
    ["ball.json", "out.exr", "--checkpoint", "kept", "--every", "0.001", "--threads", "1"];

#[test]
fn a_signal_stops_a_render_that_resumes_to_the_same_bytes() {
    let (folder, usual) = with_long();
    let at = |name: &str| folder.path().join(name);
    let whole = film(folder.path(), "usual.exr");
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        std::fs::remove_file(at("out.exr")).ok();
        // The first writing of the checkpoint holds little; the next follow each other.
        let output = interrupted(folder.path(), &RENDER, ("kept", 0.05), &[signal]);
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{told}");
        let percent = told
            .strip_prefix(&format!("stopped by SIG{signal} at "))
            .and_then(|rest| rest.split_once(" %; "));
        let (percent, rest) = percent.expect(told);
        let percent: f64 = percent.parse().expect(told);
        let go_on = "; resume with --checkpoint kept --resume\n";
        assert!(rest.ends_with(go_on), "{told}");
        if rest.starts_with("out.exr has what was finished; the rest is black") {
            let part = film(folder.path(), "out.exr");
            let pairs = || part.pixels().iter().zip(whole.pixels());
            assert!(pairs().all(|(a, b)| a == b || *a == [0.0; 3]), "black or as it will be");
            let same = pairs().filter(|(a, b)| a == b).count() as f64 / (64.0 * 64.0);
            assert!((same * 100.0 - percent).abs() < 5.0, "{same}: {told}");
        } else {
            assert_eq!(percent, 0.0, "{told}");
            assert!(
                rest.starts_with("out.exr is not written") && !at("out.exr").exists(),
                "{told}"
            );
        }
        check_left(folder.path(), &["ball.json", "kept", "out.exr", "usual.exr"]);
        let resumed = [&RENDER[..], &["--resume", "-q"]].concat();
        run_silently(folder.path(), &resumed);
        assert!(bytes(folder.path(), "out.exr") == usual, "after SIG{signal}");
        std::fs::remove_file(at("kept")).expect("it is there");
    }
}

/// A large mesh, in a render that ends while rays build its tree.
#[test]
fn a_render_that_ends_while_its_tree_is_built_resumes_to_the_same_bytes() {
    let folder = folder();
    let knot = ["generate", "knot", "knot.ply", "--triangles", "500000", "-q"];
    run_silently(folder.path(), &knot);
    let mesh = json!({"type": "trimesh", "file": "knot.ply", "material": matte(1.0, [0.5; 3])});
    let light = point_light(50.0, [3.0, 3.0, 5.0], [1.0; 3]);
    let knot = scene(0, &pinhole([256, 256], 40.0, 6.0), &[light], &[mesh]);
    put(folder.path(), "ball.json", knot.to_string());
    run_silently(folder.path(), &["ball.json", "usual.exr", "--bvh", "fast"]);
    let usual = bytes(folder.path(), "usual.exr");
    let on_demand = [&RENDER[..], &["--bvh", "on-demand"]].concat();
    for (signal, code) in [("INT", Some(130)), ("TERM", Some(143)), ("KILL", None)] {
        let output = interrupted(folder.path(), &on_demand, ("kept", 0.0), &[signal]);
        assert_eq!(output.status.code(), code, "{}", text(&output.stderr));
        run_silently(folder.path(), &[&on_demand[..], &["--resume", "-q"]].concat());
        assert!(bytes(folder.path(), "out.exr") == usual, "after SIG{signal}");
        std::fs::remove_file(folder.path().join("kept")).expect("it is there");
    }
}

#[test]
fn a_signal_leaves_an_older_image_as_it_is() {
    let (folder, _) = with_long();
    let at = |name: &str| folder.path().join(name);
    for (signal, more) in [("INT", &[][..]), ("TERM", &["--save-every", "1000"])] {
        std::fs::write(at("out.exr"), "an older image").expect("a file");
        let told = stopped_after_a_tile(folder.path(), signal, more);
        assert!(told.contains("; new.png has what was finished; the rest is black; "), "{told}");
        if more.is_empty() {
            assert!(
                told.ends_with("; out.exr is unchanged; resume with --checkpoint kept --resume\n"),
                "{told}"
            );
            assert_eq!(bytes(folder.path(), "out.exr"), b"an older image");
        } else {
            assert!(told.contains(" %; out.exr has what was finished; "), "{told}");
            film(folder.path(), "out.exr");
        }
        film(folder.path(), "new.png");
        std::fs::remove_file(at("new.png")).expect("it is there");
    }
}

/// Renders out.exr and new.png, ended by a signal when a part is finished; returns the message.
fn stopped_after_a_tile(folder: &Path, signal: &str, more: &[&str]) -> String {
    let arguments = [&RENDER[..], &["--also", "new.png"], more].concat();
    for wait in [0.05, 0.1, 0.2, 0.4, 0.8] {
        let output = interrupted(folder, &arguments, ("kept", wait), &[signal]);
        std::fs::remove_file(folder.join("kept")).expect("it is there");
        let told = text(&output.stderr);
        if !told.contains(" at 0 %") {
            return told.to_owned();
        }
        assert!(told.contains("; out.exr is unchanged; new.png is not written; "), "{told}");
    }
    panic!("no tile was finished");
}

#[test]
fn a_shard_that_a_signal_ends_is_kept_and_not_written() {
    let folder = with_scene(&long().to_string());
    let shard = ["ball.json", "1.part", "--threads", "1", "--shard", "1/2"];
    let shard = [&shard[..], &["--checkpoint", "kept", "--every", "0.001"]].concat();
    let output = interrupted(folder.path(), &shard, ("kept", 0.0), &["TERM"]);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(143), "{told}");
    assert!(told.contains("; 1.part is not written; resume with --checkpoint kept"), "{told}");
    assert_eq!(files(folder.path()), ["ball.json", "kept"]);
    run_silently(folder.path(), &[&shard[..], &["--resume", "-q"]].concat());
    run_silently(folder.path(), &["ball.json", "2.part", "--shard", "2/2"]);
    run_silently(folder.path(), &["merge", "1.part", "2.part", "-o", "out.exr"]);
    run_silently(folder.path(), &["ball.json", "usual.exr"]);
    assert!(bytes(folder.path(), "out.exr") == bytes(folder.path(), "usual.exr"));
}

/// What is said between `stopped by SIGINT at` and the end: the percentage, and the rest.
fn stopped(output: &Output) -> (f64, String) {
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{told}");
    let (_, told) = told.split_once("stopped by SIGINT at ").expect(told);
    let (percent, rest) = told.split_once(" %; ").expect(told);
    (percent.parse().expect(percent), rest.to_owned())
}

#[test]
fn frames_before_a_signal_are_written_and_no_part_of_another() {
    let mut scene = long();
    scene["camera"]["path"] = json!({"keys": [{"frame": 1, "location": [0, 0, 5]}]});
    let folder = with_scene(&scene.to_string());
    let frames = ["ball.json", "f#.pfm", "--frames", "1..3", "--threads", "1"];
    let (percent, rest) = stopped(&interrupted(folder.path(), &frames, ("f1.pfm", 0.0), &["INT"]));
    assert_eq!(rest, "f2.pfm is not written; the frame before it is written\n");
    assert!((33.3..66.7).contains(&percent), "{percent}");
    assert_eq!(files(folder.path()), ["ball.json", "f1.pfm"]);
}

#[test]
fn an_animation_that_a_signal_ends_is_not_written() {
    let folder = with_scene("");
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n";
    put(folder.path(), "t.obj", mesh);
    let cases: [(&str, &[&str]); 2] =
        [("t.gif", &["--turntable", "400"]), ("t.png", &["--turntable", "400", "--as", "normals"])];
    for (name, options) in cases {
        let size = ["--width", "400", "--height", "300", "--threads", "1"];
        let arguments = [&["t.obj", name][..], options, &size].concat();
        let some = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2].into_iter().find_map(|wait| {
            let output = interrupted(folder.path(), &arguments, ("t.obj", wait), &["INT"]);
            // Before the first ray, a signal ends the process.
            output.status.code()?;
            let (percent, rest) = stopped(&output);
            assert_eq!(rest, format!("{name} is not written\n"));
            assert_eq!(files(folder.path()), ["ball.json", "t.obj"]);
            (percent > 0.0).then_some(percent)
        });
        assert!(some.is_some_and(|percent| percent < 100.0), "{name}: {some:?}");
    }
}

/// A scene of one pixel that takes minutes: of its light.
pub(super) fn endless() -> Value {
    let mut scene = ball([1, 1], 64);
    let corners = [[-1.0, 4.0, -1.0], [-1.0, 4.0, 1.0], [1.0, 4.0, 1.0], [1.0, 4.0, -1.0]];
    scene["scene"]["lightsources"][0] = json!({
        "type": "arealight", "intensity": 40.0, "position": [0.0, 4.0, 0.0], "color": [1.0, 1.0, 1.0],
        "sampling": "random", "samples": 20_000, "shape": {"type": "plane", "points": corners}
    });
    scene
}

/// A scene of one ray whose number doubles at every bounce: panes that send on more light than they receive.
fn doubling() -> String {
    let glass = edited(matte(0.0, [0.0; 3]), "/kr 2\n/kt 0.5\n/thin true");
    let pane = |z: f64| with(wall(1000.0, z, glass.clone()), "sides", "both");
    scene(64, &pinhole([1, 1], 1.0, 5.0), &[], &[0.0, -0.5, -1.0, -1.5].map(pane)).to_string()
}

/// The exit code of a command to which signals are sent while it traces rays. Before the first ray, the first signal ends
/// the process: then it was sent too early.
fn ended_by(folder: &Path, arguments: &[&str], signals: &[&str]) -> Option<i32> {
    let ended = |wait| interrupted(folder, arguments, ("ball.json", wait), signals).status.code();
    [0.5, 2.0, 8.0, 30.0].into_iter().find_map(ended)
}

#[test]
fn a_signal_ends_a_render_within_a_pixel() {
    // A budget shortens what is endless because of its light.
    let ways = [["--tracer", "wavefront"], ["--tracer", "recursive"], ["--time-budget", "900"]];
    for (scene, ways) in [(endless().to_string(), &ways[..2]), (doubling(), &ways)] {
        let folder = with_scene(&scene);
        for more in ways {
            let render = [&["ball.json", "out.exr"][..], more].concat();
            assert_eq!(ended_by(folder.path(), &render, &["TERM"]), Some(143), "{more:?}");
        }
        // The image after the first pass of a budget.
        let budget = ways.len() > 2;
        assert_eq!(files(folder.path()), &["ball.json", "out.exr"][..1 + usize::from(budget)]);
    }
}

/// What has nothing to write is ended by the signal itself.
#[test]
fn a_signal_ends_other_commands_within_a_pixel() {
    let folder = with_scene(&doubling());
    let output =
        interrupted(folder.path(), &["explain", "ball.json"], ("ball.json", 0.5), &["TERM"]);
    assert_eq!(output.status.code(), None, "a signal ended it");
    let told = text(&output.stderr);
    assert!(told.ends_with("stopped by SIGTERM; no file is written\n"), "{told}");
}

#[test]
fn what_a_sweep_leaves_behind_is_told() {
    let folder = with_scene(&endless().to_string());
    let (sweep, begun) = (["accuracy", "ball.json", "-o", "out"], ("out/results.jsonl", 0.5));
    let output = interrupted(folder.path(), &sweep, begun, &["INT"]);
    assert_eq!(output.status.code(), None, "a signal ended it");
    assert_eq!(text(&output.stderr), "stopped by SIGINT; written: out/results.jsonl\n");
}

/// Both wait until the process goes on, and come in this order.
#[test]
fn a_second_signal_ends_the_process_at_once() {
    let folder = with_scene(&endless().to_string());
    let signals = ["STOP", "INT", "TERM", "CONT"];
    assert_eq!(ended_by(folder.path(), &["ball.json", "out.exr"], &signals), Some(143));
    assert_eq!(files(folder.path()), ["ball.json"]);
}

#[test]
fn a_signal_leaves_no_temporary_file() {
    let folder = folder();
    for signal in ["INT", "TERM"] {
        let knot = ["generate", "knot", "k.ply", "--triangles", "200M", "-q"];
        // It is in the list a moment after it is there.
        let output = interrupted(folder.path(), &knot, (".wavecrest-", 0.05), &[signal]);
        assert_eq!(output.status.code(), None, "a signal ended it");
        let told = format!("stopped by SIG{signal}; no file is written\n");
        assert_eq!(text(&output.stderr), told);
        assert_eq!(files(folder.path()), [""; 0]);
    }
}

/// A number from 0 to 1, another in each call and run.
fn random() -> f64 {
    use std::hash::{BuildHasher, Hasher};
    let word = std::collections::hash_map::RandomState::new().build_hasher().finish();
    word as f64 / u64::MAX as f64
}

/// How often a process is killed: `WAVECREST_KILLS`, or a few times.
fn kills() -> u32 {
    let asked = std::env::var("WAVECREST_KILLS").ok();
    asked.map_or(8, |count| count.parse().expect("WAVECREST_KILLS is a number"))
}

/// Only temporary files may be left besides `names`.
fn check_left(folder: &Path, names: &[&str]) {
    let all = files(folder);
    let is_known = |name: &String| {
        names.contains(&name.as_str())
            || (name.starts_with(".wavecrest-") && name.ends_with(".part"))
    };
    assert!(all.iter().all(is_known), "{all:?}");
}

#[test]
fn a_process_that_is_killed_leaves_the_older_image_or_the_new_one() {
    // Quick to render and slow to write: a third of the time goes into the file.
    let folder = with_scene(&ball([700, 700], 1).to_string());
    run_silently(folder.path(), &["ball.json", "old.pfm", "--seed", "1", "--crop", "0,0,600,700"]);
    let start = Instant::now();
    run_silently(folder.path(), &["ball.json", "new.pfm"]);
    let whole = start.elapsed().as_secs_f64();
    let (old, new) = (bytes(folder.path(), "old.pfm"), bytes(folder.path(), "new.pfm"));
    let (mut olds, mut news) = (0, 0);
    for _ in 0..kills() {
        std::fs::write(folder.path().join("out.pfm"), &old).expect("a file");
        let moment = random() * whole * 1.2;
        interrupted(folder.path(), &["ball.json", "out.pfm"], ("ball.json", moment), &["KILL"]);
        let found = bytes(folder.path(), "out.pfm");
        assert!(found == old || found == new, "neither, after {moment} s");
        if found == old {
            olds += 1
        } else {
            news += 1
        }
        check_left(folder.path(), &["ball.json", "old.pfm", "new.pfm", "out.pfm"]);
    }
    println!("killed {} times: {olds} times the older image, {news} times the new one", kills());
}

#[test]
fn a_render_killed_repeatedly_resumes_to_the_same_bytes() {
    let (folder, usual) = with_long();
    let resume = [&RENDER[..], &["--resume", "-q"]].concat();
    for _ in 0..kills() {
        let moment = 0.05 + random() * 0.3;
        interrupted(folder.path(), &resume, ("ball.json", moment), &["KILL"]);
        check_left(folder.path(), &["ball.json", "usual.exr", "kept", "out.exr"]);
        if folder.path().join("out.exr").exists() {
            assert!(bytes(folder.path(), "out.exr") == usual, "it was finished in between");
        }
    }
    run_silently(folder.path(), &resume);
    assert!(bytes(folder.path(), "out.exr") == usual);
}
