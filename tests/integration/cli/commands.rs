//! The commands besides `render`: `check`, `explain`, `diff` and `generate`.

use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::{Value, json};
use wavecrest_core::film::Film;
use wavecrest_core::plan::Effect;
use wavecrest_image::colormap::{diverging, magma};
use wavecrest_image::error_map::{MapKind, error_map};
use wavecrest_image::write::{Transfer, write};

use crate::support::{
    bytes, film, folder, json_in, matte, pinhole, point_light, put, put_texture, run, scene,
    sphere, text, with,
};

/// The exit code and what was said on standard output; on standard error, nothing may be said.
#[track_caller]
fn answer(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output = run(folder, arguments);
    assert_eq!(text(&output.stderr), "", "{arguments:?}");
    (output.status.code().expect("a code"), text(&output.stdout).to_owned())
}

/// The JSON that is printed by a command, which says nothing else.
#[track_caller]
fn json_of(folder: &Path, arguments: &[&str]) -> Value {
    let (_, found) = answer(folder, arguments);
    serde_json::from_str(&found).expect("JSON")
}

fn write_scene(folder: &Path, scene: &Value) {
    put(folder, "s.json", scene.to_string());
}

fn mirror_ball(kr: f64) -> Value {
    let ball = sphere([0.0; 3], 1.0, with(matte(0.8, [0.9, 0.3, 0.1]), "kr", kr));
    let light = point_light(40.0, [2.0, 3.0, 4.0], [1.0; 3]);
    scene(2, &pinhole([16, 12], 40.0, 5.0), &[light], &[ball])
}

#[test]
fn check_lists_the_files_that_it_read_each_once() {
    let folder = folder();
    put_texture(folder.path());
    let mesh = "v 9 0 1\nv 12.5 0 1\nv 12.5 2 1\nf 1 2 3\n";
    put(folder.path(), "m.obj", mesh);
    let mut scene = mirror_ball(0.0);
    scene["scene"]["shapes"][0]["texture"] = "t.png".into();
    let shape = json!({"type": "trimesh", "file": "m.obj", "material": matte(0.5, [0.5; 3])});
    for _ in 0..2 {
        scene["scene"]["shapes"].as_array_mut().expect("shapes").push(shape.clone());
    }
    write_scene(folder.path(), &scene);
    let (_, found) = answer(folder.path(), &["check", "s.json"]);
    let file = format!("  file              m.obj, {} B", mesh.len());
    for line in [file.as_str(), "  highest corner    12.5, 2, 1"] {
        assert_eq!(found.lines().filter(|l| *l == line).count(), 1, "{line}\n{found}");
    }
    let texture = found.lines().find(|line| line.contains("t.png")).expect("the texture");
    assert!(texture.starts_with("  texture ") && texture.ends_with(", 2 x 2"), "{texture}");
}

#[test]
fn explain_lists_the_passes_with_reasons() {
    let folder = folder();
    write_scene(folder.path(), &mirror_ball(0.5));
    let (code, found) = answer(folder.path(), &["explain", "s.json"]);
    assert_eq!(code, 0);
    for line in [
        "  + shadow              1 point light",
        "  +   mirror            1 mirror, nbounces 2",
        "  + advance             1 mirror, nbounces 2",
        "  -   lens              the camera is a pinhole",
        "  - textures            no shape has a texture",
        "  + spheres             1 sphere",
        "  - depth of field      the camera is a pinhole",
        "    fast                1 primitive, up to 768 rays",
        "                        768 rays per primitive: a good BVH pays off from 16",
    ] {
        assert!(found.lines().any(|l| l == line), "{line}\n{found}");
    }
    write_scene(folder.path(), &mirror_ball(0.0));
    let (_, found) = answer(folder.path(), &["explain", "s.json"]);
    let none = "no material has kr above 0, no material lets light through";
    assert!(found.contains(&format!("  - advance             {none}\n")), "{found}");
    assert!(found.contains("  - next rays                0  not needed\n"), "{found}");
    let part = format!("  -   differentials     no visible texture is trilinear, {none}\n");
    assert!(found.contains(&part), "{found}");
    let verdict: Vec<&str> = found.lines().take(3).collect();
    assert!(verdict[0].starts_with("about ") && verdict[0].ends_with(" s to trace"), "{found}");
    assert!(verdict[1].ends_with(" 192 camera, 29 shadow"), "{found}");
    assert!(verdict[2].ends_with(" of memory"), "{found}");
    assert!(!found.contains("0.000"), "{found}");
}

