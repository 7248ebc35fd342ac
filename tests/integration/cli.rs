//! The command, run as a user runs it: arguments, formats, exit codes, messages, and what is left
//! behind when something fails.

use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::{Value, json};
use tempfile::TempDir;
use wavecrest::image::Film;
use wavecrest::image::read::read;

use crate::support::{
    folder, image, matte, pinhole, point_light, scene, sphere, wall, wavecrest, with,
};

/// A ball before a wall: 16 x 12 pixels, one light, one bounce.
fn ball() -> Value {
    let mirror = with(matte(0.7, [0.9, 0.3, 0.1]), "kr", 0.25);
    let shapes = [sphere([0.0; 3], 1.0, mirror), wall(4.0, -2.0, matte(0.8, [0.2, 0.4, 0.9]))];
    scene(
        1,
        &pinhole([16, 12], 40.0, 5.0),
        &[point_light(40.0, [2.0, 3.0, 4.0], [1.0; 3])],
        &shapes,
    )
}

/// A folder with the scene as `ball.json`.
fn with_ball() -> TempDir {
    with_scene(&ball().to_string())
}

fn with_scene(text: &str) -> TempDir {
    let folder = folder();
    std::fs::write(folder.path().join("ball.json"), text).expect("a file");
    folder
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    wavecrest(folder).args(arguments).output().expect("the command runs")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

/// Runs the command, which must succeed and say nothing; returns nothing.
#[track_caller]
fn run_silently(folder: &Path, arguments: &[&str]) {
    let output = run(folder, arguments);
    assert_eq!(text(&output.stderr), "", "{arguments:?}");
    assert_eq!(text(&output.stdout), "", "{arguments:?}");
    assert_eq!(output.status.code(), Some(0), "{arguments:?}");
}

/// Runs the command, which must fail with exactly this message.
#[track_caller]
fn run_wrongly(folder: &Path, arguments: &[&str], message: &str) {
    let output = run(folder, arguments);
    assert_eq!(text(&output.stderr), format!("error: {message}\n"), "{arguments:?}");
    assert_eq!(text(&output.stdout), "", "{arguments:?}");
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
}

/// The names of the files in a folder.
fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |e: std::io::Result<std::fs::DirEntry>| e.expect("an entry").file_name();
    let mut names: Vec<String> = entries.map(|e| name(e).to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn film(path: PathBuf) -> Film {
    read(&path).unwrap_or_else(|error| panic!("{error}"))
}

// Rendering.

#[test]
fn a_scene_and_an_output_are_all_it_takes() {
    let folder = with_ball();
    for arguments in [
        &["ball.json", "out.ppm"][..],
        &["render", "ball.json", "out.ppm"],
        &["render", "ball.json", "-o", "out.ppm"],
        &["ball.json", "--output", "out.ppm"],
    ] {
        run_silently(folder.path(), arguments);
        let bytes = std::fs::read(folder.path().join("out.ppm")).expect("an image");
        assert!(bytes.starts_with(b"P6\n16 12\n255\n") && bytes.len() == 13 + 16 * 12 * 3);
        std::fs::remove_file(folder.path().join("out.ppm")).expect("it is there");
        assert_eq!(files(folder.path()), ["ball.json"], "nothing else is left behind");
    }
}

#[test]
fn float_formats_hold_the_image_to_the_last_bit_and_8_bits_its_levels() {
    let folder = with_ball();
    let expected = image(&ball());
    for name in ["out.exr", "out.pfm", "OUT.EXR"] {
        run_silently(folder.path(), &["ball.json", name]);
        assert!(film(folder.path().join(name)).same_bits(&expected), "{name}");
    }
    for name in ["out.ppm", "out.png"] {
        run_silently(folder.path(), &["ball.json", name]);
        let found = film(folder.path().join(name));
        for (a, b) in found.pixels().as_flattened().iter().zip(expected.pixels().as_flattened()) {
            assert_eq!((a * 255.0).round(), (b.clamp(0.0, 1.0) * 255.0).round(), "{name}");
        }
    }
}

#[test]
fn the_srgb_transfer_brightens_8_bits_and_leaves_floats_alone() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "linear.png"]);
    run_silently(folder.path(), &["ball.json", "srgb.png", "--transfer", "srgb"]);
    run_silently(folder.path(), &["ball.json", "srgb.exr", "--transfer", "srgb"]);
    let at = |name: &str| film(folder.path().join(name));
    // The background, 0.125, becomes 0.3885.
    let corner = |name| at(name).pixel(0, 0).expect("a pixel")[0];
    let (linear, encoded) = (corner("linear.png"), corner("srgb.png"));
    assert!(linear < encoded, "{linear} {encoded}");
    assert!(at("srgb.exr").same_bits(&image(&ball())));
}

