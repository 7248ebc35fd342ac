//! What is refused, and in which words; what is warned of.

use std::path::Path;

use serde_json::{Value, json};

use super::{File, load_bytes, loaded, small, square};
use crate::support::folder;

#[track_caller]
fn refusal(file: &File) -> String {
    loaded(file).map(|_| ()).expect_err("it is wrong").to_string()
}

/// The place of each error.
#[track_caller]
fn refused_places(file: &File) -> Vec<String> {
    let place = |line: &str| line.split(": ").nth(1).unwrap_or_default().to_owned();
    refusal(file).lines().map(place).collect()
}

fn refused_bytes(bytes: &[u8]) -> String {
    let loaded = load_bytes(bytes.to_vec(), Path::new("a.glb"), &small());
    loaded.map(|_| ()).expect_err("it is wrong").to_string()
}

/// Each names the file, the place in it, and what is wrong there.
#[test]
fn errors_are_reported_with_their_places() {
    let mesh = "/meshes/0/primitives/0";
    let cases: Vec<(&str, Value, &str)> = vec![
        ("/asset/version", json!("1.0"), "asset.version: only glTF 2.0 is read, found \"1.0\""),
        (
            "/nodes/0/mesh",
            json!(7),
            "nodes[0].mesh: must be the index of one of the meshes, found 7; the file has 1",
        ),
        ("/nodes/0/mesh", json!("x"), "nodes[0].mesh: must be the index"),
        (
            "/nodes/0",
            json!({"mesh": 0, "children": [0]}),
            "nodes[0]: the node is its own descendant",
        ),
        (
            "/nodes/0",
            json!({"mesh": 0, "children": [9]}),
            "nodes[0].children[0]: must be the index of one of the nodes",
        ),
        (
            "/nodes/0",
            json!({"children": [1, 1]}),
            "nodes[0].children[1]: node 1 is already a child of node 0",
        ),
        ("/nodes/0", json!({"children": [1]}), "scenes[0]: node 1 must appear once"),
        ("/nodes/0", json!({"matrix": [1, 2]}), "nodes[0].matrix: must be 16 numbers"),
        (
            "/nodes/0",
            json!({"scale": [1, 1, 1], "matrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}),
            "nodes[0]: has both a matrix and a scale",
        ),
        (
            "/nodes/0",
            json!({"matrix": [1,0,0,5,0,1,0,0,0,0,1,0,0,0,0,1]}),
            "nodes[0].matrix: the last row must be",
        ),
        ("/nodes/0", json!({"rotation": [0, 0, 0, 0]}), "nodes[0].rotation: must be a quaternion"),
        ("/nodes", json!({}), "nodes: must be a list"),
        ("/meshes/0", json!({}), "meshes[0].primitives: is missing"),
        ("/meshes/0/primitives", json!({"a": 1}), "meshes[0].primitives: must be a list"),
        (
            mesh,
            json!({"attributes": {"POSITION": 3}}),
            "meshes[0].primitives[0].attributes.POSITION: must be the index of one of the accessors, found 3",
        ),
        (
            mesh,
            json!({"attributes": {"POSITION": 1}}),
            "meshes[0].primitives[0].attributes.POSITION: must be VEC3 of floats, found accessors[1]",
        ),
        (
            mesh,
            json!({"attributes": {"POSITION": 0}, "indices": 1}),
            "meshes[0].primitives[0].indices: indices must be SCALAR",
        ),
        (
            mesh,
            json!({"attributes": {"POSITION": 0}, "mode": 7}),
            "meshes[0].primitives[0].mode: must be a whole number from 0 to 6",
        ),
        (
            mesh,
            json!({"attributes": {"POSITION": 0}, "material": 1}),
            "meshes[0].primitives[0].material: must be the index",
        ),
        (
            "/accessors/0/count",
            json!(5),
            "accessors[0]: needs 60 bytes of a buffer view that has 48",
        ),
        ("/accessors/0/count", json!(9_007_199_254_740_991_u64), "accessors[0]: needs"),
        ("/accessors/0/count", json!(-1), "accessors[0].count: must be a whole number"),
        ("/accessors/0/componentType", json!(5124), "accessors[0].componentType: must be 5120"),
        ("/accessors/0/type", json!("VEC5"), "accessors[0].type: must be \"SCALAR\""),
        ("/accessors/0/bufferView", Value::Null, "accessors[0].bufferView: must be the index"),
        (
            "/bufferViews/0/byteLength",
            json!(1_000_000_000),
            "bufferViews[0]: ends at byte 1000000000, past the end of the buffer at 92",
        ),
        (
            "/bufferViews/0/byteOffset",
            json!(1e300),
            "bufferViews[0].byteOffset: must be a whole number",
        ),
        (
            "/bufferViews/0/buffer",
            json!(1),
            "bufferViews[0].buffer: must be the index of one of the buffers",
        ),
        (
            "/cameras/0/perspective/yfov",
            json!(3.2),
            "cameras[0].perspective.yfov: in degrees, must be",
        ),
        ("/cameras/0/type", json!("fisheye"), "cameras[0].type: must be"),
        (
            "/materials/0/pbrMetallicRoughness/metallicFactor",
            json!(2),
            "materials[0].pbrMetallicRoughness.metallicFactor: must be a number from 0 to 1",
        ),
        ("/scene", json!(1), "scene: must be the index of one of the scenes"),
    ];
    for (place, value, words) in cases {
        let text = refusal(&square().with(place, value.clone()));
        assert!(text.starts_with("a.glb: ") && text.contains(words), "{place} {value}: {text}");
    }
}

/// Errors of one list leave the others to be read, and indices into it are those of the file.
#[test]
fn faults_of_all_lists_are_told_at_once() {
    let mut file = square();
    file.json["accessors"][1]["type"] = json!("VEC5");
    file.json["accessors"][2]["count"] = json!(-1);
    file.json["samplers"] = json!([{"wrapS": 1}]);
    file.json["textures"] = json!([{"sampler": 0}, {"sampler": 1}]);
    file.json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(2);
    file.push("materials", json!({"emissiveTexture": {"index": 2}}));
    file.push("meshes", json!({}));
    file.push("cameras", json!({"type": "fisheye"}));
    file.json["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = json!("x");
    file.node(json!({"mesh": 1, "camera": 1, "scale": 2}));
    let expected = [
        "accessors[1].type",
        "accessors[2].count",
        "samplers[0].wrapS",
        "textures[1].sampler",
        "materials[0].pbrMetallicRoughness.metallicFactor",
        "materials[1].emissiveTexture.index",
        "meshes[1].primitives",
        "cameras[1].type",
        "extensions.KHR_lights_punctual.lights[0].intensity",
        "nodes[3].scale",
    ];
    assert_eq!(refused_places(&file), expected);
    file.push("materials", json!({"alphaCutoff": -1}));
    assert!(refusal(&file).ends_with("\n1 more error is not listed"), "{}", refusal(&file));
}

/// Neither accessors nor images can be read without their buffer: there is one error, not three.
#[test]
fn what_follows_from_a_fault_is_not_told() {
    let mut file = square();
    file.json["images"] = json!([{"bufferView": 0}]);
    file.json["bufferViews"][0]["buffer"] = json!(1);
    let instancing = json!({"attributes": {"TRANSLATION": 0}});
    file.node(json!({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": instancing}}));
    assert_eq!(refused_places(&file), ["bufferViews[0].buffer"]);
}

#[test]
fn faults_in_the_data_of_all_meshes_are_told_at_once() {
    let mut file = square();
    let indices = file.indices(&[0, 1, 4]);
    let primitive = json!({"attributes": {"POSITION": 0}, "indices": indices});
    file.push("meshes", json!({"primitives": [primitive, primitive]}));
    file.push("meshes", json!({"primitives": [{"attributes": {"POSITION": 1}}]}));
    file.node(json!({"mesh": 1}));
    let expected = [
        "meshes[1].primitives[0].indices[2]",
        "meshes[1].primitives[1].indices[2]",
        "meshes[2].primitives[0].attributes.POSITION",
    ];
    assert_eq!(refused_places(&file), expected);
}

#[test]
fn indices_and_positions_that_are_wrong_are_named() {
    let mut file = square();
    let number = file.indices(&[0, 1, 4]);
    let text = refusal(&file.with("/meshes/0/primitives/0/indices", number));
    assert!(
        text.contains("indices[2]: there is no such vertex, found 4; the mesh has 4"),
        "{text}"
    );
    let number = file.indices(&[0, 1, 65_535]);
    let text = refusal(&file.with("/meshes/0/primitives/0/indices", number));
    assert!(text.contains("indices[2]: the greatest number of a type is reserved"), "{text}");
    // Though there is such a vertex.
    let mut file = square();
    let positions = file.accessor(&vec![0; 65_536 * 12], 5126, 65_536, "VEC3");
    let indices = file.indices(&[0, 1, 65_535]);
    file.json["meshes"][0]["primitives"][0] =
        json!({"attributes": {"POSITION": positions}, "indices": indices});
    let text = refusal(&file);
    assert!(text.contains("indices[2]: the greatest number of a type is reserved"), "{text}");
    for bad in [f32::NAN, f32::INFINITY, 1e13] {
        let mut points = super::SQUARE;
        points[2][1] = bad;
        let mut file = square();
        let number = file.floats(&points);
        let text = refusal(&file.with("/meshes/0/primitives/0/attributes/POSITION", number));
        assert!(
            text.contains("attributes.POSITION[2]: the coordinates of a vertex must"),
            "{text}"
        );
    }
    let mut file = square();
    let short = file.floats(&super::SQUARE_UVS[..3]);
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    file.json["textures"] = json!([{"source": 0}]);
    file.json["images"] = json!([{"bufferView": 0}]);
    let text = refusal(&file.with("/meshes/0/primitives/0/attributes/TEXCOORD_0", short));
    assert!(
        text.contains("TEXCOORD_0: must have as many elements as POSITION, 4, found 3"),
        "{text}"
    );
}

#[test]
fn sparse_parts_that_are_wrong_are_refused() {
    for (which, count) in [([3, 3], 4), ([2, 1], 4), ([2, 4], 4)] {
        let mut file = square();
        let indices = file.view(&which);
        file.json["accessors"][0]["sparse"] = json!({
            "count": 2, "indices": {"bufferView": indices, "componentType": 5121}, "values": {"bufferView": 0}
        });
        let text = refusal(&file);
        let words = format!(
            "accessors[0].sparse.indices: must increase, and stay below the accessor's count of {count}"
        );
        assert!(text.contains(&words), "{text}");
    }
    let mut file = square();
    file.json["accessors"][0] =
        json!({"componentType": 5126, "count": 4_000_000_000_u64, "type": "VEC3"});
    assert!(
        refusal(&file).contains("accessors[0].count: the data of this many elements is missing")
    );
}

/// A small file that names the same bytes again and again.
#[test]
fn memory_is_not_allocated_by_the_claims_of_a_file() {
    let mut file = File::new();
    let bytes = vec![0; 3 << 20];
    let view = file.view(&bytes);
    let indices = file.push(
        "accessors",
        json!({"bufferView": view, "componentType": 5121, "count": 3 << 20, "type": "SCALAR"}),
    );
    let positions = file.floats(&super::SQUARE);
    let primitive = json!({"attributes": {"POSITION": positions}, "indices": indices});
    file.push("meshes", json!({"primitives": vec![primitive; 200]}));
    file.node(json!({"mesh": 0}));
    let text = refusal(&file);
    assert!(text.contains("the accessors of the file overlap too much"), "{text}");
}

#[test]
fn extensions_that_are_required_must_be_known() {
    let mut file = square();
    file.json["extensionsRequired"] =
        json!(["KHR_texture_transform", "KHR_draco_mesh_compression", "X_y"]);
    let text = refusal(&file);
    let words = "extensionsRequired: the file requires unsupported extensions, found \
                 KHR_draco_mesh_compression, X_y; export it without compression";
    assert!(text.contains(words), "{text}");
    file.json["extensionsRequired"] = json!([]);
    file.json["extensionsUsed"] = json!(["A_b", "KHR_lights_punctual", "C_d"]);
    let warnings = loaded(&file).expect("it is right").warnings;
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].to_string().contains("unsupported extensions: A_b, C_d"), "{warnings:?}");
}

#[test]
fn binary_files_that_are_cut_or_wrong_are_refused() {
    let whole = square().glb();
    for length in 0..whole.len() {
        refused_bytes(&whole[..length]);
    }
    let with = |place: usize, bytes: &[u8]| {
        let mut wrong = whole.clone();
        wrong[place..place + bytes.len()].copy_from_slice(bytes);
        refused_bytes(&wrong)
    };
    for (place, bytes, words) in [
        (4, &[1_u8][..], "a.glb: byte 4: only version 2 of GLB is read, found 1"),
        (8, &[0; 4], "a.glb: byte 8: the length in the header is wrong"),
        (12, &[255; 4], "a.glb: byte 12: the chunk is longer than the file"),
        (
            16,
            b"TEXT",
            "a.glb: byte 12: the first chunk of a GLB file must be of the type JSON, found TEXT",
        ),
        (20, &[255], "a.glb: the JSON is not UTF-8 text from byte 0 on"),
        (20, b"[", "a comma or a closing bracket is missing"),
        (0, b"glTX", "a.glb: a file must begin with"),
    ] {
        let text = with(place, bytes);
        assert!(text.contains(words), "{text}");
    }
    assert!(refused_bytes(b"").contains("the file is empty"));
    assert!(refused_bytes(b"[]").contains("must be a glTF file, an object"));
    assert!(refused_bytes(b"{}").contains("asset: is missing"));
    assert!(refused_bytes(&b"[".repeat(100_000)).contains("nested too deeply"));
}

#[test]
fn buffers_that_are_not_there_are_refused() {
    let folder = folder();
    let path = folder.path().join("a.gltf");
    std::fs::write(folder.path().join("short.bin"), [0; 10]).expect("a file");
    let refused = |text: String| {
        let loaded = load_bytes(text.into_bytes(), &path, &small());
        loaded.map(|_| ()).expect_err("it is wrong").to_string()
    };
    let file = square();
    for (uri, words) in [
        ("none.bin", "buffers[0].uri: cannot read the buffer"),
        ("short.bin", "buffers[0].byteLength: the length of the buffer is wrong"),
        (".", "is not a regular file"),
        ("/etc/hostname", "buffers[0].uri: is outside the folder of the glTF file"),
        ("../none.bin", "copy it there, or allow others with --allow-outside"),
        ("https://x.y/z.bin", "URLs are not read"),
        ("data:application/octet-stream;base64,!!", "buffers[0].uri: the data is not base64"),
    ] {
        let text = refused(file.text(uri));
        assert!(
            text.starts_with(&format!("{}: ", path.display())) && text.contains(words),
            "{text}"
        );
    }
    let mut json: Value = serde_json::from_str(&file.embedded()).expect("JSON");
    json["buffers"][0].as_object_mut().expect("an object").remove("uri");
    assert!(refused(json.to_string()).contains("buffers[0]: has no uri"));
}

/// Each kind of thing that is left out is told once.
#[test]
fn omissions_are_reported_once() {
    let mut file = square();
    let primitive = file.json["meshes"][0]["primitives"][0].clone();
    let mut lines = primitive.clone();
    lines["mode"] = 1.into();
    file.json["meshes"][0]["primitives"] = json!([primitive, lines, lines]);
    file.json["materials"][0]["alphaMode"] = json!("BLEND");
    file.push("materials", json!({"alphaMode": "MASK"}));
    file.json["animations"] = json!([{}]);
    file.light(json!({"type": "spot", "spot": {}, "range": 9}), json!({"translation": [0, 0, 9]}));
    file.light(json!({"type": "moon"}), json!({}));
    file.node(json!({"mesh": 0, "scale": [1, 0, 1]}));
    let warnings = loaded(&file).expect("it is right").warnings;
    for words in [
        "points and lines are left out",
        "alpha blending is not supported",
        "animations and skins",
        "the range of the light",
        "the type of the light is unknown",
        "nodes with a scale of 0",
    ] {
        let told = warnings.iter().filter(|w| w.to_string().contains(words)).count();
        assert_eq!(told, 1, "{words}: {warnings:?}");
    }
}
