//! The scenes of the price list: base scenes, and variants that each add one effect.
//!
//! They show a field of hills in front of a wall, all of triangles, in a view that each effect
//! changes widely. `scenes.json` lists them, each as a name, the name of the scene that it is added
//! to, and a patch of that scene. Long lists of numbers are filled in here.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;

use serde_json::{Value, json};

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::film::Film;
use wavecrest_image::write::{Transfer, write};

/// A scene of the list.
#[derive(Clone, Debug)]
pub struct SceneVariant {
    /// The effect that it adds.
    pub name: String,
    /// The index of the scene that it is added to.
    pub added_to: Option<usize>,
    /// Whether anything shows it.
    pub reached: bool,
    /// The scene, in the format of scene files.
    pub scene: Value,
}

/// The lists of `scenes.json`: bases, and effects that are reached and that are not.
type SceneLists = BTreeMap<String, Vec<(String, String, Value)>>;

/// Number of hills along each side of the field, and their height; and the number of mesh vertices
/// along each side.
const HILLS: f64 = 4.0;
const HEIGHT: f64 = 0.05;
const CORNERS: u32 = 48;

/// Texels along each side of the texture, and of its squares.
const TEXELS: u32 = 64;
const SQUARE: u32 = 8;

/// The scenes. Their texture is written to `folder`.
///
/// # Errors
/// If it cannot be written.
pub fn variants(folder: &Path) -> Result<Vec<SceneVariant>> {
    let picture = folder.join("checkers.png");
    write(&checkers()?, &picture, Transfer::Linear)?;
    let mut text = include_str!("scenes.json").replace("\"$picture\"", &json!(picture).to_string());
    for (name, numbers) in field() {
        text = text.replace(&format!("\"${name}\""), &numbers.to_string());
    }
    let lists: SceneLists = serde_json::from_str(&text)
        .map_err(|e| Error::new(ErrorKind::Io, format!("the scenes are not JSON: {e}")))?;
    let mut variants: Vec<SceneVariant> = Vec::new();
    for (list, rows) in lists {
        for (name, base, patch) in rows {
            let base = variants.iter().position(|variant| variant.name == base);
            let scene = with(base.map_or(Value::Null, |base| variants[base].scene.clone()), patch);
            let (added_to, reached) = (base.filter(|_| list != "bases"), list != "unreached");
            variants.push(SceneVariant { name, added_to, reached, scene });
        }
    }
    Ok(variants)
}

/// `value` with a patch: objects are merged, and lists of objects place by place; other values are
/// replaced, and `null` removes one. If the patch of a list is an object, it is for each of them.
fn with(value: Value, patch: Value) -> Value {
    match (value, patch) {
        (Value::Array(old), patch @ Value::Object(_)) => {
            old.into_iter().map(|one| with(one, patch.clone())).collect()
        }
        (Value::Array(mut old), Value::Array(new)) if old.iter().all(Value::is_object) => {
            old.resize(old.len().max(new.len()), json!({}));
            old.iter_mut().zip(new).for_each(|(one, patch)| *one = with(one.take(), patch));
            old.into()
        }
        (value, Value::Object(changes)) => {
            let mut value = value.as_object().cloned().unwrap_or_default();
            for (key, change) in changes {
                let old = value.remove(&key).unwrap_or_default();
                value.insert(key, with(old, change));
            }
            value.retain(|_, value| !value.is_null());
            value.into()
        }
        (_, patch) => patch,
    }
}

/// Gentle hills, seen from above: the lists of its mesh, with a colour for each point by its place.
fn field() -> [(&'static str, Value); 5] {
    let place = |i: u32| f64::from(i) / f64::from(CORNERS - 1);
    let corners = (0..CORNERS * CORNERS).map(|i| [place(i % CORNERS), place(i / CORNERS)]);
    let corners: Vec<[f64; 2]> = corners.collect();
    let each = |of: &dyn Fn(f64, f64) -> [f64; 3]| -> Value {
        corners.iter().map(|&[u, v]| json!(of(u, v))).collect()
    };
    // Sines whose sum is the height, and whose derivatives give the normal.
    let turn = HILLS * TAU;
    let height = |u, v| HEIGHT * (libm::sin(turn * u) + libm::sin(turn * v));
    let slope = |x: f64| HEIGHT * turn * libm::cos(turn * x) / 4.0;
    let squares = (0..CORNERS - 1).flat_map(|y| (0..CORNERS - 1).map(move |x| y * CORNERS + x));
    let triangles = squares.flat_map(|a| {
        let b = a + CORNERS;
        [[a, b, b + 1], [a, b + 1, a + 1]]
    });
    [
        ("points", each(&|u, v| [4.0 * u - 2.0, height(u, v), 2.0 - 4.0 * v])),
        ("normals", each(&|u, v| [-slope(u), 1.0, slope(v)])),
        ("colors", each(&|u, v| [u, v, 0.5])),
        ("uvs", json!(corners)),
        ("indices", triangles.map(|corners| json!(corners)).collect()),
    ]
}

/// Squares of two colours.
fn checkers() -> Result<Film> {
    let color = |i: u32| {
        let [x, y] = [i % TEXELS / SQUARE, i / TEXELS / SQUARE];
        if (x + y).is_multiple_of(2) { [0.9, 0.8, 0.6] } else { [0.3, 0.2, 0.1] }
    };
    let mut film = Film::new(TEXELS, TEXELS)?;
    (0_u32..).zip(film.pixels_mut()).for_each(|(i, pixel)| *pixel = color(i));
    Ok(film)
}