#[test]
fn explain_prints_json() {
    let folder = folder();
    write_scene(folder.path(), &mirror_ball(0.0));
    let found = json_of(folder.path(), &["explain", "s.json", "--json"]);
    let runs = |name: &str| {
        let passes = found["passes"].as_array().expect("passes");
        let pass = passes.iter().find(|pass| pass["name"] == name).expect("the pass");
        pass["runs"].as_bool().expect("yes or no")
    };
    assert!(runs("shadow") && runs("resolve") && !runs("mirror") && !runs("advance"));
    assert_eq!(found["plan"].as_array().map(Vec::len), Some(Effect::ALL.len()));
    let all = ["geometry", "appearance", "tree", "program"];
    let lasting: u64 = all.iter().map(|key| found["memory"][key].as_u64().expect("bytes")).sum();
    assert!(found["memory_total"].as_u64().expect("bytes") >= lasting);
    let columns = found["bytes_per_path"].as_array().expect("columns");
    let bytes = |name: &str| {
        let column = columns.iter().find(|column| column["name"] == name).expect("the column");
        column["bytes"].as_u64().expect("bytes")
    };
    assert!(bytes("lit points") > 0 && bytes("next rays") == 0);
    assert_eq!(found["rendered"], Value::Null);
}

#[test]
fn explain_prints_counts_beside_the_estimates() {
    let folder = folder();
    write_scene(folder.path(), &mirror_ball(0.5));
    let found = json_of(folder.path(), &["explain", "s.json", "--render", "--json"]);
    let (estimated, rendered) = (&found["estimated"], &found["rendered"]);
    assert_eq!(estimated["rays"], json!({"primary": 192, "secondary": 384, "shadow": 576}));
    assert_eq!(rendered["rays"]["primary"], 192);
    let counted = |key: &str| rendered["rays"][key].as_u64().expect("rays");
    assert!((1..=384).contains(&counted("secondary")) && (1..=576).contains(&counted("shadow")));
    for key in ["lens", "light", "texels"] {
        let samples = (&estimated["samples"][key], &rendered["samples"][key]);
        assert_eq!(samples, (&json!(0), &json!(0)), "{key}");
    }
    // A thread that had nothing to do holds no column.
    let [most, held] = [&found["memory"]["batches"], &rendered["batches"]].map(Value::as_u64);
    assert!(held > Some(0) && held <= most, "{held:?}, {most:?}");
    let (_, text) = answer(folder.path(), &["explain", "s.json", "--render"]);
    let line = |name: &str| {
        let line = text.lines().find(|line| line.trim_start().starts_with(name));
        line.unwrap_or_else(|| panic!("{name}\n{text}")).split_whitespace().collect::<Vec<_>>()
    };
    // The pilot has looked at every pixel of so small an image.
    assert_eq!(line("camera rays"), ["camera", "rays", "192", "192", "192"]);
    let mirrored = counted("secondary").to_string();
    assert_eq!(line("secondary rays")[3..], [mirrored.clone(), mirrored]);
}

#[test]
fn explain_and_the_statistics_of_a_render_agree_on_the_plan() {
    let folder = folder();
    write_scene(folder.path(), &mirror_ball(0.5));
    let explained = json_of(folder.path(), &["explain", "s.json", "--json"]);
    answer(folder.path(), &["-q", "s.json", "out.png", "--stats", "stats.json"]);
    let rendered = json_in(folder.path(), "stats.json");
    assert_eq!(explained["plan"], rendered["plan"]);
    assert_eq!(explained["bvh"]["preset"], rendered["bvh"]["preset"]);
    // A render also writes a file: 16 x 12 pixels of three channels.
    let [least, most] =
        [explained["estimated_total"].as_u64(), rendered["memory"]["predicted"].as_u64()];
    let written = most.zip(least).map(|(most, least)| most - least);
    assert_eq!(written, Some(16 * 12 * 3 * 2));
}

