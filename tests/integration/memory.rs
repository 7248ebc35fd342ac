//! Memory: what needs more than the limit ends with an error, wherever it is needed.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::json;
use wavecrest_scene::generate::{self, Model, Recipe};

use crate::support::{
    bytes, folder, json_in, matte, pinhole, point_light, put, run, run_json, scene, text,
};

// Images by their heads, and an address space that is too small.
mod short;

fn knot_scene(folder: &Path, triangles: u64) {
    let recipe = Recipe::new(Model::Knot, triangles);
    generate::write_ply(&recipe, &folder.join("knot.ply"), &mut |_, _| {})
        .expect("it can be written");
    let knot = json!({"type": "trimesh", "file": "knot.ply", "material": matte(1.0, [0.5; 3])});
    let light = point_light(50.0, [3.0, 3.0, 5.0], [1.0; 3]);
    let scene = scene(1, &pinhole([64, 48], 50.0, 6.0), &[light], &[knot]);
    put(folder, "knot.json", scene.to_string());
}

/// What is in the file that a render would replace.
const OLD: &[u8] = b"an older image";

/// Runs a render of `scene` to `output` within a limit of so many million bytes. Returns what it refused memory for, or
/// `None` if the image is written; else its file and the others of the folder are as before.
fn refused_for(
    folder: &Path,
    [scene, output]: [&str; 2],
    limit: u64,
    options: &[&str],
) -> Option<String> {
    put(folder, output, OLD);
    let names = || {
        let entries = std::fs::read_dir(folder).expect("a folder");
        entries.map(|entry| entry.expect("an entry").file_name()).collect::<BTreeSet<_>>()
    };
    let before = names();
    let limit = format!("{limit}MB");
    let arguments =
        [&[scene, output, "-q", "--threads", "2", "--memory-limit", &limit], options].concat();
    let ended = run(folder, &arguments);
    let told = text(&ended.stderr);
    assert_eq!(names(), before, "{told}");
    let is_old = bytes(folder, output) == OLD;
    match (ended.status.code(), is_old) {
        (Some(0), false) => return None,
        (Some(2), true) => {}
        other => panic!("{arguments:?}: {other:?} {told}"),
    }
    let (what, _) = told.split_once(" needs more memory than --memory-limit ").expect(told);
    assert_eq!(told.lines().count(), 1, "{told}");
    Some(what.trim_start_matches("error: ").to_owned())
}

/// Limits in million bytes, from what the program itself holds.
fn limits() -> impl Iterator<Item = u64> {
    std::iter::successors(Some(12), |limit| Some(limit + limit / 6))
        .take_while(|limit| *limit < 1000)
}

/// Of each kind of file, and of a file that others name.
#[test]
fn reading_ends_at_the_limit() {
    let folder = folder();
    knot_scene(folder.path(), 300_000);
    let mesh = wavecrest_scene::mesh::load(&folder.path().join("knot.ply")).expect("a mesh").mesh;
    let positions = mesh.triangles.iter().flatten().map(|&index| mesh.positions[index as usize]);
    let corners: Vec<[f32; 3]> = positions.map(|point| point.to_array()).collect();
    let bytes: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    // A header, and in each triangle a normal that nobody reads and two bytes.
    let mut stl = [&[0; 80][..], &(mesh.triangles.len() as u32).to_le_bytes()].concat();
    bytes.chunks(36).for_each(|points| stl.extend([&[0; 12], points, &[0; 2]].concat()));
    put(folder.path(), "knot.stl", stl);
    let mut obj: String = corners.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    let faces = (1..corners.len()).step_by(3);
    obj.extend(faces.map(|first| format!("f {first} {} {}\n", first + 1, first + 2)));
    put(folder.path(), "knot.obj", obj);
    let (part, material) = (&corners[..30_000], matte(1.0, [0.5; 3]));
    let indices: Vec<_> =
        (0..30_000).step_by(3).map(|first| [first, first + 1, first + 2]).collect();
    let inline =
        json!({"type": "trimesh", "points": part, "indices": indices, "material": material});
    let inline = scene(0, &pinhole([8, 8], 50.0, 6.0), &[], &[inline]);
    put(folder.path(), "inline.json", inline.to_string());
    let (count, length) = (corners.len(), bytes.len());
    let gltf = json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": length}],
        "buffers": [{"uri": "knot.bin", "byteLength": length}],
    });
    put(folder.path(), "knot.gltf", gltf.to_string());
    put(folder.path(), "knot.bin", bytes);
    for (name, read) in [
        ("knot.ply", "knot.ply: reading knot.ply"),
        ("knot.json", "knot.json: reading knot.ply"),
        ("knot.stl", "knot.stl: reading knot.stl"),
        ("knot.obj", "knot.obj: reading knot.obj"),
        ("inline.json", "inline.json: reading the scene"),
        ("knot.gltf", "knot.gltf: reading "),
    ] {
        let names = [name, "o.png"];
        let size: &[&str] = &["--size", "8x8", "--samples", "1"];
        let all: Vec<_> =
            limits().map_while(|limit| refused_for(folder.path(), names, limit, size)).collect();
        assert!(all.iter().any(|what| what.starts_with(read)), "{name}: {all:?}");
    }
}

