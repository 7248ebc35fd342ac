//! What files, layers, looks and sheets take beside the image, estimated and measured.

use std::path::Path;

use crate::support::{folder, json_in, matte, pinhole, put, run, run_well, scene, text, wall};

/// What an option may take beyond its estimate: pages of the allocator, and the bands of a pass over the camera rays.
const SLACK: f64 = 8e6;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n";

/// The estimated and the measured peak of a render.
fn peaks(folder: &Path, options: &[&str]) -> [f64; 2] {
    let threads: &[&str] = if options.contains(&"--threads") { &[] } else { &["--threads", "1"] };
    let arguments = ["s.json", "--stats", "stats.json", "-q"];
    run_well(folder, &[&arguments[..], options, threads].concat());
    let stats = json_in(folder, "stats.json");
    ["predicted", "peak"].map(|key| stats["memory"][key].as_f64().expect(key))
}

#[test]
fn what_is_written_is_in_the_estimate() {
    let folder = folder();
    let wall = wall(4.0, -2.0, matte(0.8, [0.2, 0.4, 0.9]));
    let dark = scene(0, &pinhole([2000, 1000], 40.0, 5.0), &[], &[wall]);
    put(folder.path(), "s.json", dark.to_string());
    let [least, usual] = peaks(folder.path(), &["o.ppm"]);
    for options in [
        &["o.exr"][..],
        &["o.ppm", "--also", "o.exr"],
        &["o.exr", "--threads", "16"],
        &["o.exr", "--aov", "depth,object"],
        &["o.exr", "--aov", "all"],
        &["o.ppm", "--exposure", "1"],
        &["o.ppm", "--as", "normals"],
        &["o.ppm", "--as", "depth", "--crop", "0,0,100,100"],
        &["o.ppm", "--checkpoint", "kept"],
    ] {
        let [estimated, peak] = peaks(folder.path(), options);
        let (estimated, more) = (estimated - least, peak - usual);
        let is_near = more <= estimated + SLACK && more >= estimated * 0.3 - SLACK;
        assert!(is_near, "{options:?}: {more} bytes, {estimated} estimated");
        assert!(estimated > SLACK || options.contains(&"--crop"), "{options:?}: {estimated}");
    }
}

/// Of an image that is cut, only what is left has memory.
#[test]
fn outputs_that_need_more_than_is_allowed_are_refused() {
    let folder = folder();
    put(folder.path(), "t.obj", TRIANGLE);
    let sides = ["front"; 36].join(",");
    let told = |options: &[&str]| {
        let limits =
            ["t.obj", "--lights", "none", "--threads", "1", "-q", "--memory-limit", "60MB"];
        let found = run(folder.path(), &[&limits[..], options].concat());
        (found.status.code(), text(&found.stderr).to_owned())
    };
    let (small, large) = (["--size", "800x600"], ["--size", "16000x16000"]);
    assert_eq!(told(&[&small[..], &["plain.ppm"]].concat()), (Some(0), String::new()));
    let cut = ["cut.ppm", "--crop", "7000,7000,64,64"];
    assert_eq!(told(&[&large[..], &cut].concat()), (Some(0), String::new()));
    for (size, options, words) in [
        (large, &["o.ppm"][..], "the image 2.9 GiB"),
        (large, &["o.ppm", "--crop", "7000,7000,6000,6000"], "the image 412.0 MiB"),
        (small, &["o.exr", "--aov", "all"], "writing files "),
        (small, &["o.ppm", "--also", "o.exr", "--aov", "all"], "writing files "),
        (small, &["o.png", "--sheet", &sides], "writing files "),
        (small, &["o#.exr", "--turntable", "2", "--aov", "all"], "writing files "),
    ] {
        let (code, text) = told(&[&size[..], options].concat());
        assert_eq!(code, Some(2), "{options:?}: {text}");
        assert!(text.contains("the render needs more memory than 57.2 MiB"), "{text}");
        assert!(text.contains(words), "{text}");
    }
    let left = std::fs::read_dir(folder.path()).expect("a folder");
    assert_eq!(left.count(), 3, "nothing is written");
}