/// Two pictures that differ in one value.
fn write_pair(folder: &Path) {
    let mut film = Film::from_pixels(4, 3, vec![[0.5; 3]; 12]).expect("a film");
    write(&film, &folder.join("a.exr"), Transfer::Linear).expect("a file");
    film.pixels_mut()[6][1] = 0.75;
    write(&film, &folder.join("b.pfm"), Transfer::Linear).expect("a file");
}

#[test]
fn diff_answers_in_its_exit_code() {
    let folder = folder();
    write_pair(folder.path());
    let code = |arguments: &[&str]| answer(folder.path(), &[&["diff"], arguments].concat()).0;
    assert_eq!(code(&["a.exr", "a.exr"]), 0);
    assert_eq!(code(&["a.exr", "b.pfm"]), 1);
    assert_eq!(code(&["a.exr", "b.pfm", "--tolerance", "0.25"]), 0);
    assert_eq!(code(&["a.exr", "b.pfm", "--tolerance", "0.24"]), 1);
}

#[test]
fn diff_prints_the_place_and_size_of_the_largest_difference() {
    let folder = folder();
    write_pair(folder.path());
    let (_, found) = answer(folder.path(), &["diff", "a.exr", "b.pfm"]);
    assert!(found.contains("largest difference  0.250000, green at column 2, row 1\n"), "{found}");
    let found = json_of(folder.path(), &["diff", "a.exr", "b.pfm", "--json"]);
    assert_eq!((&found["largest"], &found["largest_at"]), (&json!(0.25), &json!([2, 1])));
    assert_eq!(found["different_pixels"], 1);
    answer(folder.path(), &["diff", "a.exr", "b.pfm", "-o", "d.exr", "--gain", "2"]);
    let difference = film(folder.path(), "d.exr");
    assert_eq!(difference.pixel(2, 1), Some([0.0, 0.5, 0.0]));
    assert_eq!(difference.pixel(1, 1), Some([0.0; 3]));
}

#[test]
fn diff_reports_flip_and_the_sign_of_the_bias() {
    let folder = folder();
    write_pair(folder.path());
    let found =
        |arguments: &[&str]| json_of(folder.path(), &[&["diff", "--json"], arguments].concat());
    let (there, back) = (found(&["a.exr", "b.pfm"]), found(&["b.pfm", "a.exr"]));
    assert_eq!(there["channel_bias"], json!([0.0, -0.25 / 12.0, 0.0]));
    assert_eq!(back["channel_bias"], json!([0.0, 0.25 / 12.0, 0.0]));
    let relative = |found: &Value| found["relative_mse"].as_f64().expect("a number");
    // 0.0625 / (0.75^2 + 0.01) / 36, or of 0.5^2, as the second picture is the reference.
    assert!((relative(&there) - 0.0625 / 0.5725 / 36.0).abs() < 1e-15);
    assert!((relative(&back) - 0.0625 / 0.26 / 36.0).abs() < 1e-15);
    assert_eq!(there["flip"], back["flip"]);
    assert!(there["flip"].as_f64().is_some_and(|flip| flip > 0.0 && flip < 0.5), "{there}");
    assert_eq!(found(&["a.exr", "a.exr"])["flip"], 0.0);
    let close = found(&["a.exr", "b.pfm", "--pixels-per-degree", "10"]);
    assert_eq!(close["flip_pixels_per_degree"], 10.0);
    assert_ne!(close["flip"], there["flip"]);
}

