//! The JSON Schema of scene files says what the parser does.

use jsonschema::Validator;
use jsonschema::error::ValidationErrorKind;
use serde_json::{Value, json};
use wavecrest_base::error::Error;
use wavecrest_scene::json_schema;
use wavecrest_scene::load::{LoadOptions, load_str};

use crate::support::{files_in, folder, repository, scene_files, wavecrest};

fn validator() -> Validator {
    jsonschema::validator_for(&json_schema()).expect("the schema is one")
}

/// Loads a scene whose files are beside it, strictly.
fn parse(scene: &Value) -> Result<(), Error> {
    let options = LoadOptions { strict: true, ..LoadOptions::default() };
    load_str(&scene.to_string(), &repository("tests/fuzz/files/s.json"), &options).map(|_| ())
}

/// A scene with each kind of everything, and every key of each.
fn complete() -> Value {
    let material = json!({"ks": 0.5, "kd": 0.5, "specularexponent": 20, "diffusecolor": [1, 0, 1], "kr": 0.25});
    let quad = json!([[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]);
    let corners = json!([[0, 0, 0], [0, 1, 0], [1, 0, 0]]);
    let light = |shape: Value| {
        json!({"type": "arealight", "intensity": 40, "position": [1, 2, 3], "color": [0, 1, 0],
               "falloff": "linear", "sampling": "jittered", "samples": 4, "shape": shape})
    };
    json!({
        "$schema": "scene.schema.json",
        "nbounces": 3,
        "transfer": "srgb",
        "camera": {
            "type": "thinlens", "width": 640, "height": 480, "fov": 60, "fovaxis": "x",
            "location": [0, 0, 5], "look": [0, 0, 0], "up": [0, 1, 0], "antialias": 2,
            "aperture": 2, "focal": 10, "sampling": "random", "nsamplesx": 5, "nsamplesy": 6,
            "path": {"interpolation": "linear", "keys": [
                {"frame": 1, "location": [0, 0, 6], "look": [1, 0, 0], "up": [0, 1, 0], "fov": 50,
                 "focal": 9}
            ]}
        },
        "scene": {
            "backgroundcolor": [0.1, 0.2, 0.3],
            "ambient": 0.1,
            "instances": [
                {"shape": "ball", "name": "twin", "transform": {"translate": [9, 0, 0]},
                 "material": material},
                {"shape": "floor", "id": "ceiling"}
            ],
            "lightsources": [
                {"type": "pointlight", "intensity": 50, "position": [1, 2, 3], "color": [1, 1, 1],
                 "falloff": "none"},
                {"type": "spotlight", "intensity": 50, "position": [1, 2, 3], "color": [1, 1, 1],
                 "direction": [0, -1, 0], "inner": 10, "outer": 20, "falloff": "none"},
                {"type": "directionallight", "intensity": 1, "color": [1, 1, 1],
                 "direction": [0, -1, 0], "angle": 0.5, "sampling": "random", "samples": 2},
                light(json!({"type": "plane", "points": quad, "normal": -1, "sides": "both"})),
                light(json!({"type": "sphere", "center": [9, 9, 9], "radius": 1})),
                light(json!({"type": "triangle", "points": corners})),
                light(json!({"type": "trimesh", "points": quad, "indices": [[0, 1, 2]]}))
            ],
            "shapes": [
                {"type": "sphere", "name": "ball", "center": [1, 2, 3], "radius": 4,
                 "material": material, "texture": "texture.pnm", "filter": "nearest",
                 "wrap": "clamp", "encoding": "srgb",
                 "tint": [0.5, 1, 2], "alphacutoff": 0.25, "alpha": "texture.pnm", "sides": "front", "shading": "flat",
                 "transform": {"translate": [1, 2, 3], "rotate": [0, 90, 0], "scale": 2}},
                {"type": "plane", "id": "floor", "hidden": true, "points": quad, "normal": [0, 0, 1],
                 "material": material, "transform": {"scale": [1, 2, 3]}},
                {"type": "triangle", "points": corners, "normal": 1, "material": material,
                 "transform": [[2, 0, 0, 1], [0, 2, 0, 2], [0, 0, 2, 3], [0, 0, 0, 1]]},
                {"type": "trimesh", "size": 4, "points": quad, "normal": [0, -1],
                 "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]],
                 "normals": [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1]],
                 "colors": [[0, 0.5, 1], [1, 1, 1], [2, 0, 0], [0, 0, 0]],
                 "shading": "smooth", "material": material},
                {"type": "trimesh", "points": quad, "indices": [[0, 1, 2], [0, 2, 3]],
                 "material": material},
                {"type": "trimesh", "file": "mesh.obj", "vertexcolors": "linear", "materials": "file",
                 "material": material}
            ]
        }
    })
}

