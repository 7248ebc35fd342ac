//! `wavecrest SCENE OUTPUT`.

use std::path::Path;

use serde_json::json;
use wavecrest_core::math::simd::Level;

use super::{run_silently, with_ball};
use crate::support::{
    bytes, folder, json_in, matte, pinhole, point_light, put, repository, run, run_well, scene,
    text, wavecrest, with,
};

/// A knot of which the image shows a part, so that rays build a part of its tree.
fn put_knot(folder: &Path) {
    run_silently(folder, &["generate", "knot", "knot.ply", "--triangles", "200000", "-q"]);
    let camera = with(pinhole([64, 48], 3.0, 6.0), "look", [1.0, 0.0, 0.0]);
    let mesh = json!({"type": "trimesh", "file": "knot.ply", "material": matte(1.0, [0.5; 3])});
    let light = point_light(50.0, [3.0, 3.0, 5.0], [1.0; 3]);
    put(folder, "knot.json", scene(1, &camera, &[light], &[mesh]).to_string());
}

/// Trees that rays build, on several threads at once. `messages/choices.txt` has other options.
#[test]
fn no_choice_of_how_to_render_changes_a_byte_while_rays_build_the_tree() {
    let folder = folder();
    put_knot(folder.path());
    let render = |options: &str| {
        let options: Vec<&str> = options.split_whitespace().collect();
        let arguments = ["knot.json", "out.exr", "--stats", "stats.json"];
        run_silently(folder.path(), &[&arguments[..], &options].concat());
        bytes(folder.path(), "out.exr")
    };
    let expected = render("--bvh fast");
    for options in [
        "--threads 1",
        "--threads 16 --batch 64",
        "--kernel packet --threads 3",
        "--kernel stream --batch 100",
        "--kernel single --threads 2",
        "--tracer recursive --threads 5",
    ] {
        assert!(render(&format!("--bvh on-demand {options}")) == expected, "{options}");
        let chunks = json_in(folder.path(), "stats.json")["bvh"]["chunks"].take();
        let [built, all] = [0, 1].map(|i| chunks[i].as_u64());
        assert!(Some(0) < built && built < all, "{options}: {built:?} of {all:?}");
    }
}

#[test]
fn texels_that_are_not_finite_are_told_and_trapped() {
    let folder = folder();
    let scene = repository("scenes/hard/no-numbers.json");
    let scene = scene.to_str().expect("a path");
    let told = run_well(folder.path(), &[scene, "o.png", "--width", "32", "-q", "--stats", "s"]);
    let is_told = told.contains("no-numbers.exr are not finite and count as 0\n");
    assert!(is_told && told.starts_with("warning: "), "{told}");
    assert!(json_in(folder.path(), "s")["textures"]["invalid"].as_u64() > Some(0));
    let output = run(folder.path(), &[scene, "t.png", "--width", "32", "--trap-invalid"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("not finite") && !folder.path().join("t.png").exists());
}

#[test]
fn vector_instructions_that_are_not_there_are_refused_with_those_that_are() {
    let folder = with_ball();
    let available: Vec<_> = Level::available().into_iter().map(Level::name).collect();
    let all = ["sse2", "avx2", "avx512", "neon", "mmx"];
    for level in all.iter().filter(|name| !available.contains(*name)) {
        let output = run(folder.path(), &["ball.json", "out.exr", "--simd", level]);
        assert_eq!(output.status.code(), Some(2));
        let told = text(&output.stderr);
        assert!(told.contains(&format!("use auto, {}", available.join(", "))), "{told}");
        assert!(!folder.path().join("out.exr").exists());
    }
}

#[test]
#[cfg(target_os = "linux")]
fn names_may_have_spaces_and_letters_of_any_script_or_none() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = with_ball();
    for name in [&b"my scene"[..], "балл".as_bytes(), b"-ball", b"render", b"b\xffll"] {
        let named = |before: &[u8], after: &[u8]| {
            OsStr::from_bytes(&[before, name, after].concat()).to_owned()
        };
        let (file, output) = (named(b"", b".json"), named(b"out of ", b".png"));
        std::fs::copy(folder.path().join("ball.json"), folder.path().join(&file)).expect("a copy");
        let mut command = wavecrest(folder.path());
        command.args(["render", "-q", "-o"]).arg(&output).arg("--").arg(&file);
        let told = command.output().expect("the command runs");
        assert_eq!((told.status.code(), text(&told.stderr)), (Some(0), ""), "{name:?}");
        assert!(folder.path().join(output).exists());
    }
}
