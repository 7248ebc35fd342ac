//! Conversion to scene files: the same image to the last bit.

use std::path::Path;

use serde_json::{Value, json};
use wavecrest_core::film::Film;
use wavecrest_scene::load::{LoadOptions, load};
use wavecrest_scene::write::write;

use super::{loaded, mapped, rendered, small, square};
use crate::support::{edited, folder, matte, pinhole, put, repository, scene, wall, with};

/// What a file is rendered to, once it has been converted in a folder of its own.
pub(super) fn converted(file: &Path) -> (Film, Value) {
    let folder = folder();
    let out = folder.path().join("out.json");
    let scene = load(file, &small()).unwrap_or_else(|error| panic!("{error}"));
    write(&scene, &out, false).unwrap_or_else(|error| panic!("{error}"));
    let json = serde_json::from_slice(&std::fs::read(&out).expect("a file")).expect("JSON");
    let again = load(&out, &LoadOptions { strict: true, ..LoadOptions::default() });
    assert!(again.as_ref().is_ok_and(|scene| scene.warnings.is_empty()));
    (rendered(again), json)
}

/// What has no effect is told once, and not written.
#[test]
fn keys_without_an_effect_are_left_out_of_what_is_written() {
    let white = json!([1, 1, 1]);
    let matte = matte(0.8, [0.5; 3]);
    let sheet = edited(
        matte.clone(),
        "/opacity 0.5\n/thin true\n/transmissioncolor [1, 0, 0]\n/attenuationdistance 2",
    );
    let [a, b, c] = [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 1.0]];
    let strip =
        json!({"type": "trimesh", "points": [a, b, c], "normals": [a, b, c], "material": sheet});
    let sun = json!({"type": "directionallight", "intensity": 1, "color": white, "direction": [0, 0, -1],
                     "samples": 9, "sampling": "random"});
    let idle = scene(1, &pinhole([24, 18], 50.0, 5.0), &[sun], &[wall(1.0, 0.0, matte), strip]);
    let folder = folder();
    let picture = folder.path().join("t.png");
    std::fs::copy(repository("textures/checker.png"), picture).expect("a copy");
    let path = folder.path().join("a.json");
    for (around, lines) in [
        (r#"{"file": "t.png", "turn": 20, "encoding": "srgb"}"#, 8),
        (r#"{"turn": 20, "encoding": "srgb"}"#, 10),
    ] {
        let sky = r#"{"up": [0, 0, 1], "sampling": "random", "distance": 1}"#;
        let places = format!("/scene/environment {around}\n/scene/ambient {sky}");
        std::fs::write(&path, edited(idle.clone(), &places).to_string()).expect("a file");
        let read = load(&path, &small()).expect("a scene");
        let told = read.warnings.iter().filter(|one| one.to_string().contains("has no effect"));
        assert_eq!((told.count(), read.warnings.len()), (lines, lines), "{:?}", read.warnings);
        let (film, json) = converted(&path);
        assert!(film.same_bits(&rendered(Ok(read))));
        assert_eq!(json["scene"]["ambient"], json!({"samples": 0}));
    }
}

/// With a turned and mirrored node, smooth normals, all maps at once, each placed by a transform of its own, their tint, a
/// sun and a glowing mesh.
#[test]
fn a_converted_file_has_the_same_image() {
    let texels = [[200, 90, 255], [30, 160, 140], [120, 128, 250], [255, 60, 200]];
    let place = |scale: f64, turn: f64| {
        let change = json!({"scale": [scale, 0.7], "rotation": turn, "offset": [0.1, scale]});
        json!({"index": 0, "extensions": {"KHR_texture_transform": change}})
    };
    let material = json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.3, 0.9, 0.7, 1], "metallicFactor": 0.8,
            "baseColorTexture": place(1.5, 0.0), "metallicRoughnessTexture": place(1.0, 0.4)
        },
        "normalTexture": with(place(0.5, 1.1), "scale", 0.7), "occlusionTexture": place(2.0, -0.3),
        "emissiveFactor": [0.2, 0.1, 0.3], "emissiveTexture": place(0.3, 2.0)
    });
    let mut file = mapped(texels, material);
    let normals =
        file.floats(&[[0.1, 0.2, 0.9], [0.3, 0.0, 1.0], [0.0, -0.1, 0.7], [0.0, 0.0, 1.0]]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
    file.json["nodes"][0] = json!({
        "mesh": 0, "name": "square", "rotation": [0.1, 0.2, 0.3, 0.9], "scale": [-0.9, 1.1, 1.3], "translation": [0.1, 0.2, 0.3]
    });
    let mut lamp = file.json["meshes"][0].clone();
    lamp["primitives"][0]["material"] =
        file.push("materials", json!({"emissiveFactor": [3, 2, 1]})).into();
    let lamp = file.push("meshes", lamp);
    file.node(json!({"mesh": lamp, "translation": [0, 3, 1], "rotation": [0.6, 0, 0, 0.8]}));
    file.light(
        json!({"type": "directional", "intensity": 0.123_456_789}),
        json!({"rotation": [0.3, 0.1, 0, 0.9]}),
    );
    let folder = folder();
    put(folder.path(), "a.glb", file.glb());
    let (film, json) = converted(&folder.path().join("a.glb"));
    assert!(film.same_bits(&rendered(loaded(&file))));
    assert_eq!(json["transfer"], "srgb");
    let shape = &json["scene"]["shapes"][0];
    assert_eq!((&shape["name"], &shape["encoding"]), (&json!("square"), &json!("srgb")));
    for key in ["emissionmap", "metalmap", "occlusionmap", "normalmap", "uvtransform"] {
        assert!(!shape[key].is_null(), "{key}");
    }
}