/// The complete scene with a pinhole camera.
fn with_pinhole() -> Value {
    let mut scene = complete();
    scene["scene"]["ambient"] =
        json!({"sky": [0.2, 0.3, 0.4], "ground": [0.1, 0, 0], "up": [0, 0, 1]});
    scene["camera"] = json!({"type": "pinhole", "width": 64, "height": 48, "fov": 60,
                             "position": [0, 0, 5], "lookat": [0, 0, 0], "sampling": "sobol",
                             "path": {"keys": [{"frame": 3, "location": [0, 0, 7]}]}});
    scene
}

/// The places of all values below `value`, as JSON pointers.
fn places(value: &Value, at: &str, all: &mut Vec<String>) {
    let mut below = |key: &str, value: &Value| {
        let place = format!("{at}/{key}");
        all.push(place.clone());
        places(value, &place, all);
    };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| below(key, value)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, value)| below(&i.to_string(), value));
        }
        _ => {}
    }
}

fn places_of(scene: &Value) -> Vec<String> {
    let mut all = Vec::new();
    places(scene, "", &mut all);
    all
}

fn removed(scene: &Value, place: &str) -> Value {
    let mut scene = scene.clone();
    let (parent, key) = place.rsplit_once('/').expect("a pointer");
    match scene.pointer_mut(parent).expect("it is there") {
        Value::Array(items) => {
            items.remove(key.parse::<usize>().expect("a number"));
        }
        Value::Object(map) => {
            map.remove(key);
        }
        _ => panic!("{place} is in nothing"),
    }
    scene
}

/// What may stand where something else did: other types, and numbers on both sides of every bound.
fn replacements() -> Vec<Value> {
    let numbers = [
        json!(-1),
        json!(0),
        json!(1),
        json!(2),
        json!(0.5),
        json!(-0.25),
        json!(64),
        json!(65),
        json!(4096),
        json!(4097),
        json!(10_000),
        json!(10_001),
        json!(65_536),
        json!(65_537),
        json!(179),
        json!(179.5),
        json!(1e-4),
        json!(1_000_000),
        json!(1_000_001),
        json!(4_294_967_295_u64),
        json!(4_294_967_296_u64),
        json!(1_099_511_627_776_u64),
        json!(1_099_511_627_777_u64),
        json!(-1e12),
        json!(-2e12),
        json!(1e300),
    ];
    let others = [
        json!(null),
        json!(true),
        json!({}),
        json!([]),
        json!(""),
        json!("text"),
        json!("sobol"),
        json!("sphere"),
        json!("trimesh"),
        json!("pinhole"),
        json!("pointlight"),
        json!("both"),
        json!([0, 0, 0]),
        json!([0, -1, 0.5]),
        json!([0, 1]),
        json!([[0, 0, 0]]),
        json!([1, 2, 3, 4]),
        json!([2e12, 0, 0]),
        json!({"type": "sphere"}),
        json!({"scale": 0.5}),
        json!([[0, 0, 0], [0, 1, 0], [1, 0, 0]]),
    ];
    numbers.into_iter().chain(others).collect()
}

/// Whether a refusal is about the type or the range of one value, or about a key: what a schema can tell. Not
/// so where lists must have the length of others, or numbers must be those of points.
fn is_about_one_value(error: &str) -> bool {
    let about_others = ["must be the number of points", "one for each", "must be three indices"];
    let about_one = [": is missing", "must be ", "is not a key of", "not both"];
    about_one.iter().any(|words| error.contains(words))
        && !about_others.iter().any(|words| error.contains(words))
}

#[test]
fn the_schema_follows_its_own_dialect() {
    assert!(jsonschema::meta::is_valid(&json_schema()));
}

#[test]
fn every_scene_of_the_repository_is_valid() {
    let validator = validator();
    let large = files_in("scenes/large", "json");
    for path in scene_files().into_iter().map(|(_, path)| path).chain(large) {
        let text = std::fs::read_to_string(&path).expect("a scene");
        let scene: Value = serde_json::from_str(&text).expect("JSON");
        let wrong: Vec<_> = validator.iter_errors(&scene).map(|e| e.to_string()).collect();
        assert!(wrong.is_empty(), "{}: {wrong:?}", path.display());
    }
}

