//! What files, layers, looks and sheets take beside the image, estimated and measured.

use std::path::Path;

use crate::support::{folder, json_in, matte, pinhole, put, run_well, scene, wall};

/// What an option may take beyond its estimate: pages of the allocator, and the bands of a pass over the camera rays.
const SLACK: f64 = 8e6;

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
