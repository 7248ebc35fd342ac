//! Where memory is short: images that are larger than allowed, and what the system refuses.

use std::path::Path;
use std::process::Output;

use base64::Engine as _;
use image::{ExtendedColorType, ImageEncoder as _};
use serde_json::{Value, json};

use super::{knot_scene, refused_for};
use crate::support::{
    self, folder, matte, pinhole, point_light, put, scene, text, textured_square, wall, with,
};

/// A grey image of one brightness, of so many texels on a side.
fn grey(side: u32, profile: Vec<u8>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = image::codecs::png::PngEncoder::new(&mut bytes);
    encoder.set_icc_profile(profile).expect("PNG files have profiles");
    let texels = vec![200; (side * side) as usize];
    encoder.write_image(&texels, side, side, ExtendedColorType::L8).expect("an image");
    bytes
}

/// The number that ends a chunk of a PNG file (RFC 2083, section 15).
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| (sum >> 1) ^ (0xEDB8_8320 * (sum & 1)))
    })
}

/// The same image, whose head says that it has so many texels on a side.
fn claiming(mut png: Vec<u8>, side: u32) -> Vec<u8> {
    // The first chunk has 13 bytes, which begin with width and height.
    png[16..20].copy_from_slice(&side.to_be_bytes());
    png[20..24].copy_from_slice(&side.to_be_bytes());
    let sum = crc(&png[12..29]);
    png[29..33].copy_from_slice(&sum.to_be_bytes());
    png
}

/// A wall with a texture, as a scene file in `folder`.
fn textured_wall(folder: &Path, png: &[u8]) {
    put(folder, "t.png", png);
    let wall = with(wall(1.0, 0.0, matte(1.0, [1.0; 3])), "texture", "t.png");
    let light = point_light(50.0, [0.0, 0.0, 3.0], [1.0; 3]);
    let scene = scene(0, &pinhole([16, 16], 40.0, 3.0), &[light], &[wall]);
    put(folder, "s.json", scene.to_string());
}

fn run(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let found = support::run(folder, arguments);
    (found.status.code(), text(&found.stderr).to_owned())
}

#[test]
fn an_image_is_refused_by_the_size_in_its_head() {
    let folder = folder();
    textured_wall(folder.path(), &claiming(grey(8, Vec::new()), 60_000));
    let large = ["s.json: scene.shapes[0].texture: ", "t.png", "60000 x 60000", "14.4 GB"];
    let empty = "has more pixels than its file can hold, found 20000 x 20000";
    for (side, command, told) in [
        (60_000, &["check", "s.json"][..], &large[..]),
        (60_000, &["s.json", "o.png"], &large),
        (20_000, &["s.json", "o.png"], &[empty]),
    ] {
        textured_wall(folder.path(), &claiming(grey(8, Vec::new()), side));
        let (code, text) = run(folder.path(), command);
        assert_eq!(code, Some(2), "{text}");
        assert!(told.iter().all(|words| text.contains(words)), "{text}");
    }
}

#[test]
fn decoding_a_texture_of_any_kind_of_file_ends_at_the_limit() {
    let folder = folder();
    let png = grey(4096, Vec::new());
    put(folder.path(), "t.png", &png);
    let mut beside = textured_square(folder.path(), &["t.png"]);
    put(folder.path(), "m.mtl", "newmtl leaf\nmap_Kd t.png\n");
    let color = json!({"baseColorTexture": {"index": 0}});
    beside["materials"] = json!([{"pbrMetallicRoughness": color}]);
    let data = base64::engine::general_purpose::STANDARD.encode(&png);
    let mut within = beside.clone();
    within["images"][0]["uri"] = format!("data:image/png;base64,{data}").into();
    let plain = wall(1.0, 0.0, matte(1.0, [1.0; 3]));
    let wall = with(plain.clone(), "texture", "t.png");
    let mask = with(with(plain, "alpha", "t.png"), "alphacutoff", 0.5);
    let light = [point_light(50.0, [0.0, 0.0, 3.0], [1.0; 3])];
    let of = |wall| scene(0, &pinhole([16, 16], 40.0, 3.0), &light, &[wall]);
    for (name, json, image) in [
        ("a.json", of(wall), "t.png"),
        ("mask.json", of(mask), "t.png"),
        ("beside.gltf", beside, "t.png"),
        ("within.gltf", within, "images[0]"),
        ("m.obj", Value::Null, "t.png"),
    ] {
        if !json.is_null() {
            put(folder.path(), name, json.to_string());
        }
        let size = ["--width", "16", "--height", "16"];
        let refused = |limit| refused_for(folder.path(), [name, "o.png"], limit, &size);
        // 16.8 million texels of a byte, which become ones of 4 bytes.
        let told = refused(60).expect(name);
        assert!(told.starts_with(&format!("{name}: reading ")) && told.ends_with(image), "{told}");
        assert_eq!(refused(500), None, "{name}");
    }
}

