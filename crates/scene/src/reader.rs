//! Reads JSON so that every error names its place.
//!
//! A [`Cursor`] is a JSON value that knows its path; an [`Object`] is one whose keys have been
//! compared with the table of its [`Kind`], which says what each [`Key`] takes. Both make errors
//! with the file, the path and the value found, so that parsers only state the remedy. Parsers are
//! not derived by serde, because its errors name a line at best, and never the path, the value or a
//! remedy.
//!
//! Paths are chains of borrowed steps: nothing is allocated until there is an error, which matters
//! for a mesh of a million points.

mod cursor;
pub(crate) mod json;
mod keys;
mod notes;
mod object;
mod place;

pub(crate) use cursor::{Cursor, POINT, Range, integer_words};
pub(crate) use keys::{Absent, Key, Kind, Takes, keys, word};
pub(crate) use notes::Notes;
pub(crate) use object::Object;
pub(crate) use place::Place;
