//! Tests of the loader: what a valid file becomes, and which message each invalid file gets.
//!
//! They edit one complete scene at a JSON path, so that each case shows what it is about and no more.

mod changes;
mod files;
mod generate;
mod tables;
mod walk;

use std::path::Path;

use serde_json::Value;

use crate::schema::places;
use crate::support::edited;
use wavecrest_base::error::Result;
use wavecrest_scene::load::{LoadOptions, LoadedScene, load_str};

/// A scene that has every key of the format (but those that another one excludes) and no fault.
/// Its textures and its mesh are files that exist; they are not decoded here.
fn complete() -> Value {
    include_str!("scene/complete.json").parse().unwrap()
}

/// The value at a JSON path such as `scene.shapes[3].radius`.
fn pointer(path: &str) -> String {
    format!("/{}", path.replace(['.', '['], "/").replace(']', ""))
}

/// The scene with the value at `path` set, which need not be there yet.
fn set(scene: Value, path: &str, value: Value) -> Value {
    edited(scene, &format!("{} {value}", pointer(path)))
}

/// The scene without the value at `path`.
fn remove(scene: Value, path: &str) -> Value {
    edited(scene, &pointer(path))
}

fn load_options(scene: &Value, options: LoadOptions) -> Result<LoadedScene> {
    load_str(&scene.to_string(), Path::new("s.json"), &options)
}

fn load(scene: &Value) -> Result<LoadedScene> {
    load_options(scene, LoadOptions::default())
}

/// The paths of all values.
fn all_paths() -> Vec<String> {
    let mut all = Vec::new();
    places(&complete(), "", &mut all);
    let path = |place: String| {
        place.split('/').skip(1).fold(String::new(), |path, part| match part.parse::<u32>() {
            Ok(number) => format!("{path}[{number}]"),
            Err(_) if path.is_empty() => part.to_owned(),
            Err(_) => format!("{path}.{part}"),
        })
    };
    all.into_iter().map(path).collect()
}