/// What the parser takes the schema takes, and what the parser refuses for its own sake the schema refuses.
#[test]
fn the_schema_and_the_parser_agree_on_every_changed_value() {
    let validator = validator();
    let (mut taken, mut refused) = (0, 0);
    for scene in [complete(), with_pinhole()] {
        assert!(parse(&scene).is_ok() && validator.is_valid(&scene));
        for place in places_of(&scene) {
            let changed = replacements().into_iter().map(|value| {
                let mut scene = scene.clone();
                *scene.pointer_mut(&place).expect("it is there") = value;
                scene
            });
            for changed in changed.chain([removed(&scene, &place)]) {
                let is_valid = validator.is_valid(&changed);
                let found = changed.pointer(&place);
                match parse(&changed).map_err(|error| error.to_string()) {
                    Ok(()) => {
                        assert!(is_valid, "{place}: {found:?} is loaded");
                        taken += 1;
                    }
                    Err(told) if is_about_one_value(&told) => {
                        assert!(!is_valid, "{place}: {found:?}: {told}");
                        refused += 1;
                    }
                    Err(_) => {}
                }
            }
        }
    }
    assert!(taken > 1000 && refused > 5000, "{taken} taken and {refused} refused");
}

/// All keys that the schema has anywhere.
fn all_keys(schema: &Value, keys: &mut Vec<String>) {
    if let Some(properties) = schema.get("properties").and_then(Value::as_object) {
        keys.extend(properties.keys().cloned());
    }
    let parts = schema.as_object().map(|map| map.values().collect::<Vec<_>>());
    parts.unwrap_or_default().iter().for_each(|part| all_keys(part, keys));
}

#[test]
fn the_schema_has_the_keys_of_the_parser_and_no_others() {
    let validator = validator();
    let mut keys = vec!["nonsense".to_owned()];
    all_keys(&json_schema(), &mut keys);
    keys.sort();
    keys.dedup();
    let (mut known, mut unknown) = (0, 0);
    for scene in [complete(), with_pinhole()] {
        let objects = places_of(&scene).into_iter().chain([String::new()]);
        for place in objects.filter(|p| scene.pointer(p).is_some_and(Value::is_object)) {
            for key in &keys {
                let mut scene = scene.clone();
                let object = scene.pointer_mut(&place).and_then(Value::as_object_mut);
                let object = object.expect("an object");
                // With these a mesh is another kind of mesh.
                if object.contains_key(key) || key == "file" || key == "indices" {
                    continue;
                }
                object.insert(key.clone(), Value::Null);
                let told = parse(&scene).err().map(|error| error.to_string()).unwrap_or_default();
                if told.contains("not both") {
                    continue;
                }
                let foreign = |kind: &ValidationErrorKind| match kind {
                    ValidationErrorKind::AdditionalProperties { unexpected } => {
                        unexpected.contains(key)
                    }
                    _ => false,
                };
                let is_foreign = validator.iter_errors(&scene).any(|e| foreign(e.kind()));
                assert_eq!(is_foreign, told.contains("is not a key of"), "{place} {key}: {told}");
                *(if is_foreign { &mut unknown } else { &mut known }) += 1;
            }
        }
    }
    assert!(known > 100 && unknown > 1000, "{known} known and {unknown} unknown");
}

/// Each key says what it means: an editor shows it.
#[test]
fn every_key_is_described() {
    fn check(schema: &Value, place: &str) {
        let properties = schema.get("properties").and_then(Value::as_object);
        for (key, value) in properties.into_iter().flatten() {
            let is_condition = place.ends_with("/if");
            let described = value["description"].as_str().is_some_and(|text| text.len() > 5);
            assert!(described || is_condition, "{place}: {key} has no description");
        }
        for (key, part) in schema.as_object().into_iter().flatten() {
            check(part, &format!("{place}/{key}"));
        }
        for part in schema.as_array().into_iter().flatten() {
            check(part, place);
        }
    }
    check(&json_schema(), "");
}

#[test]
fn the_command_prints_the_schema() {
    let folder = folder();
    let output = wavecrest(folder.path()).arg("schema").output().expect("the command runs");
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]));
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(found, json_schema());
}

#[test]
fn a_scene_may_name_its_schema() {
    let mut scene = complete();
    assert!(parse(&scene).is_ok(), "strictly, and no warning");
    scene["$schema"] = json!(3);
    let told = parse(&scene).expect_err("no address").to_string();
    assert!(told.contains("$schema: must be the address of a JSON schema, found 3"), "{told}");
}
