//! The scene format as a JSON Schema (draft 2020-12), for editors that check and complete scenes.
//!
//! It is generated from the parser's tables: keys, ranges, words and descriptions. Checks that
//! depend on other values, such as a number of points, are left to `wavecrest check`.

use serde_json::{Map, Value, json};

use super::camera::{self, CameraKind};
use super::light::{self, LightKind};
use super::shape::{self, Owner, ShapeKind};
use super::{FILE, SCENE, instance, maps, material, mesh, transform};
use crate::reader::{Absent, Key, Kind, Range, Takes};
use wavecrest_base::choice::Choice;

/// The dialect of the schema.
const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// The place of definitions in the schema.
const DEFINITIONS: &str = "#/$defs/";

/// The schema of a scene file.
///
/// Every scene that loads with `strict` is valid by it.
///
/// ```
/// let schema = wavecrest_scene::json_schema();
/// assert_eq!(schema["properties"]["nbounces"]["maximum"], 10_000);
/// ```
pub fn json_schema() -> Value {
    let mut schema = object(&FILE);
    schema["$schema"] = DIALECT.into();
    schema["title"] = "wavecrest scene".into();
    schema["$defs"] = definitions();
    schema
}

/// The definitions, by name.
fn definitions() -> Value {
    let mut all = json!({
        "number": takes(Takes::Number(Range::COORDINATE)),
        "point": about(tuple(3, definition("number")), "A point or a direction, [x, y, z]."),
        "color": about(tuple(3, takes(Takes::Number(Range::NOT_NEGATIVE))), "A linear colour, [r, g, b]."),
        "ambient": {
            "description": "A share of the diffuse colour, or light from a sky and from the ground.",
            "if": {"type": "object"}, "then": definition("hemisphere"),
            "else": takes(Takes::Number(Range::NOT_NEGATIVE))
        },
        "hemisphere": object(&super::HEMISPHERE),
        "scene": object(&SCENE),
        "instance": object(&instance::INSTANCE),
        "camera": by_type::<CameraKind>("The camera and the size of the image.", ""),
        "pinhole": object(&camera::PINHOLE),
        "thinlens": object(&camera::THIN_LENS),
        "light": by_type::<LightKind>("A light.", ""),
        "pointlight": object(&light::POINT_LIGHT),
        "spotlight": object(&light::SPOT_LIGHT),
        "directionallight": object(&light::DIRECTIONAL_LIGHT),
        "arealight": object(&light::AREA_LIGHT),
        "material": object(&material::MATERIAL),
        "colormap": object(&maps::COLOR_MAP),
        "strengthmap": object(&maps::STRENGTH_MAP),
        "metalmap": object(&maps::METAL_MAP),
        "uvtransform": about(
            tuple(2, tuple(3, definition("number"))),
            "Two rows that act on texture coordinates [u, v, 1].",
        ),
        "transform": {
            "description": "From a shape's own space to the world's.",
            "if": {"type": "array"}, "then": definition("matrix"), "else": definition("transformParts")
        },
        "transformParts": object(&transform::PARTS),
        "matrix": matrix(),
        "pinholePath": object(&camera::PINHOLE_PATH),
        "cameraPath": object(&camera::LENS_PATH),
    });
    for (prefix, owner) in [("", Owner::Scene), ("lit-", Owner::Light)] {
        add_shapes(&mut all, prefix, owner);
    }
    all
}

/// Adds a shape, and each kind of shape, with names that begin with `prefix`.
fn add_shapes(all: &mut Value, prefix: &str, owner: Owner) {
    let mut add = |name: &str, value: Value| all[format!("{prefix}{name}")] = value;
    let kind = |own| object(&shape::kind(own, owner));
    add("shape", by_type::<ShapeKind>("A shape.", prefix));
    add("sphere", kind(&shape::SPHERE));
    add("plane", kind(&shape::PLANE));
    add("triangle", kind(&shape::TRIANGLE));
    add("trimesh", any_mesh(prefix));
    add("meshFile", kind(&mesh::MESH_FILE));
    add("meshIndexed", kind(&mesh::INDEXED));
    add("meshStrip", kind(&mesh::STRIP));
}

/// The keys decide the kind of mesh.
fn any_mesh(prefix: &str) -> Value {
    let to = |kind: &str| definition(&format!("{prefix}{kind}"));
    json!({
        "description": "A mesh of triangles: from a file, with indices, or a strip.",
        "if": {"required": ["file"]}, "then": to("meshFile"),
        "else": {"if": {"required": ["indices"]}, "then": to("meshIndexed"), "else": to("meshStrip")}
    })
}

