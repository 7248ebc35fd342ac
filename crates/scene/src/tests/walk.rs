//! Every value of the complete scene, deleted and replaced in turn.

use serde_json::{Value, json};

use super::{complete, error, load, pointer, set, strictly, without};

#[test]
fn the_complete_scene_is_without_fault() {
    assert_eq!(strictly(&complete()).unwrap().warnings, []);
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

#[test]
fn each_required_key_is_missed_by_its_path() {
    let required = [
        "nbounces",
        "camera",
        "scene",
        "scene.backgroundcolor",
        "camera.type",
        "camera.width",
        "camera.height",
        "camera.fov",
        "camera.location",
        "camera.look",
        "camera.aperture",
        "camera.focal",
        "scene.lightsources[0].type",
        "scene.lightsources[0].intensity",
        "scene.lightsources[0].position",
        "scene.lightsources[0].color",
        "scene.lightsources[1].type",
        "scene.lightsources[1].intensity",
        "scene.lightsources[1].color",
        "scene.lightsources[1].shape",
        "scene.lightsources[1].shape.type",
        "scene.lightsources[1].shape.points",
        "scene.shapes[0].type",
        "scene.shapes[0].center",
        "scene.shapes[0].radius",
        "scene.shapes[0].material",
        "scene.shapes[0].material.ks",
        "scene.shapes[0].material.kd",
        "scene.shapes[0].material.specularexponent",
        "scene.shapes[0].material.diffusecolor",
        "scene.shapes[1].points",
        "scene.shapes[2].points",
        "scene.shapes[3].points",
        "scene.shapes[4].points",
    ];
    for path in required {
        let error = error(&without(path));
        assert_eq!(error.place(), Some(path));
        assert!(error.to_string().contains(": is missing; "), "{error}");
    }
}

#[test]
fn every_other_key_is_optional() {
    let optional = [
        "scene.shapes",
        "scene.ambient",
        "camera.fovaxis",
        "camera.up",
        "camera.antialias",
        "camera.sampling",
        "camera.nsamplesx",
        "camera.nsamplesy",
        "scene.lightsources[0].falloff",
        "scene.lightsources[1].position",
        "scene.lightsources[1].falloff",
        "scene.lightsources[1].shape.normal",
        "scene.shapes[0].name",
        "scene.shapes[0].material.kr",
        "scene.shapes[0].filter",
        "scene.shapes[0].wrap",
        "scene.shapes[0].sides",
        "scene.shapes[0].shading",
        "scene.shapes[0].transform",
        "scene.shapes[0].transform.translate",
        "scene.shapes[0].transform.rotate",
        "scene.shapes[0].transform.scale",
        "scene.shapes[1].normal",
        "scene.shapes[2].normal",
        "scene.shapes[2].transform",
        "scene.shapes[3].size",
        "scene.shapes[3].normal",
        "scene.shapes[3].uvs",
        "scene.shapes[4].indices",
    ];
    for path in optional {
        assert_eq!(load(&without(path)).unwrap().warnings, [], "{path}");
    }
    // Without lights a scene is read, but black.
    let dark = load(&without("scene.lightsources")).unwrap().warnings;
    assert!(
        matches!(&dark[..], [only] if only.to_string().contains("there is no light")),
        "{dark:?}"
    );
}

/// Where more than one type of value is right.
fn takes_several_types(path: &str) -> bool {
    path.ends_with(".transform") || path.ends_with(".normal") || path.ends_with(".scale")
}

/// Whether a message at `place` tells the reader of `path` where to look: it is the value's own
/// path, or that of the list or object that it is in or that it holds.
fn names(place: &str, path: &str) -> bool {
    let inside = |inner: &str, outer: &str| {
        inner
            .strip_prefix(outer)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    };
    inside(place, path) || inside(path, place) && !place.is_empty() && place != "scene"
}

#[test]
fn each_value_of_a_wrong_type_is_refused_by_its_path() {
    let scene = complete();
    for path in all_paths() {
        let own = scene.pointer(&pointer(&path)).unwrap();
        for wrong in [json!("text"), json!(0.5), json!(true), json!(null), json!([]), json!({})] {
            if std::mem::discriminant(own) == std::mem::discriminant(&wrong) {
                continue;
            }
            let Err(error) = load(&set(scene.clone(), &path, wrong.clone())) else {
                assert!(takes_several_types(&path), "{path} = {wrong} is accepted");
                continue;
            };
            let place = error.place().unwrap_or_default();
            assert!(names(place, &path), "{path} = {wrong}: {error}");
            assert!(error.to_string().starts_with("s.json: "), "{error}");
        }
    }
}

#[test]
fn each_value_of_an_odd_size_never_panics() {
    let scene = complete();
    let odd = [
        json!(-1),
        json!(0),
        json!(1e300),
        json!(-1e300),
        json!(5e-324),
        json!(1e18),
        json!([[]]),
        json!([0, 0, 0]),
        json!([1e300, 0, 0]),
        json!([0, 1]),
        json!([[0, 0, 0]]),
        json!({"type": {}}),
        json!(""),
        json!("\u{0}\u{7f}ß"),
        json!(vec![json!([0, 0, 0]); 4]),
    ];
    for path in all_paths() {
        for value in &odd {
            let _ = load(&set(scene.clone(), &path, value.clone()));
        }
    }
}

#[test]
fn each_key_with_a_letter_too_many_is_matched() {
    for path in all_paths().iter().filter(|path| !path.ends_with(']')) {
        let mut scene = without(path);
        let own = complete().pointer(&pointer(path)).unwrap().clone();
        let misspelt = format!("{path}e");
        scene = set(scene, &misspelt, own);
        let error = strictly(&scene).err().unwrap().to_string();
        let key = path.rsplit('.').next().unwrap();
        let found = error.contains(&format!("did you mean {key:?}?"))
            || error.contains(&format!("rename \"{key}e\" to {key:?}"));
        assert!(found, "{error}");
    }
}
