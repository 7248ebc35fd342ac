//! Every value of the complete scene, replaced in turn.

use serde_json::json;

use super::{all_paths, complete, load, load_options, pointer, remove, set};
use wavecrest_scene::load::LoadOptions;

/// Where more than one type of value is right.
fn takes_several_types(path: &str) -> bool {
    [".transform", ".normal", ".scale", ".ambient"].iter().any(|key| path.ends_with(key))
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
fn each_key_with_a_letter_too_many_is_matched() {
    for path in all_paths().iter().filter(|path| !path.ends_with(']')) {
        let own = complete().pointer(&pointer(path)).unwrap().clone();
        let misspelt = format!("{path}e");
        let scene = set(remove(complete(), path), &misspelt, own);
        let strict = LoadOptions { strict: true, ..LoadOptions::default() };
        let error = load_options(&scene, strict).err().unwrap().to_string();
        let key = path.rsplit('.').next().unwrap();
        let found = error.contains(&format!("did you mean {key:?}?"))
            || error.contains(&format!("rename \"{key}e\" to {key:?}"));
        assert!(found, "{error}");
    }
}
