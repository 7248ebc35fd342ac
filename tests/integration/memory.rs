//! Memory: told before anything large is read, and refused where it is more than allowed.

use std::path::Path;

use serde_json::{Value, json};
use wavecrest_scene::generate::{self, Model, Recipe};
use wavecrest_scene::load::{self, LoadOptions};
use wavecrest_scene::mesh::{self, MeshData, Survey};

use crate::support::{bytes, folder, matte, pinhole, point_light, put, run, run_json, scene, text};

// Files, layers, looks and sheets.
mod outputs;
// Images by their heads, and an address space that is too small.
mod short;

fn held(data: &MeshData) -> Survey {
    Survey {
        positions: data.positions.len() as u64,
        triangles: data.triangles.len() as u64,
        normals: data.normals.as_ref().map_or(0, |n| n.values.len() as u64),
        uvs: data.uvs.as_ref().map_or(0, |n| n.values.len() as u64),
        normal_indices: data.normals.as_ref().is_some_and(|n| n.indices.is_some()),
        colors: data.colors.as_ref().map_or(0, |colors| colors.len() as u64),
        materials: false,
        uv_indices: data.uvs.as_ref().is_some_and(|n| n.indices.is_some()),
    }
}

fn check(folder: &Path, name: &str, bytes: &[u8]) {
    put(folder, name, bytes);
    let path = folder.join(name);
    let loaded = mesh::load(&path).unwrap_or_else(|error| panic!("{error}"));
    let survey = mesh::survey(&path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(survey, held(&loaded.mesh), "{name}");
}

const ASCII: &str = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
    property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement edge 1\n\
    property int a\nproperty int b\nelement face 2\nproperty list uchar int vertex_indices\n\
    property uchar red\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n\n1 1 0 0 0 1\n0 1 0 0 0 1\n\
    2 0 0 0 0 1\n7 8\n4 0 1 2 3 9\n3 1 4 2 9\n";

const OBJ: &str = "# a text\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n\
    vn 0 0 1\no name\nf 1/1/1 2/2/1 3/3/1 \\\n4/3/1\nf 1/1/1 2/2/1 3/3/1 # and a word\n";

/// A binary file of two quads and a triangle, with strips of its own kind of count and index.
fn binary(big: bool) -> Vec<u8> {
    let endian = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{endian}_endian 1.0\nelement vertex 6\nproperty float x\n\
         property float y\nproperty double z\nproperty float u\nproperty float v\nelement face 3\n\
         property uchar tag\nproperty list ushort ushort vertex_index\nend_header\n"
    )
    .into_bytes();
    let float = |x: f32| if big { x.to_be_bytes() } else { x.to_le_bytes() };
    let double = |x: f64| if big { x.to_be_bytes() } else { x.to_le_bytes() };
    let short = |x: u16| if big { x.to_be_bytes() } else { x.to_le_bytes() };
    for i in 0..6_u8 {
        let (x, y) = (f32::from(i % 3), f32::from(i / 3));
        bytes.extend([float(x), float(y)].concat());
        bytes.extend(double(0.0));
        bytes.extend([float(x), float(y)].concat());
    }
    for face in [&[0_u16, 1, 4, 3][..], &[1, 2, 5, 4], &[0, 1, 4]] {
        bytes.push(7);
        bytes.extend(short(face.len() as u16));
        face.iter().for_each(|&corner| bytes.extend(short(corner)));
    }
    bytes
}

#[test]
fn a_survey_counts_the_contents_of_a_mesh_file() {
    let folder = folder();
    check(folder.path(), "text.ply", ASCII.as_bytes());
    check(folder.path(), "text.obj", OBJ.as_bytes());
    check(folder.path(), "little.ply", &binary(false));
    check(folder.path(), "big.ply", &binary(true));
    let knot = Recipe::new(Model::Knot, 5000);
    let mesh = generate::mesh(&knot).expect("a mesh");
    let path = folder.path().join("knot.ply");
    generate::write_ply(&knot, &path, &mut |_, _| {}).expect("it can be written");
    assert_eq!(mesh::survey(&path).expect("a survey"), held(&mesh));
}

