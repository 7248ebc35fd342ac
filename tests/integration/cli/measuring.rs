//! The commands that measure: `bench` and `trace`. Times are not judged here; the work done and the
//! answers are.

use std::path::Path;

use glam::Vec3;
use serde_json::{Value, json};
use wavecrest_core::accel::Hit;
use wavecrest_core::math::ray::Ray;
use wavecrest_report::ray_file::RayFile;

use super::with_ball;
use crate::support::{folder, json_in, put, run, run_json, text};

#[test]
fn bench_times_both_tracers_on_equal_images() {
    let folder = with_ball();
    let arguments =
        ["bench", "ball.json", "ball.json", "--repeats", "2", "--min-time", "0", "--json"];
    let found = run_json(folder.path(), &[&arguments[..], &["-o", "bench.json"]].concat());
    let scenes = found["scenes"].as_array().expect("scenes");
    assert_eq!(scenes.len(), 2);
    for scene in scenes {
        assert_eq!(scene["equal"], true);
        assert_eq!(scene["rays"]["primary"], 16 * 12);
        let ladder = &scene["comparisons"][0];
        assert_eq!((&ladder["of"], &ladder["rounds"]), (&json!("ladder"), &json!(2)));
        let variants = ladder["variants"].as_array().expect("variants");
        let (first, last) = (&variants[0], &variants[variants.len() - 1]);
        assert_eq!(
            (&first["tracer"], &first["ratio"]["median"]),
            (&json!("recursive"), &json!(1.0))
        );
        // Rays that go through the tree together are tested together, so that `tests` may differ.
        let mut product = 1.0;
        for variant in variants {
            assert!(variant["tests"]["nodes"].as_u64() > Some(0), "{variant}");
            assert!(variant["seconds"]["median"].as_f64() > Some(0.0), "{variant}");
            product *= variant["gain"]["median"].as_f64().unwrap_or(1.0);
        }
        // The steps lead from the recursive tracer to the wavefront.
        let whole = last["ratio"]["median"].as_f64().expect("a ratio");
        assert!((product / whole - 1.0).abs() < 1e-12, "{product} {whole}");
        assert_eq!(last["tracer"], "wavefront");
        assert!(last["passes"]["intersect"].as_f64() > Some(0.0), "{last}");
    }
    let written = json_in(folder.path(), "bench.json");
    assert_eq!(written["scenes"], found["scenes"], "the file says what was printed");
}

#[test]
fn bench_prices_effects() {
    let folder = folder();
    let options = ["--repeats", "1", "--min-time", "0", "--width", "16", "--height", "12"];
    let arguments = [&["bench", "--effects", "--json", "-o", "prices.json"], &options[..]].concat();
    let found = run_json(folder.path(), &arguments);
    assert_eq!((&found["difference"], &found["rounds"]), (&Value::Null, &json!(1)));
    assert_eq!(found["image"], json!({"width": 16, "height": 12, "samples_per_pixel": 1}));
    let effects = found["effects"].as_array().expect("effects");
    for effect in effects {
        let has_base = effect["added_to"].is_string();
        for tracer in ["wavefront", "recursive"] {
            assert_eq!(effect[tracer]["price"].is_object(), has_base, "{effect}");
            assert!(effect[tracer]["seconds_per_mray"].as_f64() > Some(0.0), "{effect}");
        }
    }
    assert!(effects.iter().any(|effect| effect["reached"] == false));
    assert_eq!(json_in(folder.path(), "prices.json"), found);
}

#[test]
fn bench_compares_kernels_levels_batches_and_threads() {
    let folder = with_ball();
    let options = ["--repeats", "2", "--min-time", "0", "--kernel", "stream", "--threads", "2"];
    let what =
        ["bench", "ball.json", "--compare", "kernels,levels,threads,plan", "--batches", "16,65536"];
    let files = ["--page", "p.html", "--charts", "charts"];
    let found = run_json(folder.path(), &[&what[..], &options, &files, &["--json"]].concat());
    let scene = &found["scenes"][0];
    assert_eq!((&scene["equal"], &scene["kernel"]), (&json!(true), &json!("stream")));
    let comparisons = scene["comparisons"].as_array().expect("comparisons");
    let of: Vec<_> = comparisons.iter().map(|compared| &compared["of"]).collect();
    assert_eq!(of, ["ladder", "kernels", "levels", "threads", "plan", "batches"]);
    for compared in comparisons {
        assert_eq!((&compared["rounds"], &compared["difference"]), (&json!(2), &Value::Null));
        let variants = compared["variants"].as_array().expect("variants");
        assert_eq!(variants[0]["ratio"]["median"], 1.0);
        let usual = |v: &&Value| {
            let (kernel, batch) = (v["kernel"] == "stream", v["batch"] == 1024);
            v["tracer"] == "wavefront" && kernel && batch && v["threads"] == 2
        };
        assert!(variants.iter().any(|variant| usual(&variant)), "{compared}");
        for variant in variants {
            let rays: u64 = ["closest", "shadow"]
                .iter()
                .flat_map(|class| ["packet", "stream", "single"].map(|key| (class, key)))
                .filter_map(|(class, key)| variant["kernels"][class][key].as_u64())
                .sum();
            let all = ["primary", "secondary", "shadow"].map(|key| scene["rays"][key].as_u64());
            assert_eq!(rays, all.into_iter().flatten().sum::<u64>(), "{variant}");
        }
    }
    let column = |compared: &Value, key: &str| -> Vec<Value> {
        compared["variants"].as_array().expect("variants").iter().map(|v| v[key].clone()).collect()
    };
    assert_eq!(column(&comparisons[3], "threads"), [1, 1, 2, 2]);
    assert_eq!(column(&comparisons[5], "label"), ["recursive", "16", "1024", "65536"]);
    for name in ["ball-wavefront-by-batch-size.svg", "ball-both-tracers-by-threads.csv"] {
        assert!(folder.path().join("charts").join(name).is_file(), "{name}");
    }
    let output = run(folder.path(), &[&what[..], &options].concat());
    let text = text(&output.stdout);
    for words in ["The wavefront is ", "order ", "Wavefront by kernel", "bytes a path"] {
        assert!(text.contains(words), "{words}\n{text}");
    }
}