#[test]
fn diff_writes_maps_of_errors_in_colours() {
    let folder = folder();
    write_pair(folder.path());
    for (kind, middle) in [
        ("squared", magma(0.0625 / 3.0 * 4.0)),
        ("relative", magma(0.0625 / 0.5725 / 3.0 * 4.0)),
        ("signed", diverging(-0.25 / 3.0 * 4.0)),
    ] {
        let arguments = ["diff", "a.exr", "b.pfm", "--map", kind, "--gain", "4", "-o", "d.png"];
        assert_eq!(answer(folder.path(), &arguments).0, 1);
        let map = film(folder.path(), "d.png");
        let pixel = map.pixel(2, 1).expect("a pixel");
        for (found, expected) in pixel.into_iter().zip(middle) {
            assert!((found - expected).abs() <= 0.51 / 255.0, "{kind}: {found} {expected}");
        }
        let other = if kind == "signed" { diverging(0.0) } else { magma(0.0) };
        assert_eq!(map.pixel(1, 1), Some(other.map(|v| (v * 255.0).round() / 255.0)));
    }
    answer(folder.path(), &["diff", "a.exr", "b.pfm", "--map", "flip", "-o", "d.pfm"]);
    let map = film(folder.path(), "d.pfm");
    let [a, b] = ["a.exr", "b.pfm"].map(|name| film(folder.path(), name));
    assert!(map.same_bits(&error_map(&a, &b, MapKind::Flip, 1.0).expect("a map")));
}

#[test]
fn a_generated_mesh_can_be_rendered() {
    let folder = folder();
    for model in ["sphere", "knot", "terrain"] {
        let arguments = ["generate", model, "mesh.ply", "-n", "3k", "--normals"];
        let output = run(folder.path(), &arguments);
        assert_eq!((output.status.code(), text(&output.stdout)), (Some(0), ""));
        let told = text(&output.stderr);
        assert!(told.starts_with("mesh.ply: ") && told.contains(" triangles, "), "{told}");
        let mesh = json!({"type": "trimesh", "file": "mesh.ply", "shading": "smooth",
                          "material": matte(0.8, [1.0; 3])});
        let light = point_light(100.0, [5.0, 9.0, 7.0], [1.0; 3]);
        let camera = with(pinhole([24, 24], 60.0, 5.0), "location", json!([0.5, 2.5, 3]));
        write_scene(folder.path(), &scene(0, &camera, &[light], &[mesh]));
        assert_eq!(answer(folder.path(), &["s.json", "out.exr", "-q"]), (0, String::new()));
        let found = film(folder.path(), "out.exr");
        let lit = found.pixels().iter().filter(|p| p[0] > 0.1 && p[0] == p[2]).count();
        assert!(lit > 30, "{model}: {lit} pixels");
    }
}

#[test]
fn generate_writes_the_same_bytes_again_and_others_for_another_seed() {
    let folder = folder();
    let mesh = |seed: &str| {
        let arguments = ["generate", "terrain", "-o", "t.ply", "-n", "500", "--seed", seed, "-q"];
        assert_eq!(answer(folder.path(), &arguments), (0, String::new()));
        bytes(folder.path(), "t.ply")
    };
    let first = mesh("3");
    assert!(mesh("3") == first);
    assert!(mesh("4") != first);
}

#[test]
fn generate_leaves_an_older_file_when_it_cannot_go_on() {
    let folder = folder();
    put(folder.path(), "t.ply", "precious");
    let output = run(folder.path(), &["generate", "sphere", "t.ply", "-n", "900G"]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(text(&output.stderr).starts_with("error: "));
    assert_eq!(bytes(folder.path(), "t.ply"), b"precious");
}

#[test]
fn help_and_version_are_printed_to_standard_output() {
    let folder = folder();
    let (code, version) = answer(folder.path(), &["--version"]);
    assert_eq!((code, version), (0, format!("wavecrest {}\n", env!("CARGO_PKG_VERSION"))));
    let (code, help) = answer(folder.path(), &["--help"]);
    assert_eq!(code, 0);
    for command in ["render", "check", "explain", "generate", "diff", "bench", "trace"] {
        assert!(help.contains(&format!("\n  {command} ")), "{command}\n{help}");
    }
}

/// A reader that has seen enough, such as `head`, closes the pipe: that is no error and no panic.
#[test]
fn standard_output_may_be_closed_early() {
    let folder = folder();
    write_scene(folder.path(), &mirror_ball(0.5));
    for arguments in [&["explain", "s.json"][..], &["check", "s.json"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_wavecrest"))
            .args(arguments)
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the command starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""), "{arguments:?}");
    }
}
