//! The scene format as a JSON Schema (draft 2020-12), for editors that check and complete a scene while it is
//! written.
//!
//! Keys, ranges and words are those that the parser itself goes by. So a key that the parser learns is in the
//! schema at once, and a test fails until [`objects`], [`cameras`] or [`shapes`] says what it means. What depends on
//! other values, such as a number of points, is left to `wavecrest check`.

mod cameras;
mod objects;
mod shapes;

use serde_json::{Map, Value, json};

use crate::reader::Range;

/// The dialect that the schema is written in.
const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Where a definition of this schema stands.
const DEFINITIONS: &str = "#/$defs/";

/// The schema of a scene file.
///
/// A scene that is loaded strictly, without an unknown key, is valid by it.
///
/// ```
/// let schema = wavecrest_scene::json_schema();
/// assert_eq!(schema["properties"]["nbounces"]["maximum"], 10_000);
/// ```
pub fn json_schema() -> Value {
    let mut schema = objects::scene_file();
    schema["$schema"] = DIALECT.into();
    schema["title"] = "wavecrest scene".into();
    schema["$defs"] = objects::definitions().into_iter().collect();
    schema
}

/// What one key of an object takes; `None` for a key that nobody has described.
type Describe = fn(&str) -> Option<Value>;

/// An object with exactly these keys.
fn object(
    about: &str,
    keys: &[&'static str],
    required: &[&str],
    describe: impl Fn(&str) -> Option<Value>,
) -> Value {
    let value = |key: &&'static str| describe(key).unwrap_or(Value::Bool(true));
    let properties: Map<_, _> = keys.iter().map(|key| ((*key).to_owned(), value(key))).collect();
    json!({
        "description": about, "type": "object", "properties": properties,
        "required": required, "additionalProperties": false
    })
}

/// An object whose `type` says which definition it follows.
fn by_type(about: &str, kinds: &[(&'static str, &str)]) -> Value {
    let words: Vec<&str> = kinds.iter().map(|(word, _)| *word).collect();
    let choice = |(word, definition): &(&str, &str)| json!({"if": has_type(word), "then": definition_of(definition)});
    json!({
        "description": about, "type": "object", "required": ["type"],
        "properties": {"type": {"description": "Which kind this is.", "enum": words}},
        "allOf": kinds.iter().map(choice).collect::<Vec<_>>()
    })
}

fn has_type(word: &str) -> Value {
    json!({"required": ["type"], "properties": {"type": {"const": word}}})
}

/// The value with words that say what it means.
fn about(mut value: Value, text: &str) -> Value {
    value["description"] = text.into();
    value
}

/// The value with what holds where the key is absent.
fn or(mut value: Value, default: impl Into<Value>) -> Value {
    value["default"] = default.into();
    value
}

fn definition_of(name: &str) -> Value {
    json!({"$ref": format!("{DEFINITIONS}{name}")})
}

fn number(range: Range) -> Value {
    let (low, high, open) = range.bounds();
    let least = if open { "exclusiveMinimum" } else { "minimum" };
    json!({"type": "number", least: plain(low), "maximum": plain(high)})
}

/// A whole number without a point.
fn plain(x: f64) -> Value {
    // No bound of the format is beyond 2^53.
    if x.fract() == 0.0 { json!(x as i64) } else { json!(x) }
}

fn integer(low: u32, high: u32) -> Value {
    json!({"type": "integer", "minimum": low, "maximum": high})
}

/// An array of exactly `count` of `item`.
fn tuple(count: usize, item: Value) -> Value {
    json!({"type": "array", "items": item, "minItems": count, "maxItems": count})
}

/// An array of at least `count` of `item`.
fn list(count: usize, item: Value) -> Value {
    json!({"type": "array", "items": item, "minItems": count})
}

fn text() -> Value {
    json!({"type": "string", "minLength": 1})
}

/// One of the words of a table.
fn word<T>(options: &[(&'static str, T)]) -> Value {
    json!({"enum": options.iter().map(|(word, _)| *word).collect::<Vec<_>>()})
}

/// One of the words of a table; absent, the one that means `default`.
fn word_or<T: PartialEq>(options: &[(&'static str, T)], default: T) -> Value {
    let usual = options.iter().find(|(_, meaning)| *meaning == default);
    or(word(options), usual.map(|(word, _)| *word))
}

/// Exactly one of the keys, which mean the same.
fn one_of(keys: &[&str]) -> Value {
    json!({"oneOf": keys.iter().map(|key| json!({"required": [key]})).collect::<Vec<_>>()})
}

/// `value`, and all of `conditions` besides.
fn where_all(mut value: Value, conditions: Vec<Value>) -> Value {
    value["allOf"] = conditions.into();
    value
}