/// Normals and coordinates of their own at each corner, and none at some.
#[test]
fn a_converted_mesh_has_the_same_image() {
    let obj = "v -1 -1 0\nv 1 -1 0\nv 1 1 0.25\nv -1 1 0\nvn 0 0 1\nvn 0.3 0.1 1\nvn -0.2 0.5 0.8\n\
               vt 0 0\nvt 1 0.5\nf 1/1/1 2/2/2 3//3\nf 1//2 3//1 4\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0.1 0 0\n1 0.3 0\n0 1 -0.7\n3 0 1 2\n";
    for (name, text) in [("m.obj", obj), ("m.ply", ply)] {
        let folder = folder();
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("a file");
        let alone = load(&path, &small());
        assert!(
            alone.as_ref().is_ok_and(|scene| scene.notes[0].to_string().contains("studio lights"))
        );
        let (film, _) = converted(&path);
        let alone = rendered(alone);
        assert!(film.same_bits(&alone), "{name}");
        let lit = alone.pixels().iter().filter(|pixel| pixel[0] > 0.2).count();
        assert!(lit > 20, "{name} fills {lit} pixels only");
    }
}

/// A shape that instances alone show, and an instance for each node, at its place.
#[test]
fn shared_meshes_are_written_as_instances() {
    let mut file = square();
    file.json["meshes"][0]["name"] = json!("tile");
    file.node(json!({"mesh": 0, "translation": [0, 2, 0]}));
    let folder = folder();
    let out = folder.path().join("out.json");
    let written = write(&loaded(&file).expect("it is right"), &out, false).expect("it is written");
    assert_eq!(written, [folder.path().join("out-mesh0.ply"), out.clone()]);
    let json: Value = serde_json::from_slice(&std::fs::read(&out).expect("a file")).expect("JSON");
    let shapes = json["scene"]["shapes"].as_array().expect("a list");
    assert_eq!(
        (shapes.len(), &shapes[0]["hidden"], &shapes[0]["name"]),
        (1, &json!(true), &json!("tile"))
    );
    let row = |y: f64| {
        json!([
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, y],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0]
        ])
    };
    let instance = |y: f64| json!({"shape": "tile", "transform": row(y)});
    assert_eq!(json["scene"]["instances"], json!([instance(0.0), instance(2.0)]));
}