/// A unit square of two triangles in the plane z = 0, and rays along -z at these places.
fn write_rays(folder: &Path, any_hit: bool, answers: &[(f32, f32, Hit)]) {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
    put(folder, "m.obj", square);
    let ray = |x, y| Ray::new(Vec3::new(x, y, 2.0), Vec3::NEG_Z);
    let file = RayFile {
        any_hit,
        triangles: 2,
        rays: answers.iter().map(|&(x, y, _)| ray(x, y)).collect(),
        closest: answers.iter().map(|&(.., hit)| hit).collect(),
        occluded: answers.iter().map(|(.., hit)| !hit.is_miss()).collect(),
    };
    file.write(&folder.join("r.rays")).expect("a file");
}

const LOWER: Hit = Hit { t: 2.0, primitive: 0 };
const UPPER: Hit = Hit { t: 2.0, primitive: 1 };
const RAYS: [(f32, f32, Hit); 3] =
    [(0.75, 0.25, LOWER), (0.25, 0.75, UPPER), (1.25, 0.5, Hit::MISS)];

fn trace(folder: &Path, options: &[&str]) -> Value {
    let arguments = ["trace", "--mesh", "m.obj", "--rays", "r.rays", "--repeats", "1", "--json"];
    run_json(folder, &[&arguments, options].concat())
}

#[test]
fn trace_gives_the_right_answers_whatever_the_tracer_and_the_tree() {
    let folder = folder();
    for any_hit in [false, true] {
        write_rays(folder.path(), any_hit, &RAYS);
        for options in [
            &["--tracer", "wavefront"][..],
            &["--tracer", "recursive", "--threads", "2"],
            &["--bvh", "brute"],
            &["--kernel", "packet"],
            &["--kernel", "stream", "--simd", "auto"],
            &["--kernel", "single"],
        ] {
            let options = [options, &["--answers", "a.rays"]].concat();
            let found = trace(folder.path(), &options);
            assert_eq!((&found["rays"], &found["hits"]), (&json!(3), &json!(2)), "{options:?}");
            let taken = ["packet", "stream", "single"].map(|key| found["kernels"][key].as_u64());
            assert_eq!(taken.into_iter().flatten().sum::<u64>(), 3, "{options:?}");
            for (key, count) in found["compared"].as_object().expect("an object") {
                assert_eq!(count.as_f64(), Some(0.0), "{options:?}: {key}");
            }
            let answers = RayFile::read(&folder.path().join("a.rays")).expect("answers");
            assert_eq!(answers.closest, RAYS.map(|(.., hit)| hit));
            assert_eq!(answers.occluded, [true, true, false]);
        }
    }
}

/// And rays that cannot be traced, or are those of another mesh.
#[test]
fn trace_tells_answers_of_the_file_that_are_not_ours() {
    let folder = folder();
    let wrong = [
        (0.75, 0.25, UPPER),
        (0.25, 0.75, Hit { t: 1.5, primitive: 1 }),
        (0.5, 0.25, Hit::MISS),
        (1.25, 0.5, LOWER),
    ];
    write_rays(folder.path(), false, &wrong);
    let found = trace(folder.path(), &[]);
    for key in ["other_triangle", "other_distance", "extra", "lost", "extra_any", "lost_any"] {
        assert_eq!(found["compared"][key], 1, "{key}");
    }
    write_rays(folder.path(), false, &[RAYS[0], (1.8e38, 0.5, Hit::MISS)]);
    let shown = || run(folder.path(), &["trace", "--mesh", "m.obj", "--rays", "r.rays"]);
    let told = text(&shown().stdout).to_owned();
    assert!(told.contains(": 2 rays (closest hit), 1 hits, 1 invalid, "), "{told}");
    put(folder.path(), "m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    let refused = shown();
    let words = "r.rays: the rays are for another mesh, found rays for 2 triangles; m.obj has 1";
    let expected = (Some(2), format!("error: {words}\n"));
    assert_eq!((refused.status.code(), text(&refused.stderr).to_owned()), expected);
}
