//! The JSON Schema of scene files says what the parser does.

use serde_json::{Value, json};
use wavecrest_base::error::Error;
use wavecrest_scene::json_schema;
use wavecrest_scene::load::{LoadOptions, load_str};

use crate::support::{edited, files_in, folder, repository, run_json, scene_files};

/// Whether `value` is valid by `schema`, a part of `whole`, in the keywords of draft 2020-12 that it uses; any others fail the
/// test.
fn is_valid(whole: &Value, schema: &Value, value: &Value) -> bool {
    let valid = |schema: &Value, value: &Value| is_valid(whole, schema, value);
    let Value::Object(keywords) = schema else { return schema == &json!(true) };
    keywords.iter().all(|(keyword, of)| {
        let bound = of.as_f64().unwrap_or_default();
        let schemas = || of.as_array().into_iter().flatten();
        let is_number = |is_within: &dyn Fn(f64) -> bool| value.as_f64().is_none_or(is_within);
        let has_length = |is_right: &dyn Fn(f64) -> bool| {
            value.as_array().is_none_or(|items| is_right(items.len() as f64))
        };
        let required = || schemas().all(|key| value.get(key.as_str().expect("a key")).is_some());
        match keyword.as_str() {
            "$schema" | "title" | "description" | "default" | "$defs" => true,
            "$ref" => {
                let place = of.as_str().and_then(|place| place.strip_prefix('#'));
                valid(whole.pointer(place.expect("a place")).expect("a schema"), value)
            }
            "type" => match of.as_str().expect("a type") {
                "object" => value.is_object(),
                "array" => value.is_array(),
                "string" => value.is_string(),
                "boolean" => value.is_boolean(),
                "number" => value.is_number(),
                "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
                other => panic!("{other} is no type here"),
            },
            "const" => value == of,
            "enum" => schemas().any(|one| one == value),
            "minimum" => is_number(&|number| number >= bound),
            "exclusiveMinimum" => is_number(&|number| number > bound),
            "maximum" => is_number(&|number| number <= bound),
            "minLength" => value.as_str().is_none_or(|text| text.chars().count() as f64 >= bound),
            "minItems" => has_length(&|length| length >= bound),
            "maxItems" => has_length(&|length| length <= bound),
            "items" => {
                let before = schema["prefixItems"].as_array().map_or(0, Vec::len);
                let items = value.as_array().into_iter().flatten();
                items.skip(before).all(|item| valid(of, item))
            }
            "prefixItems" => {
                let items = value.as_array().into_iter().flatten();
                schemas().zip(items).all(|(schema, item)| valid(schema, item))
            }
            "required" => !value.is_object() || required(),
            "properties" => of
                .as_object()
                .into_iter()
                .flatten()
                .all(|(key, schema)| value.get(key).is_none_or(|member| valid(schema, member))),
            "additionalProperties" => {
                value.as_object().into_iter().flatten().all(|(key, member)| {
                    schema["properties"].get(key).is_some() || valid(of, member)
                })
            }
            "allOf" => schemas().all(|schema| valid(schema, value)),
            "oneOf" => schemas().filter(|schema| valid(schema, value)).count() == 1,
            "not" => !valid(of, value),
            "if" => {
                let branch = if valid(of, value) { "then" } else { "else" };
                schema.get(branch).is_none_or(|schema| valid(schema, value))
            }
            "then" | "else" => true,
            other => panic!("{other} is no keyword here"),
        }
    })
}

/// Whether a scene is valid by the schema.
fn is_scene(schema: &Value, scene: &Value) -> bool {
    is_valid(schema, schema, scene)
}

/// Loads a scene whose files are beside it, strictly.
fn parse(scene: &Value) -> Result<(), Error> {
    let options = LoadOptions { strict: true, ..LoadOptions::default() };
    load_str(&scene.to_string(), &repository("tests/fuzz/files/s.json"), &options).map(|_| ())
}

/// A scene with each kind of everything, and every key of each.
pub(crate) fn complete() -> Value {
    serde_json::from_str(include_str!("schema/complete.json")).expect("JSON")
}

/// The complete scene with a pinhole camera.
fn with_pinhole() -> Value {
    let sky = json!({"sky": [0.2, 0.3, 0.4], "ground": [0.1, 0, 0], "up": [0, 0, 1]});
    let camera = json!({"type": "pinhole", "width": 64, "height": 48, "fov": 60,
                        "position": [0, 0, 5], "lookat": [0, 0, 0], "sampling": "sobol",
                        "path": {"keys": [{"frame": 3, "location": [0, 0, 7]}]}});
    edited(complete(), &format!("/scene/ambient {sky}\n/camera {camera}"))
}

/// The places of the values below `value`, as JSON pointers.
pub(crate) fn places(value: &Value, at: &str, all: &mut Vec<String>) {
    let mut below = |key: &str, value: &Value| {
        let place = format!("{at}/{key}");
        all.push(place.clone());
        places(value, &place, all);
    };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| below(key, value)),
        Value::Array(items) => {
            // The three numbers of a point or a colour are read alike: the first stands for all.
            let is_point = items.len() == 3 && items.iter().all(Value::is_number);
            let items = items.iter().take(if is_point { 1 } else { items.len() });
            items.enumerate().for_each(|(i, value)| below(&i.to_string(), value));
        }
        _ => {}
    }
}

/// Two scenes, and the places in which they differ from those before.
fn scenes() -> [(Value, Vec<String>); 2] {
    [(complete(), vec![""]), (with_pinhole(), vec!["/camera", "/scene/ambient"])].map(
        |(scene, roots)| {
            let mut all = Vec::new();
            for root in roots {
                all.push(root.to_owned());
                places(scene.pointer(root).expect("a value"), root, &mut all);
            }
            (scene, all)
        },
    )
}

/// What may stand where something else did: other types, and numbers on both sides of every bound.
fn replacements() -> Vec<Value> {
    serde_json::from_str(include_str!("schema/replacements.json")).expect("JSON")
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
fn every_scene_of_the_repository_is_valid() {
    let schema = json_schema();
    let large = files_in("scenes/large", "json");
    for path in scene_files().into_iter().map(|(_, path)| path).chain(large) {
        let text = std::fs::read_to_string(&path).expect("a scene");
        let scene: Value = serde_json::from_str(&text).expect("JSON");
        assert!(is_scene(&schema, &scene), "{}", path.display());
    }
}

/// What the parser takes the schema takes, and what the parser refuses for its own sake the schema refuses: other values,
/// a key that is missing, and one that there is not.
#[test]
fn the_schema_and_the_parser_agree_on_every_changed_value() {
    let schema = json_schema();
    let (mut taken, mut refused) = (0, 0);
    for (scene, places) in scenes() {
        assert!(parse(&scene).is_ok() && is_scene(&schema, &scene));
        for place in places.into_iter().filter(|place| !place.is_empty()) {
            let changes = replacements().into_iter().map(|value| format!("{place} {value}"));
            let is_object = scene.pointer(&place).is_some_and(Value::is_object);
            let unknown = is_object.then(|| format!("{place}/nonsense null"));
            for change in changes.chain([place.clone()]).chain(unknown) {
                let changed = edited(scene.clone(), &change);
                let is_valid = is_scene(&schema, &changed);
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
    assert_eq!(run_json(folder.path(), &["schema"]), json_schema());
}