#[test]
fn no_choice_of_how_to_render_changes_a_byte() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "usual.exr"]);
    let usual = std::fs::read(folder.path().join("usual.exr")).expect("an image");
    for options in [
        &["--tracer", "recursive"][..],
        &["--tracer", "wavefront", "--batch", "7"],
        &["--threads", "1"],
        &["--threads", "3", "--bvh", "brute"],
        &["--bvh", "very-slow", "--seed", "9"],
    ] {
        run_silently(folder.path(), &[&["ball.json", "out.exr"], options].concat());
        let found = std::fs::read(folder.path().join("out.exr")).expect("an image");
        assert!(found == usual, "{options:?}");
    }
}

#[test]
fn a_crop_and_a_size_choose_what_is_rendered() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "whole.pfm"]);
    run_silently(folder.path(), &["ball.json", "part.pfm", "--crop", "3,2,5,4"]);
    let (whole, part) =
        (film(folder.path().join("whole.pfm")), film(folder.path().join("part.pfm")));
    assert_eq!((part.width(), part.height()), (5, 4));
    for (x, y) in (0..4).flat_map(|y| (0..5).map(move |x| (x, y))) {
        assert_eq!(part.pixel(x, y), whole.pixel(x + 3, y + 2));
    }
    run_silently(folder.path(), &["ball.json", "small.pfm", "--width", "8", "--height", "6"]);
    let small = film(folder.path().join("small.pfm"));
    assert_eq!((small.width(), small.height()), (8, 6));
}

#[test]
fn paths_in_a_scene_start_from_its_folder() {
    let folder = folder();
    let (inner, outer) = (folder.path().join("scenes"), folder.path().join("elsewhere"));
    std::fs::create_dir_all(&inner).expect("a folder");
    std::fs::create_dir_all(&outer).expect("a folder");
    std::fs::write(inner.join("m.obj"), "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n").expect("a file");
    let mesh = json!({"type": "trimesh", "file": "m.obj", "material": matte(0.8, [1.0; 3])});
    let scene = scene(0, &pinhole([8, 8], 40.0, 5.0), &[], &[mesh]);
    std::fs::write(inner.join("s.json"), scene.to_string()).expect("a file");
    run_silently(&outer, &["../scenes/s.json", "out.exr"]);
    assert_eq!(film(outer.join("out.exr")).pixel(4, 4), Some([0.0; 3]), "the mesh, unlit");
    assert_eq!(files(&inner), ["m.obj", "s.json"], "the output is where the command was run");
}

#[test]
fn names_may_have_spaces_and_letters_of_any_script() {
    let folder = with_ball();
    for name in ["my scene", "балл", "-ball", "render"] {
        let file = format!("{name}.json");
        std::fs::copy(folder.path().join("ball.json"), folder.path().join(&file)).expect("a copy");
        let output = format!("out of {name}.png");
        run_silently(folder.path(), &["render", "-o", &output, "--", &file]);
        assert!(folder.path().join(output).exists());
    }
}

#[test]
#[cfg(target_os = "linux")]
fn names_need_not_be_unicode() {
    use std::os::unix::ffi::OsStrExt;
    let folder = with_ball();
    let name = |suffix: &str| {
        let bytes = [b"b\xffll".as_slice(), suffix.as_bytes()].concat();
        std::ffi::OsStr::from_bytes(&bytes).to_owned()
    };
    std::fs::copy(folder.path().join("ball.json"), folder.path().join(name(".json")))
        .expect("a copy");
    let mut command = wavecrest(folder.path());
    let output = command.arg(name(".json")).arg(name(".png")).output().expect("the command runs");
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    assert!(folder.path().join(name(".png")).exists());
}

// Statistics.

