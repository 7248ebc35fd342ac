//! The members of a JSON object, read one by one, each error with its path.
//!
//! Unlike in a scene file, unknown keys are ignored: other programs add their own to glTF files.

use glam::DVec3;
use serde_json::Value;

use crate::format::{Cursor, Notes, Place, Range};
use wavecrest_base::error::{Error, Result};

/// The largest count or offset: JSON numbers are exact up to 2^53.
const GREATEST_COUNT: f64 = 9_007_199_254_740_992.0;

/// The extension with the lights.
pub(super) const LIGHTS: &str = "KHR_lights_punctual";

/// An object of the file.
#[derive(Clone, Copy)]
pub(super) struct Fields<'a> {
    pub(super) cursor: Cursor<'a>,
    /// The whole file, into whose lists indices point.
    file: &'a Value,
}

impl<'a> Fields<'a> {
    /// The whole file.
    pub(super) fn top(file: &'a Value, notes: &'a Notes<'a>) -> Result<Self> {
        Self::of(Cursor::new(file, Place::Top, notes), "a glTF file", file)
    }

    fn of(cursor: Cursor<'a>, what: &str, file: &'a Value) -> Result<Self> {
        if cursor.value().is_object() {
            return Ok(Self { cursor, file });
        }
        Err(cursor.error(format!("must be {what}, an object {{ ... }}")))
    }

    /// An object without members.
    pub(super) fn nothing(&self) -> Self {
        let cursor = Cursor::new(&Value::Null, Place::Top, self.cursor.notes());
        Self { cursor, file: self.file }
    }

    pub(super) fn path(&self) -> String {
        self.cursor.path()
    }

    /// The value of `key`, if it is there.
    pub(super) fn get<'s>(&'s self, key: &'s str) -> Option<Cursor<'s>> {
        self.cursor.value().get(key).map(|_| self.cursor.under(key))
    }

    /// The value of the required `key`; `what` describes it.
    pub(super) fn need<'s>(&'s self, key: &'s str, what: &str) -> Result<Cursor<'s>> {
        self.get(key).ok_or_else(|| {
            let error = self.cursor.under(key).error_here("is missing");
            error.remedy(format!("it should be {what}"))
        })
    }

    /// The object under `key`, if it is there.
    pub(super) fn object<'s>(&'s self, key: &'s str) -> Result<Option<Fields<'s>>> {
        self.get(key).map(|cursor| Fields::of(cursor, "an object", self.file)).transpose()
    }

    /// The required object under `key`; `what` describes it.
    pub(super) fn need_object<'s>(&'s self, key: &'s str, what: &str) -> Result<Fields<'s>> {
        Fields::of(self.need(key, "an object { ... }")?, what, self.file)
    }

