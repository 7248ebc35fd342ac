//! What is refused, and in which words; what is warned of.

use std::path::Path;

use serde_json::{Value, json};
use wavecrest_base::error::Result;
use wavecrest_scene::load::LoadedScene;
use wavecrest_scene::systems;

use super::pose::{morphed, skinned};
use super::{File, SQUARE, SQUARE_UVS, load_bytes, loaded, small, square};
use crate::support::{edited, folder, put, ready};
use crate::transcript;

/// What is said of a file: an error, or warnings.
fn told(loaded: Result<LoadedScene>) -> String {
    match loaded {
        Ok(scene) if scene.warnings.is_empty() => "no word".to_owned(),
        Ok(scene) => scene.warnings.iter().map(|warning| format!("{warning}\n")).collect(),
        Err(error) => error.to_string(),
    }
}

/// What is said of a file, and then of its image.
fn told_with_the_image(file: &File) -> String {
    let warnings = told(loaded(file));
    let seen = systems::warnings(&ready(loaded(file)), Path::new("a.glb"));
    seen.iter().fold(warnings, |told, warning| format!("{told}\n{warning}"))
}

fn told_of_bytes(bytes: &[u8]) -> String {
    told(load_bytes(bytes.to_vec(), Path::new("a.glb"), &small()))
}

/// The square, and data that can take the place of its own.
fn stocked() -> File {
    let mut file = square();
    file.indices(&[0, 1, 4]);
    file.indices(&[0, 1, 65_535]);
    // Of these there is such a vertex.
    file.accessor(&vec![0; 65_536 * 12], 5126, 65_536, "VEC3");
    for bad in [f32::NAN, f32::INFINITY, 1e13] {
        let mut points = SQUARE;
        points[2][1] = bad;
        file.floats(&points);
    }
    file.floats(&SQUARE_UVS[..3]);
    assert_eq!(file.json["accessors"].as_array().map(Vec::len), Some(10));
    // Places that do not increase, do not increase, and are beyond the end.
    let views = [[3, 3], [2, 1], [2, 4]].map(|places| file.view(&places));
    assert_eq!(views, [10, 11, 12]);
    file
}

/// `square`, `skinned`, `morphed` and `stocked` are edited as the lines say; `byte` changes some of the
/// square as a binary file, `content` is all that a file has, `buffer` names what the square's buffer is,
/// and `image` asks what is said of the square's image too.
#[test]
fn files_that_are_wrong_are_told_with_the_places() {
    let folder = folder();
    put(folder.path(), "short.bin", [0; 10]);
    put(folder.path(), "whole.bin", square().bytes);
    let whole = square().glb();
    let of = |file: File, changes: &str| File { json: edited(file.json, changes), ..file };
    transcript::check("gltf", |input, more| match input.split(' ').collect::<Vec<_>>()[..] {
        ["square"] => told(loaded(&of(square(), more))),
        ["skinned"] => told(loaded(&of(skinned(), more))),
        ["morphed"] => told(loaded(&of(morphed(), more))),
        ["stocked"] => told(loaded(&of(stocked(), more))),
        ["image"] => told_with_the_image(&of(square(), more)),
        ["byte", place, ref values @ ..] => {
            let mut wrong = whole.clone();
            let place: usize = place.parse().expect("a number");
            for (byte, value) in wrong[place..].iter_mut().zip(values) {
                *byte = value.parse().expect("a byte");
            }
            told_of_bytes(&wrong)
        }
        ["content"] => told_of_bytes(more.as_bytes()),
        ["buffer", uri] => {
            let mut json: Value = serde_json::from_str(&square().text(uri)).expect("JSON");
            if uri == "none" {
                json["buffers"][0].as_object_mut().expect("an object").remove("uri");
            }
            let path = folder.path().join("a.gltf");
            let told = told(load_bytes(json.to_string().into_bytes(), &path, &small()));
            told.replace(&folder.path().display().to_string(), "FOLDER")
        }
        _ => panic!("{input}"),
    });
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
    let positions = file.floats(&SQUARE);
    let primitive = json!({"attributes": {"POSITION": positions}, "indices": indices});
    file.push("meshes", json!({"primitives": vec![primitive; 200]}));
    file.node(json!({"mesh": 0}));
    let text = told(loaded(&file));
    assert!(text.contains("the accessors of the file overlap too much"), "{text}");
}
