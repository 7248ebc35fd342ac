//! The command that tries hard cases.

use std::path::PathBuf;

use serde_json::Value;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::examine::{SceneTrial, trial};
use wavecrest_report::selftest::{Count, Effort};
use wavecrest_scene::load::{LoadOptions, load};
use wavecrest_scene::systems::{Options, extract};

use super::{ball, with_ball};
use crate::support::{edited, files_in, folder, put, repository, run, run_json, scene_files, text};

#[test]
fn a_case_is_reported_with_its_count_and_its_bound() {
    let folder = folder();
    let output = run(folder.path(), &["selftest", "--case", "26", "--case", "5"]);
    assert_eq!(text(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
    let lines: Vec<&str> = text(&output.stdout).lines().collect();
    assert_eq!(lines[1..3], ["exact passes all 2 cases", ""]);
    let row = |start: &str| {
        let row = lines.iter().find(|line| line.starts_with(start));
        row.unwrap_or_else(|| panic!("{start}: {lines:#?}")).split("  ").collect::<Vec<_>>()
    };
    let words = |start: &str| {
        let cells = row(start).into_iter().map(str::trim).filter(|cell| !cell.is_empty());
        cells.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(words("case"), ["case", "input", "fast", "exact"]);
    assert_eq!(words("  26")[2..], ["pass", "pass"]);
    // Fast arithmetic loses hits there.
    let of_5 = words("   5");
    assert!(of_5[2].ends_with(" %"), "{of_5:?}");
    assert_eq!(of_5[3], "pass");
}

#[test]
fn failures_in_fast_precision_are_expected() {
    let arguments = ["selftest", "--case", "1"];
    let output = run(folder().path(), &arguments);
    assert_eq!(output.status.code(), Some(0));
    let told = text(&output.stdout);
    assert!(told.starts_with("fast fails in 1 of 1 case, as expected\n"), "{told}");
    assert!(told.contains(" %") && !told.contains("FAIL") && !told.contains("Ray {"), "{told}");
    assert!(!told.contains("the first"), "{told}");
    // Who asks for it alone wants to know.
    let output = run(folder().path(), &[&arguments[..], &["--precision", "fast"]].concat());
    let told = text(&output.stdout);
    let again = "  again: wavecrest selftest --case 1 --precision fast --seed 1\n";
    assert!(told.contains("  the first: ") && told.contains(again), "{told}");
    assert!(told.contains("a ray from ") && !told.contains("Ray {"), "{told}");
}

#[test]
fn a_missing_file_is_reported_before_any_case_runs() {
    let start = std::time::Instant::now();
    let output = run(folder().path(), &["selftest", "missing.ply", "-q"]);
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(2), ""));
    assert!(text(&output.stderr).contains("missing.ply"), "{}", text(&output.stderr));
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
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

#[test]
fn the_scoreboard_is_there_as_json() {
    let folder = folder();
    let board = run_json(folder.path(), &["selftest", "--case", "26", "--seed", "7", "--json"]);
    assert_eq!((&board["seed"], &board["full"]), (&Value::from(7), &Value::from(false)));
    let case = &board["cases"][0];
    assert_eq!(case["case"], 26);
    for (i, precision) in ["fast", "exact"].into_iter().enumerate() {
        let trial = &case["trials"][i];
        assert_eq!((&trial["precision"], &trial["holds"]), (&precision.into(), &true.into()));
        assert_eq!((&trial["tried"], &trial["failed"]), (&Value::from(1000), &Value::from(0)));
        assert_eq!(trial["first"], Value::Null);
    }
}
