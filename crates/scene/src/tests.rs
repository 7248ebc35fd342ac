//! Tests of the loader: what a valid file becomes, and which message each invalid file gets.
//!
//! They edit one complete scene at a JSON path, so that each case shows what it is about and no more.

mod corners;
mod defaults;
mod files;
mod geometry;
mod limits;
mod messages;
mod shapes;
mod walk;

use std::path::Path;

use glam::Vec3;
use serde_json::{Value, json};

use super::load::{LoadOptions, LoadedScene, load_with};
use super::mesh::{LoadedMesh, MeshData};
use wavecrest_base::error::{Error, Result};

/// A scene that has every key of the format (but those that another one excludes) and no fault.
/// Its textures and its mesh are files that exist; they are not decoded here.
fn complete() -> Value {
    let material = json!({
        "ks": 0.5, "kd": 0.5, "specularexponent": 20, "diffusecolor": [1, 0, 1], "kr": 0.25
    });
    let quad = json!([[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]);
    json!({
        "nbounces": 3,
        "transfer": "srgb",
        "camera": {
            "type": "thinlens", "width": 640, "height": 480, "fov": 60, "fovaxis": "x",
            "location": [0, 0, 5], "look": [0, 0, 0], "up": [0, 1, 0], "antialias": 2,
            "aperture": 2, "focal": 10, "sampling": "random", "nsamplesx": 5, "nsamplesy": 6
        },
        "scene": {
            "backgroundcolor": [0.1, 0.2, 0.3],
            "ambient": 0.1,
            "lightsources": [
                { "type": "pointlight", "intensity": 50, "position": [1, 2, 3],
                  "color": [1, 1, 1], "falloff": "none" },
                { "type": "arealight", "intensity": 40, "position": [1, 2, 3],
                  "color": [0, 1, 0], "falloff": "linear", "sampling": "jittered", "samples": 4,
                  "shape": { "type": "plane", "points": quad, "normal": -1 } }
            ],
            "shapes": [
                { "type": "sphere", "name": "ball", "center": [1, 2, 3], "radius": 4,
                  "material": material, "texture": "Cargo.toml", "filter": "nearest",
                  "wrap": "clamp", "encoding": "srgb", "tint": [0.5, 1, 0.25], "sides": "front", "shading": "flat",
                  "transform": { "translate": [1, 2, 3], "rotate": [0, 90, 0], "scale": 2 } },
                { "type": "plane", "points": quad, "normal": [0, 0, 1], "material": material },
                { "type": "triangle", "points": [[0, 0, 0], [0, 1, 0], [1, 0, 0]], "normal": 1,
                  "material": material,
                  "transform": [[2, 0, 0, 1], [0, 2, 0, 2], [0, 0, 2, 3], [0, 0, 0, 1]] },
                { "type": "trimesh", "size": 4, "points": quad, "normal": [0, -1],
                  "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]],
                  "normals": [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1]],
                  "shading": "smooth", "material": material },
                { "type": "trimesh", "points": quad, "indices": [[0, 1, 2], [0, 2, 3]],
                  "material": material },
                { "type": "trimesh", "file": "src/lib.rs", "material": material }
            ]
        }
    })
}

/// The value at a JSON path such as `scene.shapes[3].radius`.
fn pointer(path: &str) -> String {
    format!("/{}", path.replace(['.', '['], "/").replace(']', ""))
}

/// The complete scene with the value at `path` set, which need not be there yet.
fn with(path: &str, value: Value) -> Value {
    set(complete(), path, value)
}

fn set(mut scene: Value, path: &str, value: Value) -> Value {
    let pointer = pointer(path);
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match scene.pointer_mut(parent).unwrap() {
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        object => object[key] = value,
    }
    scene
}

/// The complete scene without the value at `path`.
fn without(path: &str) -> Value {
    let mut scene = complete();
    let pointer = pointer(path);
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    scene.pointer_mut(parent).unwrap().as_object_mut().unwrap().remove(key).unwrap();
    scene
}

/// A mesh reader that answers with one triangle.
fn one_triangle(_: &Path) -> Result<LoadedMesh> {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = MeshData { positions, triangles: vec![[0, 1, 2]], ..MeshData::default() };
    Ok(LoadedMesh { mesh, ..LoadedMesh::default() })
}

fn load_options(scene: &Value, options: LoadOptions) -> Result<LoadedScene> {
    load_with(&scene.to_string(), Path::new("s.json"), &options, one_triangle)
}

fn load(scene: &Value) -> Result<LoadedScene> {
    load_options(scene, LoadOptions::default())
}

fn strictly(scene: &Value) -> Result<LoadedScene> {
    load_options(scene, LoadOptions { strict: true, ..LoadOptions::default() })
}

/// The error of a scene, which must have one.
fn error(scene: &Value) -> Error {
    load(scene).err().expect("an error")
}

/// The warnings of a scene, without the name of the file.
fn warnings(scene: &Value) -> Vec<String> {
    let scene = load(scene).unwrap();
    scene.warnings.iter().map(|w| w.to_string().strip_prefix("s.json: ").unwrap().into()).collect()
}

/// Checks that the complete scene, with `value` at `path`, is refused with `message`.
fn refused(path: &str, value: Value, message: &str) {
    let scene = with(path, value);
    assert_eq!(error(&scene).to_string(), format!("s.json: {message}"), "{path}");
}

/// Checks that the complete scene, with `value` at `path`, is accepted with one warning.
fn warned(path: &str, value: Value, message: &str) {
    assert_eq!(warnings(&with(path, value)), [message], "{path}");
}

/// Checks that the complete scene, with `value` at `path`, is accepted without a warning.
fn accepted(path: &str, value: Value) -> LoadedScene {
    let scene = load(&with(path, value)).unwrap();
    assert_eq!(scene.warnings, [], "{path}");
    scene
}

/// The one component of its kind in the world.
fn only<C: hecs::Component + Clone>(scene: &LoadedScene) -> C {
    let found: Vec<C> = scene.world.query::<&C>().iter().cloned().collect();
    assert_eq!(found.len(), 1);
    found[0].clone()
}

/// The component of the entity at a JSON path.
fn at<C: hecs::Component + Clone>(scene: &LoadedScene, path: &str) -> Option<C> {
    use super::components::JsonPath;
    let mut query = scene.world.query::<(&JsonPath, Option<&C>)>();
    query.iter().find(|(p, _)| p.0 == path).expect("an entity at the path").1.cloned()
}