    /// The object of an extension, if it is there.
    pub(super) fn extension<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Fields<'_>) -> Result<T>,
    ) -> Result<Option<T>> {
        let Some(extensions) = self.object("extensions")? else { return Ok(None) };
        extensions.object(name)?.map(|found| read(&found)).transpose()
    }

    /// A number, or `default`.
    pub(super) fn number_or(&self, key: &str, range: Range, default: f64) -> Result<f64> {
        self.get(key).map_or(Ok(default), |cursor| cursor.number(range))
    }

    /// A list of `N` numbers, if it is there.
    pub(super) fn numbers<const N: usize>(
        &self,
        key: &str,
        range: Range,
    ) -> Result<Option<[f64; N]>> {
        let what = format!("{N} numbers");
        self.get(key).map(|cursor| cursor.numbers(&what, range)).transpose()
    }

    /// Three numbers, or `default`.
    pub(super) fn vector_or(&self, key: &str, range: Range, default: DVec3) -> Result<DVec3> {
        Ok(self.numbers::<3>(key, range)?.map_or(default, DVec3::from_array))
    }

    /// The weights of morph targets, if they are there.
    pub(super) fn weights(&self) -> Result<Option<Vec<f64>>> {
        let number = |item: Cursor<'_>| item.number(Range::COORDINATE);
        self.get("weights").map(|cursor| cursor.each("a list of numbers", number)).transpose()
    }

    /// A count, if it is there.
    pub(super) fn count(&self, key: &str) -> Result<Option<u64>> {
        self.get(key).map(|cursor| count(&cursor)).transpose()
    }

    /// A required count.
    pub(super) fn need_count(&self, key: &str) -> Result<u64> {
        count(&self.need(key, "a whole number, 0 or more")?)
    }

    /// The offset of the object's bytes; 0 by default.
    pub(super) fn offset(&self) -> Result<u64> {
        Ok(self.count("byteOffset")?.unwrap_or(0))
    }

    /// An index into a list of the file, if any.
    pub(super) fn index(&self, key: &str, list: &str) -> Result<Option<usize>> {
        self.get(key).map(|cursor| self.index_of(&cursor, list)).transpose()
    }

    /// As [`Fields::index`], required.
    pub(super) fn need_index(&self, key: &str, list: &str) -> Result<usize> {
        self.index_of(&self.need(key, &format!("an index into {list}"))?, list)
    }

    /// A list of indices into a list of the file; empty by default.
    pub(super) fn indices(&self, key: &str, list: &str) -> Result<Vec<usize>> {
        let Some(cursor) = self.get(key) else { return Ok(Vec::new()) };
        cursor.each("a list of indices", |item| self.index_of(&item, list))
    }

    /// The value as an index into a list of the file.
    fn index_of(&self, cursor: &Cursor<'_>, list: &str) -> Result<usize> {
        let length = self.length(list);
        let found = cursor.value().as_u64().and_then(|i| usize::try_from(i).ok());
        found.filter(|&i| i < length).ok_or_else(|| {
            let must = cursor.error(format!("must be the index of one of the {list}"));
            match length {
                0 => must.remedy(format!("the file has no {list}")),
                n => must.remedy(format!("the file has {n}, counted from 0")),
            }
        })
    }

    /// The length of a list of the file; 0 without it.
    pub(super) fn length(&self, list: &str) -> usize {
        let owner = match list {
            "lights" => &self.file["extensions"][LIGHTS],
            _ => self.file,
        };
        owner[list].as_array().map_or(0, Vec::len)
    }

    /// The meaning of a number in a table of `codes`, if it is there; `must_be` describes them all.
    pub(super) fn code<T: Copy>(
        &self,
        key: &str,
        codes: &[(u64, T)],
        must_be: &str,
    ) -> Result<Option<T>> {
        let Some(cursor) = self.get(key) else { return Ok(None) };
        let number = cursor.value().as_u64();
        match codes.iter().find(|(code, _)| number == Some(*code)) {
            Some((_, meaning)) => Ok(Some(*meaning)),
            None => Err(cursor.error(format!("must be {must_be}"))),
        }
    }

    /// A text, if it is there.
    pub(super) fn text(&self, key: &str) -> Result<Option<String>> {
        let Some(cursor) = self.get(key) else { return Ok(None) };
        match cursor.value().as_str() {
            Some(text) => Ok(Some(text.to_owned())),
            None => Err(cursor.error("must be a string")),
        }
    }

    /// The name of the object, if it has one.
    pub(super) fn name(&self) -> Result<Option<String>> {
        Ok(self.text("name")?.filter(|name| !name.is_empty()))
    }

    /// A boolean; false by default.
    pub(super) fn flag(&self, key: &str) -> Result<bool> {
        self.get(key).map_or(Ok(false), |cursor| cursor.truth())
    }

    /// The objects of a list, each read by `read`; none without a list. All are read: every error is
    /// recorded, and one is returned.
    pub(super) fn list<T>(
        &self,
        key: &str,
        what: &str,
        mut read: impl FnMut(&Fields<'_>) -> Result<T>,
    ) -> Result<Vec<T>> {
        let Some(cursor) = self.get(key) else { return Ok(Vec::new()) };
        let read = |item: Cursor<'_>| read(&Fields::of(item, what, self.file)?);
        cursor.notes().part(|| cursor.every("a list [...]", read))
    }

    /// A list of texts; empty by default.
    pub(super) fn texts(&self, key: &str) -> Result<Vec<String>> {
        let Some(cursor) = self.get(key) else { return Ok(Vec::new()) };
        cursor.each("a list of texts", |item| item.text("a text").map(str::to_owned))
    }

    /// Adds a warning about the object.
    pub(super) fn warn(&self, message: &str, remedy: &str) {
        self.cursor.notes().note(&self.path(), message, remedy);
    }

    /// An error about the object, without showing it: it may be long.
    pub(super) fn error(&self, message: impl Into<String>) -> Error {
        self.cursor.error_here(message)
    }

    /// An error about the value of a `key`.
    pub(super) fn error_at(&self, key: &str, message: impl Into<String>) -> Error {
        self.cursor.under(key).error(message)
    }
}

fn count(cursor: &Cursor<'_>) -> Result<u64> {
    let whole = cursor.value().as_f64().filter(|x| x.fract() == 0.0);
    match whole.filter(|x| (0.0..=GREATEST_COUNT).contains(x)) {
        // Exact: it is an integer of at most 2^53.
        Some(x) => Ok(x as u64),
        None => Err(cursor.error("must be a whole number, 0 or more")),
    }
}
