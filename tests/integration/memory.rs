//! Memory: told before anything large is read, and refused where it is more than allowed.

use std::path::Path;

use serde_json::{Value, json};
use wavecrest_scene::generate::{self, Model, Recipe};
use wavecrest_scene::mesh;

use crate::support::{bytes, folder, matte, pinhole, point_light, put, run, run_json, scene, text};

// Files, layers, looks and sheets.
mod outputs;
// Images by their heads, and an address space that is too small.
mod short;

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
    property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement edge 1\n\
    property int a\nproperty int b\nelement face 2\nproperty list uchar int vertex_indices\n\
    property uchar red\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n\n1 1 0 0 0 1\n0 1 0 0 0 1\n\
    2 0 0 0 0 1\n7 8\n4 0 1 2 3 9\n3 1 4 2 9\n";

const OBJ: &str = "# a text\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n\
    vn 0 0 1\no name\nf 1/1/1 2/2/1 3/3/1 \\\n4/3/1\nf 1/1/1 2/2/1 3/3/1 # and a word\n";

/// The header of a binary file of points with texture coordinates, and faces with a byte and a list.
fn binary([vertices, faces]: [u64; 2]) -> String {
    format!(
        "ply\nformat binary_big_endian 1.0\nelement vertex {vertices}\nproperty float x\n\
         property float y\nproperty double z\nproperty float u\nproperty float v\nelement face {faces}\n\
         property uchar tag\nproperty list ushort ushort vertex_index\nend_header\n"
    )
}

/// Of a text its words are counted, of a binary file the length, whatever its header claims.
#[test]
fn a_survey_counts_the_contents_of_a_mesh_file() {
    let folder = folder();
    // Two quads and a triangle.
    let corners = 4 + 4 + 3;
    let body = 6 * (4 + 4 + 8 + 4 + 4) + 3 * (1 + 2) + 2 * corners;
    let whole = [binary([6, 3]).into_bytes(), vec![0; body]].concat();
    let claims = [binary([4_000_000_000; 2]).as_bytes(), b"abc"].concat();
    for (name, bytes, expected, attributes) in [
        ("text.ply", PLY.as_bytes(), [5, 3], 5 * 12),
        ("text.obj", OBJ.as_bytes(), [4, 3], 3 * 8 + 12 + 2 * 3 * 12),
        ("whole.ply", &whole, [6, 5], 6 * 8),
        ("claims.ply", &claims, [0, 0], 0),
    ] {
        put(folder.path(), name, bytes);
        let found = mesh::survey(&folder.path().join(name)).expect("a survey");
        assert_eq!([found.positions, found.triangles], expected, "{name}");
        // A tangent is counted for each texture coordinate.
        assert!((attributes..=3 * attributes).contains(&found.attributes), "{name}: {found:?}");
    }
}

fn knot_scene(folder: &Path, triangles: u64) {
    let recipe = Recipe::new(Model::Knot, triangles);
    generate::write_ply(&recipe, &folder.join("knot.ply"), &mut |_, _| {})
        .expect("it can be written");
    let knot = json!({"type": "trimesh", "file": "knot.ply", "material": matte(1.0, [0.5; 3])});
    let light = point_light(50.0, [3.0, 3.0, 5.0], [1.0; 3]);
    // Where nothing is transparent no ray waits, however many bounces there may be.
    let scene = scene(10_000, &pinhole([64, 48], 50.0, 6.0), &[light], &[knot]);
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
    for part in ["geometry", "film"] {
        let [before, after] =
            ["estimated_memory", "memory"].map(|when| number(&format!("/{when}/{part}")));
        assert_eq!(before, after, "{part}");
    }
    // Without optimisation the program itself is larger.
    let (estimated, peak) = (number("/estimated_total"), number("/rendered/peak"));
    assert!(peak < estimated + 20e6, "{peak} bytes where {estimated} were estimated");
    assert!(peak > estimated * 0.4, "{peak} bytes where {estimated} were estimated");
}
