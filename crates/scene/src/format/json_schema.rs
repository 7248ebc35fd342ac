//! The scene format as a JSON Schema (draft 2020-12), for editors that check and complete scenes.
//!
//! It is generated from the tables that the reader uses: keys, ranges, words and descriptions.
//! Checks that depend on other values, such as a number of points, are left to `wavecrest check`.

use serde_json::{Map, Value, json};

use super::keys::plain;
use super::{Absent, Key, Kind, Range, Takes, Variants};

/// The dialect of the schema.
const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// The place of definitions in the schema.
const DEFINITIONS: &str = "#/$defs/";

/// The schema of files that are objects of a kind.
pub(crate) fn json_schema(file: &Kind) -> Value {
    let mut definitions = Definitions(Map::new());
    definitions.add("number", number(Range::COORDINATE));
    let point = tuple(3, reference("number"));
    definitions.add("point", about(point, "A point or a direction, [x, y, z]."));
    let color = tuple(3, number(Range::NOT_NEGATIVE));
    definitions.add("color", about(color, "A linear colour, [r, g, b]."));
    definitions.add("matrix", matrix());
    let mut schema = definitions.object(file);
    schema["$schema"] = DIALECT.into();
    schema["title"] = "wavecrest scene".into();
    schema["$defs"] = definitions.0.into();
    schema
}

/// The definitions of a schema, by name.
struct Definitions(Map<String, Value>);

impl Definitions {
    /// Adds a definition unless there is one like it; returns a reference to it. Of several with one
    /// `name`, the later are numbered.
    fn add(&mut self, name: &str, value: Value) -> Value {
        let numbered = (2_u32..).map(|number| format!("{name}-{number}"));
        let mut names = std::iter::once(name.to_owned()).chain(numbered);
        let free = names.find(|name| self.0.get(name).is_none_or(|known| *known == value));
        let name = free.unwrap_or_default();
        self.0.insert(name.clone(), value);
        reference(&name)
    }

    /// A reference to the definition of a kind of object: "spot-light" for a spot light.
    fn kind(&mut self, kind: &Kind) -> Value {
        let name = kind.name.split(" (").next().unwrap_or_default();
        let (_, name) = name.split_once(' ').unwrap_or_default();
        let lit = if kind.unread.is_empty() { "" } else { "lit-" };
        let value = self.object(kind);
        self.add(&format!("{lit}{}", name.replace(' ', "-")), value)
    }

    /// An object of one of a few kinds.
    fn variants(&mut self, variants: &Variants) -> Value {
        let words: Vec<&str> = variants.words().iter().map(|(word, _)| *word).collect();
        let all: Vec<Value> = words
            .iter()
            .map(|word| {
                let kinds = variants.kinds.iter().filter(|kind| kind.word == *word);
                // The presence of a key tells each of them but the last.
                let then = kinds.rev().fold(Value::Null, |other, kind| match other {
                    Value::Null => self.kind(kind),
                    other => json!({
                        "if": {"required": [kind.discriminator]},
                        "then": self.kind(kind), "else": other
                    }),
                });
                json!({
                    "if": {"required": ["type"], "properties": {"type": {"const": word}}},
                    "then": then
                })
            })
            .collect();
        let types = json!({"description": "Which kind this is.", "enum": words});
        json!({
            "description": variants.about, "type": "object", "required": ["type"],
            "properties": {"type": types}, "allOf": all
        })
    }

    fn object(&mut self, kind: &Kind) -> Value {
        let (mut properties, mut conditions) = (Map::new(), Vec::new());
        for key in kind.all_keys() {
            // A lens has a key of its view too.
            if properties.contains_key(key.name) {
                continue;
            }
            let mut value = self.property(&key);
            if key.name == "type" {
                value["const"] = kind.word.into();
            }
            properties.insert(key.name.to_owned(), value.clone());
            for synonym in key.synonyms {
                let text = format!("Synonym of {}.", key.name);
                properties.insert((*synonym).to_owned(), about(value.clone(), &text));
            }
            if !key.synonyms.is_empty() {
                let each = key.names().map(|name| json!({"required": [name]}));
                conditions.push(match key.absent {
                    Absent::Required => json!({"oneOf": each.collect::<Vec<_>>()}),
                    _ => json!({"not": {"required": key.names().collect::<Vec<_>>()}}),
                });
            }
        }
        let is_required = |key: &Key| key.absent == Absent::Required && key.synonyms.is_empty();
        let required = kind.all_keys().filter(is_required);
        let mut value = json!({
            "description": kind.about, "type": "object", "properties": properties,
            "required": required.map(|key| key.name).collect::<Vec<_>>(),
            "additionalProperties": false
        });
        if !conditions.is_empty() {
            value["allOf"] = conditions.into();
        }
        value
    }

    fn property(&mut self, key: &Key) -> Value {
        let mut value = self.takes(key.takes);
        if let Some(default) = key.absent.value() {
            value["default"] = default;
        }
        about(value, key.about)
    }

    fn takes(&mut self, takes: Takes) -> Value {
        match takes {
            Takes::Anything => json!({}),
            Takes::Text => json!({"type": "string", "minLength": 1}),
            Takes::Truth => json!({"type": "boolean"}),
            Takes::Number(range) if range == Range::COORDINATE => reference("number"),
            Takes::Number(range) => number(range),
            Takes::Integer(low, high) => {
                json!({"type": "integer", "minimum": low, "maximum": high})
            }
            Takes::OneOf(numbers) => json!({"enum": numbers}),
            Takes::Point | Takes::Direction(_) => reference("point"),
            Takes::Color => reference("color"),
            Takes::Choice(words) => json!({"enum": words()}),
            Takes::Object(kind) => self.kind(kind),
            Takes::Variants(variants) => self.variants(variants),
            Takes::Either(first, second) => {
                let is_object = matches!(first, Takes::Object(_));
                json!({
                    "if": {"type": if is_object { "object" } else { "array" }},
                    "then": self.takes(*first), "else": self.takes(*second)
                })
            }
            Takes::Matrix => reference("matrix"),
            Takes::AtLeast(count, item) => {
                json!({"type": "array", "items": self.takes(*item), "minItems": count})
            }
            Takes::Exactly(count, item) => tuple(count, self.takes(*item)),
        }
    }
}

fn matrix() -> Value {
    let row = || tuple(4, reference("number"));
    json!({
        "description": "Four rows; it acts on columns, so that the last column is the translation.",
        "type": "array", "prefixItems": [row(), row(), row(), {"const": [0, 0, 0, 1]}],
        "minItems": 4, "maxItems": 4
    })
}

/// The value with a description.
fn about(mut value: Value, text: &str) -> Value {
    value["description"] = text.into();
    value
}

fn reference(name: &str) -> Value {
    json!({"$ref": format!("{DEFINITIONS}{name}")})
}

fn number(range: Range) -> Value {
    let Range { low, high, open } = range;
    let least = if open { "exclusiveMinimum" } else { "minimum" };
    json!({"type": "number", least: plain(low), "maximum": plain(high)})
}

/// An array of exactly `count` of `item`.
fn tuple(count: usize, item: Value) -> Value {
    json!({"type": "array", "items": item, "minItems": count, "maxItems": count})
}
