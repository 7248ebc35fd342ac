//! Which way the triangles of a mesh face.

use glam::vec3;
use serde_json::{Value, json};

use super::{accepted, at, set};
use crate::components::Mesh;
use crate::mesh::MeshData;

/// A strip or an indexed mesh in the plane z = 0; seen from +z its first triangle runs clockwise.
fn zigzag() -> Value {
    json!({
        "type": "trimesh", "points": [[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0]],
        "material": { "ks": 0, "kd": 1, "specularexponent": 1, "diffusecolor": [1, 1, 1] }
    })
}

fn mesh(shape: Value) -> MeshData {
    let scene = accepted("scene.shapes[4]", shape);
    at::<Mesh>(&scene, "scene.shapes[4]").unwrap().data
}

/// The z of the normal of each triangle, by the counter-clockwise rule.
fn facing(mesh: &MeshData) -> Vec<f32> {
    let normal = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).z
    };
    mesh.triangles.iter().map(normal).collect()
}

#[test]
fn a_strip_faces_one_way() {
    let strip = mesh(zigzag());
    assert_eq!(strip.triangles, [[0, 2, 1], [1, 2, 3], [2, 4, 3]]);
    assert_eq!(facing(&strip), [1.0, 1.0, 1.0]);
    assert_eq!(strip.positions[3], vec3(1.0, 1.0, 0.0));
}

/// With normals it is as written.
#[test]
fn fronts_are_where_corners_run_clockwise() {
    for (key, value, expected) in [
        ("normal", json!([0, 0, 0]), [1.0, -1.0, 1.0]),
        ("normal", json!([-1, 0, 0]), [-1.0, -1.0, 1.0]),
        ("normal", json!([0, -1, 0]), [1.0, 1.0, 1.0]),
        ("indices", json!([[0, 1, 2], [2, 1, 3], [0, 2, 1]]), [1.0, 1.0, -1.0]),
    ] {
        assert_eq!(facing(&mesh(set(zigzag(), key, value.clone()))), expected, "{key} {value}");
    }
}