/// Runs the command in `folder` with so many bytes of address space.
#[cfg(target_os = "linux")]
fn run_within(bytes: u64, folder: &Path, arguments: &[&str]) -> Output {
    let mut command = std::process::Command::new("sh");
    command.current_dir(folder).args(["-c", "ulimit -v $0 && exec \"$@\""]);
    command.arg((bytes / 1024).to_string()).arg(env!("CARGO_BIN_EXE_wavecrest")).args(arguments);
    command.output().expect("it runs")
}

/// Runs the command with each of `limits`: it ends well or with an error in words, and leaves nothing but `o.png`
/// behind. Returns how often it ended either way.
#[cfg(target_os = "linux")]
fn sweep(limits: &[u64], folder: &Path, arguments: &[&str]) -> [u32; 2] {
    let names = || {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let mut names: Vec<_> = entries.map(|entry| entry.expect("an entry").file_name()).collect();
        names.retain(|name| name != "o.png");
        names.sort();
        names
    };
    let before = names();
    let mut found = [0; 2];
    for &limit in limits {
        let _ = std::fs::remove_file(folder.join("o.png"));
        let output = run_within(limit, folder, arguments);
        let text = String::from_utf8_lossy(&output.stderr);
        let is_there = folder.join("o.png").exists();
        match output.status.code() {
            Some(0) if is_there => found[0] += 1,
            Some(2) if !is_there && text.contains("error: ") => found[1] += 1,
            code => panic!("{limit}: {code:?} {text}"),
        }
        assert_eq!(names(), before, "{limit}");
    }
    found
}

/// A bad profile is passed over, and not unpacked: it would not fit.
#[cfg(target_os = "linux")]
#[test]
fn a_colour_profile_is_not_unpacked() {
    let folder = folder();
    let png = grey(8, vec![0; 512 << 20]);
    textured_wall(folder.path(), &png);
    let program = std::fs::metadata(env!("CARGO_BIN_EXE_wavecrest")).expect("it is there").len();
    let limit = program + (400 << 20);
    for arguments in [&["-q", "s.json", "o.png"][..], &["diff", "t.png", "t.png"]] {
        let output = run_within(limit, folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
    }
}

/// Limits in steps of `step`, from what the program itself needs: below, the system's libraries may abort.
#[cfg(target_os = "linux")]
fn limits(step: f64) -> Vec<u64> {
    let first = 36e6;
    std::iter::successors(Some(first), |limit| Some(limit * step))
        .take_while(|&limit| limit < 2e9)
        .map(|limit| limit as u64)
        .collect()
}

/// A mesh, and the shards of it that are merged.
#[cfg(target_os = "linux")]
fn short_of_memory(triangles: u64, step: f64) {
    let folder = folder();
    knot_scene(folder.path(), triangles);
    let found = sweep(&limits(step), folder.path(), &["-q", "knot.json", "o.png"]);
    assert!(found[0] > 0 && found[1] > 0, "{found:?}");
    for shard in ["1/2", "2/2"] {
        let name = format!("p{}.part", &shard[..1]);
        let (code, text) = run(folder.path(), &["-q", "--shard", shard, "knot.json", &name]);
        assert_eq!(code, Some(0), "{text}");
    }
    let merge = ["merge", "-q", "-o", "o.png", "p1.part", "p2.part"];
    let found = sweep(&limits(step), folder.path(), &merge);
    assert!(found[0] > 0, "{found:?}");
    textured_wall(folder.path(), &grey(2048, Vec::new()));
    let found = sweep(&limits(step), folder.path(), &["-q", "s.json", "o.png"]);
    assert!(found[0] > 0 && found[1] > 0, "{found:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn memory_that_the_system_refuses_is_an_error() {
    short_of_memory(500_000, 1.5);
}

/// As the release is: `cargo test --release --test integration -- --ignored memory`.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "takes minutes"]
fn memory_that_the_system_refuses_is_an_error_in_small_steps() {
    short_of_memory(1_100_000, 1.1);
}