/// A sweep of limits: what is refused comes ever later, until nothing is, and the peak is then near the limit.
#[test]
fn each_stage_ends_at_the_limit() {
    let folder = folder();
    knot_scene(folder.path(), 300_000);
    put(folder.path(), "s.json", "{}");
    let size = ["--size", "1000x800", "--samples", "1", "--stats", "s.json"];
    // Large batches, or large files.
    for (options, stages) in [
        (["--batch", "400000"], &["reading knot.ply", "building the BVH", "tracing rays"][..]),
        (["--aov", "all"], &["reading knot.ply", "building the BVH", "writing o.exr"]),
    ] {
        let options = [&size[..], &options].concat();
        let mut found = BTreeSet::new();
        let enough = limits().find(|&limit| {
            let refused = refused_for(folder.path(), ["knot.json", "o.exr"], limit, &options);
            refused.map(|what| found.insert(what)).is_none()
        });
        let all = found.into_iter().collect::<Vec<_>>().join("; ");
        assert!(stages.iter().all(|stage| all.contains(stage)), "{all}");
        let enough = enough.expect("a limit that suffices") * 1_000_000;
        let peak = json_in(folder.path(), "s.json")["memory"]["peak"].as_u64();
        assert!(peak.is_none_or(|peak| peak < enough + enough / 4), "{peak:?} {enough}");
    }
}

#[test]
fn what_a_header_claims_is_refused_by_the_length_of_the_file() {
    let folder = folder();
    for count in ["4000000000", "1000000000000"] {
        let header = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
             property float z\nelement face {count}\nproperty list uchar int vertex_indices\nend_header\nabc"
        );
        put(folder.path(), "claims.ply", header);
        let ended = run(folder.path(), &["-q", "claims.ply", "o.png"]);
        let told = text(&ended.stderr);
        assert!(
            ended.status.code() == Some(2) && told.starts_with("error: claims.ply: "),
            "{told}"
        );
        assert!(!told.contains("memory"), "{told}");
    }
}

#[test]
fn explain_tells_the_memory_of_a_prepared_scene() {
    let folder = folder();
    knot_scene(folder.path(), 300_000);
    let explained = run_json(folder.path(), &["explain", "--json", "knot.json"]);
    let number = |key: &str| explained["memory"][key].as_u64();
    // Positions and indices of three numbers each; twice as many triangles as positions.
    let geometry = number("geometry").expect("a number");
    assert!((5_000_000..6_000_000).contains(&geometry), "{geometry}");
    let parts = ["geometry", "appearance", "tree", "batches"].map(|key| number(key).expect(key));
    let [held, peak] = ["held", "peak"].map(number);
    if cfg!(target_os = "linux") {
        assert!(Some(parts.iter().sum()) <= held && held <= peak, "{explained}");
    }
}
