//! What each change of the complete scene makes of it, beside this file as text: changes, one a line, and below them
//! what follows, the errors and warnings word for word and the components that are others. Where nothing follows the
//! change is accepted and of no effect.
//!
//! `WAVECREST_BLESS=1 cargo test -p wavecrest-scene --lib changes` writes what follows again.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::fs;
use std::path::Path;

use super::{all_paths, complete, load_options, remove, set};
use crate::components::*;
use crate::load::{LoadOptions, LoadedScene};

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
        part::<Pinhole>,
        part::<ThinLens>,
        part::<Order>,
        part::<PointLight>,
        part::<AreaLight>,
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

/// What follows from changes: a line each, indented.
fn consequences(changes: &str, before: &Parts) -> String {
    let (mut scene, mut options) = (complete(), LoadOptions::default());
    for change in changes.lines() {
        match (change.split_once("= "), change.strip_prefix("- ")) {
            (Some(("", value)), _) => scene = value.parse().unwrap(),
            (Some((path, value)), _) => scene = set(scene, path.trim(), value.parse().unwrap()),
            (_, Some(path)) => scene = remove(scene, path),
            _ => options.strict = change == "strict",
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

/// Compares with the file of this name, whose paragraphs begin with headings and changes.
fn compare(name: &str, paragraphs: impl Iterator<Item = String>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/tests").join(name);
    let before = parts(&load_options(&complete(), LoadOptions::default()).unwrap());
    let (mut heading, mut all) = (String::new(), String::new());
    let blessing = std::env::var_os("WAVECREST_BLESS").is_some_and(|value| value == "1");
    let approved = fs::read_to_string(&path).unwrap();
    for changes in paragraphs {
        let mut paragraph = format!("{changes}\n");
        if changes.starts_with('#') {
            heading = changes;
        } else {
            let nothing = Parts::new();
            let before = if changes == "as it is" { &nothing } else { &before };
            let found = consequences(&changes, before);
            found.lines().for_each(|line| paragraph += &format!("    {line}\n"));
        }
        let known = approved.split("\n\n").any(|known| known.trim_end() == paragraph.trim_end());
        assert!(blessing || known, "{heading}\nnow, and not in {name}:\n{paragraph}");
        all += &format!("{paragraph}\n");
    }
    let all = all.trim_end().to_owned() + "\n";
    if blessing {
        fs::write(path, &all).unwrap();
    }
    assert!(blessing || approved == all, "{name} has paragraphs twice or of no use");
}

#[test]
fn what_follows_from_each_change() {
    let changes = |paragraph: &str| {
        let lines = paragraph.lines().filter(|line| !line.starts_with("    "));
        lines.collect::<Vec<_>>().join("\n")
    };
    compare("changes.txt", include_str!("changes.txt").split("\n\n").map(changes));
}

/// Which keys are required, and what the others are where the file does not say.
#[test]
fn what_follows_from_each_key_left_out() {
    let keys = all_paths().into_iter().filter(|path| !path.ends_with(']'));
    compare("left_out.txt", keys.map(|path| format!("- {path}")));
}
