//! The format of scene files: objects with known keys, and what they become.
//!
//! A [`Cursor`] is a JSON value that knows its path; an [`Object`] is one whose keys have been
//! compared with the table of its [`Kind`], which says what each [`Key`] takes. Both make errors
//! with the file, the path and the value found, so that readers only state the remedy. They are not
//! derived by serde, because its errors name a line at best, and never the path, the value or a
//! remedy. A component is [`Declared`] once; the [`Writer`] and the JSON schema use the same tables.
//!
//! Paths are chains of borrowed steps: nothing is allocated until there is an error, which matters
//! for a mesh of a million points.

mod cursor;
mod declared;
mod field;
pub(crate) mod json;
mod json_schema;
mod keys;
mod notes;
mod object;
mod related;
mod writer;

pub use cursor::Range;
pub(crate) use cursor::{Cursor, Place, integer_words};
pub(crate) use declared::{Declared, component, declared};
pub(crate) use field::{Field, Word, words};
pub(crate) use json_schema::json_schema;
pub use keys::{Absent, Declaration, Key, Kind, Takes, Variants};
pub(crate) use keys::{Object, keys, word};
pub(crate) use notes::Notes;
pub(crate) use writer::{Beside, Writer};
