//! What each change of the complete scene makes of it, beside this file as text: changes, one a line, and below them
//! what follows, the errors and warnings word for word and the components that are others. Where nothing follows the
//! change is accepted and of no effect.

use std::collections::BTreeMap;
use std::fmt::Debug;

use super::{all_paths, complete, load, load_options, remove, set};
use crate::approved;
use wavecrest_scene::components::*;
use wavecrest_scene::load::{LoadOptions, LoadedScene};

/// A component by the place of its entity and by its name.
type Parts = BTreeMap<(String, &'static str), String>;

fn part<C: hecs::Component + Debug>(scene: &LoadedScene, parts: &mut Parts) {
    let name = std::any::type_name::<C>().rsplit("::").next().unwrap();
    for (path, component) in scene.world.query::<(Option<&JsonPath>, &C)>().iter() {
        let path = path.map_or("scene", |path| &path.0).to_owned();
        let text = format!("{component:?}");
        let text = text.strip_prefix(name).map_or(format!(": {text}"), str::to_owned);
        assert_eq!(parts.insert((path, name), text), None, "two of one entity");
    }
}

fn parts(scene: &LoadedScene) -> Parts {
    let mut parts = Parts::new();
    for part in [
        part::<Settings>,
        part::<View>,
        part::<ThinLens>,
        part::<Order>,
        part::<PointLight>,
        part::<AreaLight>,
        part::<Sky>,
        part::<Sphere>,
        part::<Quad>,
        part::<Triangle>,
        part::<Mesh>,
        part::<Facing>,
        part::<Name>,
        part::<Transform>,
        part::<Sides>,
        part::<Shading>,
        part::<Material>,
        part::<TextureRef>,
    ] {
        part(scene, &mut parts);
    }
    parts
}

/// What follows from changes: a line each.
fn consequences(changes: &str, before: &Parts) -> String {
    let (mut scene, mut options) = (complete(), LoadOptions::default());
    for change in changes.lines() {
        match (change.split_once("= "), change.strip_prefix("- ")) {
            (Some(("", value)), _) => scene = value.parse().unwrap(),
            (Some((path, value)), _) => scene = set(scene, path.trim(), value.parse().unwrap()),
            (_, Some(path)) => scene = remove(scene, path),
            _ => match change.split_once(' ') {
                Some(("width", side)) => options.width = side.parse().ok(),
                Some((_, side)) => options.height = side.parse().ok(),
                None => options.strict = change == "strict",
            },
        }
    }
    let short = |text: String| text.replace("s.json: ", "");
    let loaded = match load_options(&scene, options) {
        Err(error) => return short(format!("{:?} error: {error}", error.kind())),
        Ok(loaded) => loaded,
    };
    let after = parts(&loaded);
    let warnings = loaded.warnings.iter().map(|warning| short(format!("warning: {warning}")));
    let gone = before.keys().filter(|key| !after.contains_key(key));
    let gone = gone.map(|(path, name)| format!("{path} has no {name}"));
    let others = after.iter().filter(|(key, text)| before.get(key) != Some(text));
    let others = others.map(|((path, name), text)| format!("{path} {name}{text}"));
    warnings.chain(gone).chain(others).collect::<Vec<_>>().join("\n")
}

#[test]
fn what_follows_from_each_change() {
    let (nothing, complete) = (Parts::new(), parts(&load(&complete()).unwrap()));
    approved::compare("tests/integration/scene/changes.txt", |changes| {
        consequences(changes, if changes == "as it is" { &nothing } else { &complete })
    });
}

/// Which keys are required, and what the others are where the file does not say.
#[test]
fn what_follows_from_each_key_left_out() {
    let before = parts(&load(&complete()).unwrap());
    let keys = all_paths().into_iter().filter(|path| !path.ends_with(']'));
    let tried = approved::compare("tests/integration/scene/left_out.txt", |changes| {
        consequences(changes, &before)
    });
    assert_eq!(tried, keys.map(|path| format!("- {path}")).collect::<Vec<_>>());
}
