//! `wavecrest SCENE OUTPUT`.

use std::path::Path;

use serde_json::json;
use wavecrest_core::math::simd::Level;

use super::{ball, files, run_silently, with_ball};
use crate::support::{
    bytes, film, folder, image, json_in, matte, pinhole, places, point_light, put, run, scene,
    text, wavecrest, with,
};

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
        assert!(film(folder.path(), name).same_bits(&expected), "{name}");
    }
    for name in ["out.ppm", "out.png"] {
        run_silently(folder.path(), &["ball.json", name]);
        let found = film(folder.path(), name);
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
    let at = |name: &str| film(folder.path(), name);
    // The background, 0.125, becomes 0.3885.
    let corner = |name| at(name).pixel(0, 0).expect("a pixel")[0];
    let (linear, encoded) = (corner("linear.png"), corner("srgb.png"));
    assert!(linear < encoded, "{linear} {encoded}");
    assert!(at("srgb.exr").same_bits(&image(&ball())));
}

/// A knot of which the image shows a part, so that rays build a part of its tree.
fn put_knot(folder: &Path) {
    run_silently(folder, &["generate", "knot", "knot.ply", "--triangles", "200000", "-q"]);
    let camera = with(pinhole([64, 48], 3.0, 6.0), "look", [1.0, 0.0, 0.0]);
    let mesh = json!({"type": "trimesh", "file": "knot.ply", "material": matte(1.0, [0.5; 3])});
    let light = point_light(50.0, [3.0, 3.0, 5.0], [1.0; 3]);
    put(folder, "knot.json", scene(1, &camera, &[light], &[mesh]).to_string());
}

/// Options as a user writes them, levels of this machine among them; and trees that rays build.
#[test]
fn no_choice_of_how_to_render_changes_a_byte() {
    let folder = with_ball();
    put_knot(folder.path());
    let ball = [
        "--tracer recursive",
        "--tracer wavefront --batch 7",
        "--threads 1",
        "--threads 3 --bvh brute",
        "--bvh very-slow",
        "--kernel auto --simd auto",
        "--kernel packet",
        "--kernel stream --batch 50",
        "--kernel single --threads 2",
        "--kernel reference --tracer wavefront",
        "--kernel reference --tracer recursive",
        "--precision exact",
        "--precision robust",
        "--save-every 1e-9",
    ];
    let levels = Level::available().into_iter().flat_map(|level| {
        ["wavefront", "recursive"]
            .map(|tracer| format!("--simd {} --tracer {tracer}", level.name()))
    });
    let ball: Vec<String> = ball.map(str::to_owned).into_iter().chain(levels).collect();
    let knot = [
        "--threads 1",
        "--threads 16 --batch 64",
        "--kernel packet --threads 3",
        "--kernel stream --batch 100",
        "--kernel single --threads 2",
        "--tracer recursive --threads 5",
    ];
    let knot = knot.map(|options| format!("--bvh on-demand {options}")).to_vec();
    for (scene, usual, all) in [("ball.json", "", ball), ("knot.json", "--bvh fast", knot)] {
        let render = |options: &str| {
            let options: Vec<&str> = options.split_whitespace().collect();
            let arguments = [scene, "out.exr", "--stats", "stats.json"];
            run_silently(folder.path(), &[&arguments[..], &options].concat());
            bytes(folder.path(), "out.exr")
        };
        let expected = render(usual);
        for options in all {
            assert!(render(&options) == expected, "{scene} {options}");
            let chunks = json_in(folder.path(), "stats.json")["bvh"]["chunks"].take();
            let [built, all] = [0, 1].map(|i| chunks[i].as_u64());
            let is_in_part = Some(0) < built && built < all;
            assert_eq!(
                is_in_part,
                options.contains("on-demand"),
                "{options}: {built:?} of {all:?}"
            );
        }
    }
}

#[test]
fn the_old_name_of_exact_precision_is_not_listed() {
    let folder = folder();
    for listing in [&["render", "--help"][..], &["completions", "bash"], &["completions", "zsh"]] {
        let output = run(folder.path(), listing);
        assert!(!text(&output.stdout).contains("robust"), "{listing:?}");
    }
}

#[test]
fn vector_instructions_that_are_not_there_are_refused_with_those_that_are() {
    let folder = with_ball();
    let available: Vec<_> = Level::available().into_iter().map(Level::name).collect();
    let all = ["sse2", "sse42", "avx2", "avx512", "neon", "mmx"];
    for level in all.iter().filter(|name| !available.contains(*name)) {
        let output = run(folder.path(), &["ball.json", "out.exr", "--simd", level]);
        assert_eq!(output.status.code(), Some(2));
        let told = text(&output.stderr);
        assert!(told.contains(&format!("use auto, {}", available.join(", "))), "{told}");
        assert!(!folder.path().join("out.exr").exists());
    }
}

#[test]
fn a_crop_and_a_size_choose_what_is_rendered() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "whole.pfm"]);
    run_silently(folder.path(), &["ball.json", "part.pfm", "--crop", "3,2,5,4"]);
    let [whole, part] = ["whole.pfm", "part.pfm"].map(|name| film(folder.path(), name));
    assert_eq!((part.width(), part.height()), (5, 4));
    for (x, y) in places(5, 4) {
        assert_eq!(part.pixel(x, y), whole.pixel(x + 3, y + 2));
    }
    run_silently(folder.path(), &["ball.json", "small.pfm", "--width", "8", "--height", "6"]);
    let small = film(folder.path(), "small.pfm");
    assert_eq!((small.width(), small.height()), (8, 6));
}

#[test]
fn paths_in_a_scene_start_from_its_folder() {
    let folder = folder();
    let (inner, outer) = (folder.path().join("scenes"), folder.path().join("elsewhere"));
    std::fs::create_dir_all(&inner).expect("a folder");
    std::fs::create_dir_all(&outer).expect("a folder");
    put(&inner, "m.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n");
    let mesh = json!({"type": "trimesh", "file": "m.obj", "material": matte(0.8, [1.0; 3])});
    let scene = scene(0, &pinhole([8, 8], 40.0, 5.0), &[], &[mesh]);
    put(&inner, "s.json", scene.to_string());
    let output = run(&outer, &["-q", "../scenes/s.json", "out.exr"]);
    assert!(output.status.success() && text(&output.stderr).contains("there is no light"));
    assert_eq!(film(&outer, "out.exr").pixel(4, 4), Some([0.0; 3]), "the mesh, unlit");
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
    let output =
        command.arg("-q").arg(name(".json")).arg(name(".png")).output().expect("the command runs");
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    assert!(folder.path().join(name(".png")).exists());
}
