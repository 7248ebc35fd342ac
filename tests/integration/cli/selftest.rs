//! The command that tries hard cases.

use std::path::PathBuf;

use serde_json::Value;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::examine::{SceneTrial, trial};
use wavecrest_report::selftest::{Count, Effort};
use wavecrest_scene::load::{LoadOptions, load};
use wavecrest_scene::systems::{Options, extract};

use super::{ball, with_ball};
use crate::support::{
    blessing, edited, files_in, folder, put, repository, run, run_json, scene_files, text,
};

/// Where the bits of each case are recorded.
const RECORDED: &str = "crates/report/src/selftest/recorded.txt";

/// `WAVECREST_BLESS=1 cargo test --test integration selftest` records the bits that are found.
#[test]
fn this_machine_finds_the_recorded_bits() {
    let output = run(folder().path(), &["selftest", "--precision", "exact", "--json", "-q"]);
    let board: Value = serde_json::from_str(text(&output.stdout)).expect("JSON");
    let cases = board["cases"].as_array().expect("cases").iter();
    let parts: Vec<&Value> =
        cases.flat_map(|case| case["exact"].as_array().expect("parts")).collect();
    let string = |part: &Value, key: &str| part[key].as_str().unwrap_or_default().to_owned();
    if blessing() {
        let lines =
            parts.iter().map(|part| string(part, "name") + ": " + &string(part, "bits") + "\n");
        std::fs::write(repository(RECORDED), lines.collect::<String>()).expect("a file");
        return;
    }
    let failed = parts.iter().filter(|part| part["failed"] != 0).map(|part| string(part, "first"));
    assert_eq!(failed.collect::<Vec<_>>(), [""; 0]);
    assert_eq!(output.status.code(), Some(0));
    let recorded = std::fs::read_to_string(repository(RECORDED)).expect("a file");
    assert_eq!(recorded.lines().count(), parts.len(), "a line for each part, and no more");
}

#[test]
fn a_mesh_of_the_users_own_is_tried() {
    let folder = folder();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    put(folder.path(), "t.obj", [corners, "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"].concat());
    let board = run_json(folder.path(), &["selftest", "--case", "26", "--json", "t.obj"]);
    let shape = &board["scene"]["shape"];
    assert_eq!((&shape["triangles"], &shape["borders"]), (&Value::from(4), &Value::from(0)));
    let [fast, exact] = [0, 1].map(|i| &board["scene"]["trials"][i]);
    assert!(fast["leaks"]["failed"].as_u64() > Some(0), "{fast}");
    assert!(exact["leaks"]["tried"].as_u64() > Some(100_000), "{exact}");
    let failed = [&exact["leaks"]["failed"], &exact["self_hits"]["failed"]];
    assert_eq!(failed, [&Value::from(0); 2]);
    let agreement = &exact["agreement"];
    assert!(agreement["tried"].as_u64() > Some(100_000), "{exact}");
    assert_eq!((&agreement["failed"], &fast["agreement"]), (&Value::from(0), &Value::Null));
}

/// Spheres, instances, a light alone, and nothing at all.
#[test]
fn scenes_of_any_shapes_are_tried() {
    let folder = with_ball();
    put(folder.path(), "light.json", edited(ball(), "/scene/shapes []").to_string());
    let tried = |file: &str| {
        let output = run(folder.path(), &["selftest", "--case", "26", file]);
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""), "{file}");
        let told = text(&output.stdout);
        let (_, told) = told.split_once(&format!("{file}: ")).expect("the file is named");
        told.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let without = ["fast   ", "exact  "].map(|name| format!("    {name}0 samples are not finite"));
    let empty = repository("scenes/hard/empty.json").display().to_string();
    for file in ["light.json", &empty] {
        let lines = tried(file);
        assert_eq!((&lines[0][..], &lines[1..]), ("no shapes, so no rays to test", &without[..]));
    }
    let instances = repository("scenes/instances.json").display().to_string();
    for (file, shapes) in [("ball.json", "spheres"), (&instances, "triangles of instances")] {
        let lines = tried(file);
        assert!(lines[0].contains(shapes), "{lines:?}");
        let exact = lines.iter().find(|line| line.starts_with("    exact ")).expect("a line");
        assert!(exact.contains(" 0 of ") && exact.contains("rays leak"), "{exact}");
        let last = lines.last().expect("a line");
        let differing = " answers at edges and vertices differ from the reference's";
        assert!(last.starts_with("      0 of ") && last.ends_with(differing), "{lines:?}");
    }
}

/// What `selftest` does with a file, on every scene: no panic, no leak and no self-hit.
#[test]
fn every_scene_is_tried() {
    let mut files: Vec<PathBuf> = scene_files().into_iter().map(|(_, path)| path).collect();
    files.extend(files_in("scenes/gltf", "gltf"));
    let size = LoadOptions { width: Some(1), height: Some(1), ..LoadOptions::default() };
    let mut asked = 0;
    for file in files {
        for precision in Precision::ALL {
            let loaded = load(&file, &size).expect("a scene");
            let options = Options { precision, ..Options::default() };
            let extracted = extract(loaded.world, options).expect("a scene");
            let preset = extracted.preset();
            let accel = extracted.build(preset).accel;
            let effort = Effort { precision, seed: 1, count: Count::Brief };
            let has_shapes = !accel.geometry().is_empty();
            let SceneTrial { leaks, self_hits, .. } = trial(&accel, &effort);
            assert_eq!(self_hits.tried > 0, has_shapes, "{}", file.display());
            asked += leaks.tried;
            for outcome in [leaks, self_hits] {
                let is_right = outcome.failed == 0 || precision == Precision::Fast;
                assert!(is_right, "{}, {}: {outcome:?}", file.display(), precision.name());
            }
        }
    }
    assert!(asked > 10_000, "{asked}");
}
