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
fn set(mut scene: Value, path: &str, value: Value) -> Value {
    let pointer = pointer(path);
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match scene.pointer_mut(parent).unwrap() {
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        object => object[key] = value,
    }
    scene
}

/// The scene without the value at `path`.
fn remove(mut scene: Value, path: &str) -> Value {
    let pointer = pointer(path);
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    scene.pointer_mut(parent).unwrap().as_object_mut().unwrap().remove(key).unwrap();
    scene
}

fn without(path: &str) -> Value {
    remove(complete(), path)
}

fn load_options(scene: &Value, options: LoadOptions) -> Result<LoadedScene> {
    load_str(&scene.to_string(), Path::new("s.json"), &options)
}

fn load(scene: &Value) -> Result<LoadedScene> {
    load_options(scene, LoadOptions::default())
}

/// The paths of all values in `value`, itself included.
fn paths(value: &Value, path: &str, all: &mut Vec<String>) {
    if !path.is_empty() {
        all.push(path.to_owned());
    }
    match value {
        Value::Object(map) => {
            let dot = if path.is_empty() { "" } else { "." };
            map.iter().for_each(|(key, value)| paths(value, &format!("{path}{dot}{key}"), all));
        }
        Value::Array(items) => {
            let items = items.iter().enumerate();
            items.for_each(|(i, value)| paths(value, &format!("{path}[{i}]"), all));
        }
        _ => {}
    }
}

fn all_paths() -> Vec<String> {
    let mut all = Vec::new();
    paths(&complete(), "", &mut all);
    all
}