/// Rays that wait at glass take memory, which a mesh without materials does not need.
#[test]
fn a_survey_counts_the_bounces_of_a_mesh_with_materials() {
    let folder = folder();
    for (name, head, bounces) in [("plain.obj", "", 0), ("glass.obj", "mtllib glass.mtl\n", 8)] {
        put(folder.path(), name, [head, OBJ].concat());
        let found = load::survey(&folder.path().join(name), &LoadOptions::default());
        assert_eq!(found.expect("a survey").bounces, bounces, "{name}");
    }
}

/// What a header claims is held against the size of its file.
#[test]
fn a_survey_of_a_file_that_was_cut_off_is_small() {
    let folder = folder();
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n\
        property float y\nproperty float z\nelement face 4000000000\n\
        property list uchar int vertex_indices\nend_header\nabc";
    put(folder.path(), "claims.ply", header);
    let survey = mesh::survey(&folder.path().join("claims.ply")).expect("a survey");
    assert!(survey.bytes() < 100, "{survey:?}");
}

fn knot_scene(folder: &Path, triangles: u64) {
    let recipe = Recipe::new(Model::Knot, triangles);
    generate::write_ply(&recipe, &folder.join("knot.ply"), &mut |_, _| {})
        .expect("it can be written");
    let knot = json!({"type": "trimesh", "file": "knot.ply", "material": matte(1.0, [0.5; 3])});
    let light = point_light(50.0, [3.0, 3.0, 5.0], [1.0; 3]);
    let scene = scene(0, &pinhole([64, 48], 50.0, 6.0), &[light], &[knot]);
    put(folder, "knot.json", scene.to_string());
}

#[test]
fn more_memory_than_allowed_is_refused_before_anything_is_read() {
    let folder = folder();
    knot_scene(folder.path(), 200_000);
    // What the mesh says is wrong: it would be refused too if it were read.
    let mut mesh = bytes(folder.path(), "knot.ply");
    let end = mesh.len();
    mesh[end - 4..].copy_from_slice(&[0xFF; 4]);
    put(folder.path(), "knot.ply", mesh);
    let few = "knot.json: the render needs more memory than 20.0 MiB, found about ";
    let read = "knot.ply";
    for (limit, words) in
        [("20MiB", &[few, "raise --memory-limit", "building the tree"][..]), ("4GiB", &[read])]
    {
        let output = run(folder.path(), &["-q", "--memory-limit", limit, "knot.json", "out.png"]);
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(words.iter().all(|words| told.contains(words)), "{told}");
        assert!(!folder.path().join("out.png").exists());
    }
}

#[test]
fn what_is_estimated_before_reading_is_near_what_is_held() {
    let folder = folder();
    knot_scene(folder.path(), 300_000);
    let explained = run_json(folder.path(), &["explain", "--json", "--render", "knot.json"]);
    let number = |pointer: &str| explained.pointer(pointer).and_then(Value::as_f64).expect(pointer);
    for part in ["geometry", "tree", "build", "film"] {
        let [before, after] =
            ["estimated_memory", "memory"].map(|when| number(&format!("/{when}/{part}")));
        // Of the tree, what rays of the pilot built.
        let least = if matches!(part, "tree" | "build") { 0.7 * before } else { before };
        assert!((least..=before).contains(&after), "{part}: {after} where {before} were estimated");
    }
    // Without optimisation the program itself is larger.
    let (estimated, peak) = (number("/estimated_total"), number("/rendered/peak"));
    assert!(peak < estimated * 1.1 + 30e6, "{peak} bytes where {estimated} were estimated");
    assert!(peak > estimated * 0.6, "{peak} bytes where {estimated} were estimated");
}