fn matrix() -> Value {
    let row = || tuple(4, definition("number"));
    json!({
        "description": "Four rows; it acts on columns, so that the last column is the translation.",
        "type": "array", "prefixItems": [row(), row(), row(), {"const": [0, 0, 0, 1]}],
        "minItems": 4, "maxItems": 4
    })
}

/// An object whose `type` selects its definition, by the word after `prefix`.
fn by_type<T: Choice>(about: &str, prefix: &str) -> Value {
    let words = || T::VALUES.iter().map(|value| value.name());
    let choice = |word: &str| {
        json!({
            "if": {"required": ["type"], "properties": {"type": {"const": word}}},
            "then": definition(&format!("{prefix}{word}"))
        })
    };
    json!({
        "description": about, "type": "object", "required": ["type"],
        "properties": {"type": {"description": "Which kind this is.", "enum": words().collect::<Vec<_>>()}},
        "allOf": words().map(choice).collect::<Vec<_>>()
    })
}

/// An object of a kind.
fn object(kind: &Kind) -> Value {
    let properties: Map<_, _> =
        kind.all_keys().map(|key| (key.name.to_owned(), property(key))).collect();
    let required = kind.all_keys().filter(|key| key.absent == Absent::Required);
    let mut value = json!({
        "description": kind.about, "type": "object",
        "required": required.map(|key| key.name).collect::<Vec<_>>(), "additionalProperties": false
    });
    // Exactly one of the synonymous keys.
    let one_of = |keys: &&[&str]| {
        let each = keys.iter().map(|key| json!({"required": [key]}));
        json!({"oneOf": each.collect::<Vec<_>>()})
    };
    let mut conditions: Vec<Value> = kind.one_of.iter().map(one_of).collect();
    if properties.contains_key("id") {
        // No item has two names.
        conditions.push(json!({"not": {"required": ["name", "id"]}}));
    }
    if !conditions.is_empty() {
        value["allOf"] = conditions.into();
    }
    value["properties"] = properties.into();
    value
}

fn property(key: &Key) -> Value {
    let mut value = takes(key.takes);
    match key.absent {
        Absent::Required | Absent::Open => {}
        Absent::Off => value["default"] = false.into(),
        Absent::Is(x) => value["default"] = plain(x),
        Absent::Are(v) => value["default"] = v.map(plain).to_vec().into(),
        Absent::Says(word) => value["default"] = word.into(),
    }
    about(value, key.about)
}

fn takes(takes: Takes) -> Value {
    match takes {
        Takes::Anything => json!({}),
        Takes::Text => json!({"type": "string", "minLength": 1}),
        Takes::Truth => json!({"type": "boolean"}),
        Takes::Number(range) => number(range),
        Takes::Integer(low, high) => json!({"type": "integer", "minimum": low, "maximum": high}),
        Takes::OneOf(numbers) => json!({"enum": numbers}),
        Takes::Point => definition("point"),
        Takes::Color => definition("color"),
        Takes::NumberOrPoint => json!({"anyOf": [definition("number"), definition("point")]}),
        Takes::PointOr(numbers) => {
            json!({"if": {"type": "array"}, "then": definition("point"), "else": {"enum": numbers}})
        }
        Takes::Choice(words) => json!({"enum": words()}),
        Takes::Definition(name) => definition(name),
        Takes::Nested(kind) => object(kind),
        Takes::AtLeast(count, item) => {
            json!({"type": "array", "items": self::takes(*item), "minItems": count})
        }
        Takes::Exactly(count, item) => tuple(count, self::takes(*item)),
    }
}

/// The value with a description.
fn about(mut value: Value, text: &str) -> Value {
    value["description"] = text.into();
    value
}

fn definition(name: &str) -> Value {
    json!({"$ref": format!("{DEFINITIONS}{name}")})
}

fn number(range: Range) -> Value {
    let (low, high, open) = range.bounds();
    let least = if open { "exclusiveMinimum" } else { "minimum" };
    json!({"type": "number", least: plain(low), "maximum": plain(high)})
}

/// An integer without a decimal point.
fn plain(x: f64) -> Value {
    // No bound of the format is beyond 2^53.
    if x.fract() == 0.0 { json!(x as i64) } else { json!(x) }
}

/// An array of exactly `count` of `item`.
fn tuple(count: usize, item: Value) -> Value {
    json!({"type": "array", "items": item, "minItems": count, "maxItems": count})
}
