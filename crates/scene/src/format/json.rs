//! Parses JSON text into a [`Value`] without repeated keys.
//!
//! `serde_json` alone keeps the last of equal keys, so that a pasted line would change a scene
//! silently.

use std::fmt;
use std::path::Path;

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};

use wavecrest_base::error::{Error, ErrorKind, Result};

/// The value in the `text` of a file. An object with equal keys is refused.
pub(crate) fn parse(text: &str, file: &Path) -> Result<Value> {
    // Some editors write a byte order mark first, which JSON does not allow.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim_ascii().is_empty() {
        return Err(Error::new(ErrorKind::Syntax, "the file is empty").in_file(file).remedy(
            "write a scene in it, as SCENES.md describes, or render a .gltf, .glb, .ply, .obj or .stl file",
        ));
    }
    serde_json::from_str::<Unique>(text).map(|unique| unique.0).map_err(|e| {
        let (why, remedy) = explained(text, &e);
        let place = format!("line {} column {}", e.line(), e.column());
        Error::new(ErrorKind::Syntax, why).in_file(file).at(place).remedy(remedy)
    })
}

/// The error in words, and the remedy.
fn explained(text: &str, error: &serde_json::Error) -> (String, &'static str) {
    let line = text.lines().nth(error.line().saturating_sub(1)).unwrap_or_default();
    let rest = line.get(error.column().saturating_sub(1)..).unwrap_or_default();
    let full = error.to_string();
    let reason = full.split(" at line ").next().unwrap_or_default();
    let known = match reason {
        _ if error.is_eof() => {
            ("the file ends too early", "check that the file is whole, and close every bracket")
        }
        _ if rest.starts_with("//") || rest.starts_with("/*") || rest.starts_with('#') => {
            ("JSON has no comments", "remove the comment")
        }
        "trailing characters" => {
            ("there is more after the end of the scene", "keep one scene in a file")
        }
        "trailing comma" => ("a comma before a closing bracket", "remove the comma"),
        "key must be a string" => ("a key without quotes", "write it in double quotes: \"key\""),
        "expected `:`" => ("a key without a value", "write a colon and a value after it"),
        "expected `,` or `}`" | "expected `,` or `]`" => {
            ("a comma or a closing bracket is missing", "add it before this place")
        }
        "expected value" | "expected ident" => (
            "a value is missing or malformed",
            "write a number, a text in double quotes, true, false, a list or an object",
        ),
        "recursion limit exceeded" => ("brackets are nested too deeply", "remove some of them"),
        "number out of range" => ("the number is too large", "use one below 1e308"),
        _ => return (format!("not valid JSON: {reason}"), "check the text at this place"),
    };
    (known.0.to_owned(), known.1)
}

struct Unique(Value);

impl<'de> Deserialize<'de> for Unique {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(UniqueVisitor).map(Self)
    }
}

struct UniqueVisitor;

impl<'de> Visitor<'de> for UniqueVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> std::result::Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> std::result::Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> std::result::Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> std::result::Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> std::result::Result<Value, E> {
        Ok(Number::from_f64(value).map_or(Value::Null, Value::Number))
    }

    fn visit_str<E>(self, value: &str) -> std::result::Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> std::result::Result<Value, A::Error> {
        let mut array = Vec::new();
        while let Some(Unique(item)) = items.next_element()? {
            array.push(item);
        }
        Ok(Value::Array(array))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> std::result::Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            if object.contains_key(&key) {
                return Err(A::Error::custom(format!("the key {key:?} is given twice")));
            }
            let Unique(value) = entries.next_value()?;
            object.insert(key, value);
        }
        Ok(Value::Object(object))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_serde_json() {
        let text = r#"{"a": [1, -2, 3.5, 1e300, null, true, "x\n"], "b": {"a": {}}}"#;
        let expected: Value = serde_json::from_str(text).unwrap();
        assert_eq!(parse(text, Path::new("s.json")).unwrap(), expected);
    }
}
