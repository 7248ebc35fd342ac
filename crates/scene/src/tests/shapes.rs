//! The exact words of each error and warning of a shape's form.

use serde_json::{Value, json};

use super::{accepted, error, load, refused, set, warned, warnings, with};

const SPHERE: &str = "scene.shapes[0]";
const PLANE: &str = "scene.shapes[1]";
const TRIANGLE: &str = "scene.shapes[2]";
const STRIP: &str = "scene.shapes[3]";
const INDEXED: &str = "scene.shapes[4]";
const FILE: &str = "scene.shapes[5]";

/// As [`refused`], at a key of a shape, where the message starts.
fn refused_at(shape: &str, key: &str, value: Value, message: &str) {
    refused(&format!("{shape}.{key}"), value, &format!("{shape}.{key}: {message}"));
}

#[test]
fn hc17_spheres() {
    let words = "must be a number above 0 and at most 2^40";
    refused_at(SPHERE, "radius", json!(0), &format!("{words}, found 0"));
    refused_at(SPHERE, "radius", json!(-2), &format!("{words}, found -2"));
    refused_at(SPHERE, "radius", json!(null), &format!("{words}, found null"));
    refused_at(
        SPHERE,
        "type",
        json!("shpere"),
        "must be \"sphere\", \"disk\", \"plane\", \"triangle\" or \"trimesh\", found \"shpere\"; \
         did you mean \"sphere\"?",
    );
    let words = "a sphere can only be scaled uniformly";
    refused_at(
        SPHERE,
        "transform",
        json!({"scale": [1, 2, 1]}),
        &format!("{words}, found {{\"scale\":[1,2,1]}}; use one scale factor, or a trimesh"),
    );
    let shear = json!([[1, 1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]);
    assert!(error(&with(&format!("{SPHERE}.transform"), shear)).to_string().contains(words));
    let mirrored = json!({"scale": [1, -1, 1], "rotate": [10, 20, 30]});
    accepted(&format!("{SPHERE}.transform"), mirrored);
}

#[test]
fn transforms() {
    let flat = "the transform is singular";
    let remedy = "use a scale other than 0 on every axis";
    refused_at(
        PLANE,
        "transform",
        json!({"scale": 0}),
        &format!("{flat}, found {{\"scale\":0}}; {remedy}"),
    );
    let rank_two = json!([[1, 2, 3, 0], [4, 5, 6, 0], [7, 8, 9, 0], [0, 0, 0, 1]]);
    let found = "[[1,2,3,0],[4,5,6,0],[7,8,9,0],[0,0,0,1]]";
    refused_at(PLANE, "transform", rank_two, &format!("{flat}, found {found}; {remedy}"));
    refused_at(
        PLANE,
        "transform",
        json!([[1, 0, 0, 0]]),
        "must be a matrix of 4 rows [[a, b, c, x], [d, e, f, y], [g, h, i, z], [0, 0, 0, 1]], \
         found [[1,0,0,0]]",
    );
    refused(
        "scene.shapes[2].transform[1]",
        json!([1, 0]),
        "scene.shapes[2].transform[1]: must be a row of four numbers, found [1,0]",
    );
    refused_at(
        PLANE,
        "transform",
        json!([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [5, 0, 0, 1]]),
        "the last row must be [0, 0, 0, 1], found [[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,0,0,1]]; \
         put the translation in the last column",
    );
    refused_at(
        PLANE,
        "transform",
        json!("up"),
        "must be a transform (or a matrix of 4 rows), an object { ... }, found \"up\"",
    );
    refused_at(
        SPHERE,
        "transform.scale",
        json!("2"),
        "must be a number, or three numbers [x, y, z], found \"2\"",
    );
}

#[test]
fn planes() {
    let order = "order them bottom left, top left, top right, bottom right";
    let points = "four points [[x, y, z], ...]: bottom left, top left, top right, bottom right";
    refused_at(
        PLANE,
        "points",
        json!([[0, 0, 0], [1, 0, 0], [1, 1, 0]]),
        &format!("must be {points}, found [[0,0,0],[1,0,0],[1,1,0]]"),
    );
    refused_at(
        PLANE,
        "points",
        json!([[0, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 0]]),
        &format!("the plane has no area, found [[0,0,0],[1,1,0],[0,1,0],[1,0,0]]; {order}"),
    );
    refused_at(
        PLANE,
        "points",
        json!([[0, 0, 0], [3, 1, 0], [0, 1, 0], [1, 0, 0]]),
        &format!(
            "the edges of the plane cross or touch, found [[0,0,0],[3,1,0],[0,1,0],[1,0,0]]; {order}"
        ),
    );
    refused_at(
        PLANE,
        "points",
        json!([[0, 0, 0], [0, 1, 0], [0, 1, 0], [1, 0, 0]]),
        "two neighbouring corners of the plane are equal, \
         found [[0,0,0],[0,1,0],[0,1,0],[1,0,0]]; use a triangle",
    );
    warned(
        "scene.shapes[1].points[2]",
        json!([1, 1, 0.1]),
        "scene.shapes[1].points: the four points are not in one plane, \
         found [[0,0,0],[0,1,0],[1,1,0.1],[1,0,0]]; \
         it is rendered as two triangles that share the first and third points",
    );
}

#[test]
fn normals_of_planes_and_triangles() {
    let words = "must be -1 to flip the face, 1 to keep it, or a vector [x, y, z]";
    for (shape, in_plane) in [(PLANE, json!([1, 0, 0])), (TRIANGLE, json!([1, 0, 0]))] {
        refused_at(shape, "normal", json!(0), &format!("{words}, found 0"));
        refused_at(shape, "normal", json!("up"), &format!("{words}, found \"up\""));
        refused_at(shape, "normal", json!([0, 1]), "must be three numbers [x, y, z], found [0,1]");
        refused_at(
            shape,
            "normal",
            json!([0, 0, 0]),
            "must not be zero, found [0,0,0]; use a vector such as [0, 1, 0]",
        );
        refused_at(
            shape,
            "normal",
            in_plane,
            "lies in the plane of the surface, found [1,0,0]; \
             use a vector that points away from the surface",
        );
    }
}

#[test]
fn triangles() {
    refused_at(
        TRIANGLE,
        "points",
        json!([[0, 0, 0]]),
        "must be three points [[x, y, z], ...], found [[0,0,0]]",
    );
    warned(
        "scene.shapes[2].points",
        json!([[0, 0, 0], [1, 0, 0], [2, 0, 0]]),
        "scene.shapes[2].points: the triangle has no area, found [[0,0,0],[1,0,0],[2,0,0]]; \
         it is left out",
    );
}

#[test]
fn strips() {
    refused_at(STRIP, "size", json!(5), "must be the number of points, found 5; \"points\" has 4");
    refused_at(STRIP, "size", json!(-1), "must be an integer from 0 to 4294967295, found -1");
    refused_at(
        STRIP,
        "points",
        json!([[0, 0, 0], [0, 1, 0]]),
        "must be an array of at least three points [[x, y, z], ...], found [[0,0,0],[0,1,0]]",
    );
    let normal = "must be an array of 2 numbers, one for each triangle: 0, or -1 to flip it";
    refused_at(STRIP, "normal", json!([0]), &format!("{normal}, found [0]"));
    refused_at(STRIP, "normal", json!(-1), &format!("{normal}, found -1"));
    refused(
        "scene.shapes[3].normal[1]",
        json!(1),
        "scene.shapes[3].normal[1]: must be 0 to keep the triangle's winding, or -1 to flip it, found 1",
    );
    refused_at(
        STRIP,
        "uvs",
        json!([[0, 0]]),
        "must be an array of 4 times [u, v], one for each point, found [[0,0]]",
    );
    refused(
        "scene.shapes[3].uvs[2]",
        json!([0, 0, 0]),
        "scene.shapes[3].uvs[2]: must be two numbers [u, v], found [0,0,0]",
    );
    refused_at(
        STRIP,
        "normals",
        json!([[0, 0, 1]]),
        "must be an array of 4 times [x, y, z], one for each point, found [[0,0,1]]",
    );
}

#[test]
fn hc25_indices() {
    let words = "must be three indices [a, b, c], each from 0 to 3";
    for wrong in ["[0,1,4]", "[0,1,-1]", "[0,1]", "[0,1,2,3]", "[0,1,1.5]", "7"] {
        let value = serde_json::from_str(wrong).unwrap();
        let path = "scene.shapes[4].indices[1]";
        refused(path, value, &format!("{path}: {words}, found {wrong}"));
    }
    refused_at(
        INDEXED,
        "indices",
        json!([]),
        "must be an array of triangles [[a, b, c], ...], at least one, found []",
    );
    let warning = warnings(&with("scene.shapes[4].normal", json!([0, 0])));
    let text = "scene.shapes[4].normal: is not a key of a trimesh with indices, found [0,0]; \
                it is ignored; did you mean \"normals\"?";
    assert_eq!(warning, [text]);
}

#[test]
fn mesh_sources() {
    let both = |key: &str, value: Value| error(&with(&format!("{FILE}.{key}"), value)).to_string();
    assert!(both("points", json!([])).contains(
        "scene.shapes[5]: a trimesh has \"file\" or \"points\", not both, found {\"type\":"
    ));
    assert!(both("indices", json!([])).contains("\"file\" or \"indices\", not both"));
    for file in ["a.gltf", "b.GLB"] {
        refused_at(
            FILE,
            "file",
            json!(file),
            &format!(
                "a glTF file cannot be a shape, found \"{file}\"; \
                 run wavecrest convert IN OUT.json, and use the meshes that it writes"
            ),
        );
    }
    refused_at(
        FILE,
        "file",
        json!("a.ply"),
        "there is no file at a.ply, found \"a.ply\"; \
         relative paths start at the scene file's folder",
    );
    let smooth = with(&format!("{FILE}.shading"), json!("smooth"));
    let text = "scene.shapes[5].shading: the mesh has no normals for smooth shading; \
                flat shading is used";
    assert_eq!(warnings(&smooth), [text]);
    let textured = set(smooth, &format!("{FILE}.texture"), json!("Cargo.toml"));
    assert!(load(&textured).is_err());
}