/// Every key that the documentation of the statistics names, as JSON pointers.
const STATISTICS: [&str; 39] = [
    "/version",
    "/scene",
    "/tracer",
    "/threads",
    "/seed",
    "/image/width",
    "/image/height",
    "/image/samples_per_pixel",
    "/rays/primary",
    "/rays/secondary",
    "/rays/shadow",
    "/samples/lens",
    "/samples/light",
    "/samples/texels",
    "/tests/nodes",
    "/tests/primitives/triangles",
    "/tests/primitives/quads",
    "/tests/primitives/spheres",
    "/dropped/degenerate",
    "/invalid",
    "/lights_at_surface",
    "/time/load",
    "/time/build",
    "/time/trace",
    "/time/write",
    "/time/total",
    "/time/passes/generate",
    "/time/passes/intersect",
    "/time/passes/shade",
    "/time/passes/shadow",
    "/time/passes/resolve",
    "/memory/predicted",
    "/memory/peak",
    "/bvh/preset",
    "/bvh/nodes",
    "/bvh/depth",
    "/bvh/bytes",
    "/plan/0/effect",
    "/plan/0/reason",
];

fn statistics(folder: &Path, options: &[&str]) -> Value {
    run_silently(folder, &[&["ball.json", "out.exr", "--stats", "stats.json"], options].concat());
    let text = std::fs::read_to_string(folder.join("stats.json")).expect("statistics");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn statistics_have_every_key_that_their_documentation_names() {
    let folder = with_ball();
    let found = statistics(folder.path(), &["--threads", "2", "--seed", "5"]);
    for key in STATISTICS {
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
}

#[test]
fn statistics_of_the_recursive_tracer_count_the_same_work() {
    let folder = with_ball();
    let [wavefront, recursive] = ["wavefront", "recursive"]
        .map(|tracer| statistics(folder.path(), &["--tracer", tracer, "--crop", "2,2,9,7"]));
    assert_eq!(recursive["tracer"], "recursive");
    for key in ["image", "rays", "samples", "tests", "plan", "dropped"] {
        assert_eq!(wavefront[key], recursive[key], "{key}");
    }
    assert_eq!(recursive["image"]["width"], 9);
    assert!(recursive.pointer("/time/passes/recursive").is_some());
}

// Failures.

#[test]
fn a_missing_scene_is_named() {
    let folder = folder();
    let message = "no.json: cannot read the scene: No such file or directory (os error 2)";
    run_wrongly(folder.path(), &["no.json", "out.png"], message);
    run_wrongly(folder.path(), &["check", "no.json"], message);
    run_wrongly(folder.path(), &["explain", "no.json"], message);
    assert!(files(folder.path()).is_empty());
}

#[test]
fn bad_json_is_placed() {
    let folder = with_scene("{\n  \"nbounces\": 0,\n  \"camera\" 3\n}");
    let message = "ball.json: line 3 column 12: not valid JSON: expected `:`";
    run_wrongly(folder.path(), &["ball.json", "out.png"], message);
    let folder = with_scene("");
    let message = "ball.json: line 1 column 0: not valid JSON: EOF while parsing a value";
    run_wrongly(folder.path(), &["ball.json", "out.png"], message);
}

#[test]
fn an_unknown_format_is_told_before_the_scene_is_read() {
    let folder = folder();
    run_wrongly(
        folder.path(),
        &["no.json", "out.pmp"],
        "out.pmp: unknown image format, found .pmp; \
         did you mean .ppm? use .ppm, .png, .exr or .pfm",
    );
    run_wrongly(
        folder.path(),
        &["no.json", "out"],
        "out: the name of an image must end in its format; use .ppm, .png, .exr or .pfm",
    );
}

#[test]
fn a_misspelt_key_is_a_warning_with_what_may_be_meant_and_an_error_where_that_is_asked_for() {
    let mut scene = ball();
    scene["scene"]["shapes"][0]["materail"] = json!({});
    let folder = with_scene(&scene.to_string());
    let said = |options: &[&str]| {
        let output = run(folder.path(), &[&["ball.json", "out.png"], options].concat());
        (output.status.code(), text(&output.stderr).to_owned())
    };
    let place = "ball.json: scene.shapes[0].materail: is not a key of a sphere, found {}";
    assert_eq!(said(&[]), (Some(0), format!("warning: {place}; it is ignored\n")));
    assert_eq!(said(&["-q"]), (Some(0), String::new()));
    assert_eq!(said(&["--strict"]), (Some(2), format!("error: {place}; remove it\n")));
}

#[test]
fn a_required_key_that_is_misspelt_is_an_error_that_names_it() {
    let mut scene = ball();
    let sphere = scene["scene"]["shapes"][0].as_object_mut().expect("an object");
    let radius = sphere.remove("radius").expect("a radius");
    sphere.insert("raduis".to_owned(), radius);
    let folder = with_scene(&scene.to_string());
    let output = run(folder.path(), &["ball.json", "out.png"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        text(&output.stderr),
        "error: ball.json: scene.shapes[0].radius: is missing; is it the key \"raduis\", misspelt?\n"
    );
}

#[test]
fn a_bad_value_is_placed_with_what_would_be_right() {
    let mut scene = ball();
    scene["scene"]["shapes"][0]["radius"] = json!(-2);
    let folder = with_scene(&scene.to_string());
    let message = "ball.json: scene.shapes[0].radius: \
                   must be a number above 0 and at most 1099511627776, found -2";
    run_wrongly(folder.path(), &["ball.json", "out.png"], message);
    scene["scene"]["shapes"][0] = json!({"type": "spere"});
    let folder = with_scene(&scene.to_string());
    let message = "ball.json: scene.shapes[0].type: \
                   must be \"sphere\", \"plane\", \"triangle\" or \"trimesh\", found \"spere\"; \
                   did you mean \"sphere\"?";
    run_wrongly(folder.path(), &["ball.json", "out.png"], message);
}

#[test]
fn an_output_that_cannot_be_written_is_told_before_the_scene_is_read() {
    let folder = folder();
    run_wrongly(
        folder.path(),
        &["no.json", "none/out.png"],
        "none/out.png: cannot write the file: there is no folder none; \
         create it first or name one that exists",
    );
    std::fs::create_dir(folder.path().join("dir.png")).expect("a folder");
    run_wrongly(
        folder.path(),
        &["no.json", "dir.png"],
        "dir.png: cannot write the file: this is a folder; name a file inside it",
    );
    run_wrongly(
        folder.path(),
        &["no.json", "-o", "-"],
        "-: an image cannot be written to standard output; \
         name a file that ends in .ppm, .png, .exr or .pfm",
    );
}

#[test]
fn an_older_image_stays_when_the_render_fails() {
    let folder = with_ball();
    std::fs::write(folder.path().join("out.png"), "precious").expect("a file");
    let old = || std::fs::read_to_string(folder.path().join("out.png")).expect("it is there");
    run_wrongly(
        folder.path(),
        &["ball.json", "out.png", "--crop", "10,10,8,8"],
        "the crop must have pixels and lie within the image, found 10,10,8,8; \
         the image is 16 x 12; give x,y,width,height",
    );
    assert_eq!(old(), "precious");
    run_wrongly(
        folder.path(),
        &["ball.json", "out.png", "--stats", "none/stats.json"],
        "none/stats.json: cannot write the file: there is no folder none; \
         create it first or name one that exists",
    );
    assert_eq!(old(), "precious");
    assert_eq!(files(folder.path()), ["ball.json", "out.png"], "nothing else is left behind");
}

#[test]
fn arguments_that_make_no_sense_are_refused() {
    let folder = with_ball();
    for (arguments, told) in [
        (&["ball.json"][..], "required arguments were not provided"),
        (&["ball.json", "a.png", "-o", "b.png"], "cannot be used with"),
        (&["ball.json", "a.png", "--crop", "1,2,3"], "write four whole numbers"),
        (&["ball.json", "a.png", "--tracer", "recursiv"], "'recursive'"),
        (&["ball.json", "a.png", "--threads", "0"], "0 is not in 1..=4096"),
        (&["ball.json", "a.png", "--batch", "0"], "0 is not in 1..=1048576"),
        (&["ball.json", "a.png", "--bvh", "quick"], "possible values: brute, fastest"),
        (&[], "Usage: wavecrest"),
    ] {
        let output = run(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(told), "{arguments:?}: {}", text(&output.stderr));
    }
    assert_eq!(files(folder.path()), ["ball.json"]);
}
