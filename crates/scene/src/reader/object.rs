//! A JSON object whose allowed keys are known.

use glam::DVec3;
use serde_json::{Map, Value};

use super::cursor::{COLOR, POINT, integer_words, words_of};
use super::{Cursor, Place, Range};
use wavecrest_base::error::{Error, ErrorKind, Result, did_you_mean};

/// A JSON object, and the keys that its kind allows.
///
/// The keys are told before any is read, so that a missing key can be matched with a misspelt one.
pub(crate) struct Object<'a> {
    cursor: Cursor<'a>,
    map: &'a Map<String, Value>,
    kind: &'a str,
    keys: Vec<&'static str>,
}

impl<'a> Object<'a> {
    pub(super) fn new(
        cursor: Cursor<'a>,
        map: &'a Map<String, Value>,
        kind: &'a str,
        keys: Vec<&'static str>,
    ) -> Self {
        Self { cursor, map, kind, keys }
    }

    /// The object as a value.
    pub(crate) fn cursor(&self) -> &Cursor<'a> {
        &self.cursor
    }

    /// The value of an optional `key`.
    pub(crate) fn get(&self, key: &'static str) -> Option<Cursor<'_>> {
        debug_assert!(self.keys.contains(&key), "{key} is read but not among the keys");
        let value = self.map.get(key)?;
        Some(Cursor::new(value, Place::Key(self.cursor.place(), key), self.cursor.notes()))
    }

    /// The value of a required `key`; `what` says what it takes.
    pub(crate) fn need(&self, key: &'static str, what: &str) -> Result<Cursor<'_>> {
        self.need_one_of(&[key], what)
    }

    /// The value of the one of `names`, which mean the same, that is there.
    pub(crate) fn one_of(&self, names: &[&'static str]) -> Result<Option<Cursor<'_>>> {
        let mut found = names.iter().filter_map(|name| Some((name, self.get(name)?)));
        let first = found.next();
        if let (Some((a, _)), Some((b, second))) = (&first, found.next()) {
            let message = format!("means the same as {a:?}, which is given too");
            return Err(second.error(message).remedy(format!("keep {a:?} or {b:?}, not both")));
        }
        Ok(first.map(|(_, cursor)| cursor))
    }

    /// As [`Object::one_of`], where one must be there.
    pub(crate) fn need_one_of(&self, names: &[&'static str], what: &str) -> Result<Cursor<'_>> {
        self.one_of(names)?.ok_or_else(|| self.missing(names, what))
    }

    fn missing(&self, names: &[&'static str], what: &str) -> Error {
        let place = Place::Key(self.cursor.place(), names[0]).to_string();
        let error = self.cursor.notes().error(ErrorKind::Scene, &place, "is missing".into());
        match names.iter().find_map(|name| did_you_mean(name, self.unknown_keys())) {
            Some(misspelt) => error.remedy(format!("is it the key {misspelt:?}, misspelt?")),
            None => error.remedy(format!("give {what}")),
        }
    }

    fn unknown_keys(&self) -> impl Iterator<Item = &'a str> {
        self.map.keys().map(String::as_str).filter(|key| !self.keys.contains(key))
    }

    /// Warns of the keys that this kind of object does not have; where we are strict, fails.
    pub(super) fn check_keys(&self) -> Result<()> {
        for key in self.unknown_keys() {
            let cursor = Cursor::new(
                &self.map[key],
                Place::Key(self.cursor.place(), key),
                self.cursor.notes(),
            );
            let error = cursor.error(format!("is not a key of {}", self.kind));
            self.cursor.notes().warn_or_fail(error.remedy(self.advice(key)))?;
        }
        Ok(())
    }

    fn advice(&self, key: &str) -> String {
        let advice = if self.cursor.notes().strict() { "remove it" } else { "it is ignored" };
        let absent = self.keys.iter().filter(|k| !self.map.contains_key(**k)).copied();
        match did_you_mean(key, absent) {
            Some(meant) => format!("{advice}, or did you mean {meant:?}?"),
            None => advice.to_owned(),
        }
    }

    /// A required number.
    pub(crate) fn number(&self, key: &'static str, range: Range) -> Result<f64> {
        self.need(key, &range.words())?.number(range)
    }

    /// An optional number.
    pub(crate) fn number_or(&self, key: &'static str, range: Range, default: f64) -> Result<f64> {
        self.get(key).map_or(Ok(default), |cursor| cursor.number(range))
    }

    /// A required integer from `low` to `high`.
    pub(crate) fn integer(&self, key: &'static str, low: u32, high: u32) -> Result<u32> {
        self.need(key, &integer_words(low, high))?.integer(low, high)
    }

    /// An optional integer from 1 to `high`.
    pub(crate) fn count_or(&self, key: &'static str, high: u32, default: u32) -> Result<u32> {
        self.get(key).map_or(Ok(default), |cursor| cursor.integer(1, high))
    }

    /// A required point, under the one of `names` that is there.
    pub(crate) fn point(&self, names: &[&'static str]) -> Result<DVec3> {
        self.need_one_of(names, POINT)?.point()
    }

    /// An optional point or direction.
    pub(crate) fn point_or(&self, key: &'static str, default: DVec3) -> Result<DVec3> {
        self.get(key).map_or(Ok(default), |cursor| cursor.point())
    }

    /// A required colour.
    pub(crate) fn color(&self, key: &'static str) -> Result<DVec3> {
        self.need(key, COLOR)?.color()
    }

    /// A required word.
    pub(crate) fn choice<T: Copy>(
        &self,
        key: &'static str,
        options: &[(&'static str, T)],
    ) -> Result<T> {
        self.need(key, &words_of(options))?.choice(options)
    }

    /// An optional word.
    pub(crate) fn choice_or<T: Copy>(
        &self,
        key: &'static str,
        options: &[(&'static str, T)],
        default: T,
    ) -> Result<T> {
        self.get(key).map_or(Ok(default), |cursor| cursor.choice(options))
    }
}
