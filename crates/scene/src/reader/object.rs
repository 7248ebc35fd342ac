//! JSON objects with known keys.

use glam::DVec3;
use serde_json::{Map, Value};

use super::cursor::{COLOR, Cursor, POINT, Range, integer_words, words_of};
use super::keys::{Absent, Key, Kind, Takes, keys};
use super::place::Place;
use wavecrest_base::choice::Choice;
use wavecrest_base::error::{Error, ErrorKind, Result, did_you_mean};

/// A JSON object, and the keys that its kind allows.
///
/// The keys are declared before any is read, so that a missing key can be matched with a misspelt
/// one.
pub(crate) struct Object<'a> {
    cursor: Cursor<'a>,
    map: &'a Map<String, Value>,
    kind: Kind,
}

impl<'a> Cursor<'a> {
    /// The value as an object with the keys of its `kind`.
    pub(crate) fn object(&self, kind: Kind) -> Result<Object<'a>> {
        let object = self.any_object(kind)?;
        object.check_keys();
        Ok(object)
    }

    /// The kind of this object, from its key `type`; `what` describes the kinds.
    pub(crate) fn kind<T: Choice>(&self, what: &'static str) -> Result<T> {
        const TYPE: &[Key] = keys! {
            /// The kind of object.
            "type": Anything, Required;
        };
        let options = options();
        let object = self.any_object(Kind::new(what, "", &[TYPE]))?;
        object.need("type", &words_of(&options))?.choice(&options)
    }

    fn any_object(&self, kind: Kind) -> Result<Object<'a>> {
        let what = || self.must_be(&format!("{}, an object {{ ... }}", kind.name));
        let map = self.value().as_object().ok_or_else(what)?;
        Ok(Object { cursor: *self, map, kind })
    }
}

impl<'a> Object<'a> {
    /// The object as a value.
    pub(crate) fn cursor(&self) -> &Cursor<'a> {
        &self.cursor
    }

    /// The table's entry for a key.
    fn key(&self, name: &str) -> Option<&'static Key> {
        self.kind.all_keys().find(|key| key.name == name)
    }

    /// The value of an optional `key`.
    pub(crate) fn get(&self, key: &'static str) -> Option<Cursor<'_>> {
        debug_assert!(self.key(key).is_some(), "{key} is read but not among the keys");
        let value = self.map.get(key)?;
        Some(Cursor::new(value, Place::Key(self.cursor.place(), key), self.cursor.notes()))
    }

    /// Whether a key of this kind is set.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.key(key).is_some() && self.map.contains_key(key)
    }

    /// The value of a required `key`; `what` describes it.
    pub(crate) fn need(&self, key: &'static str, what: &str) -> Result<Cursor<'_>> {
        self.need_one_of(&[key], what)
    }

    /// The value of the one of the synonymous `names` that is set.
    pub(crate) fn one_of(&self, names: &[&'static str]) -> Result<Option<Cursor<'_>>> {
        let mut found = names.iter().filter_map(|name| Some((name, self.get(name)?)));
        let first = found.next();
        if let (Some((a, _)), Some((b, second))) = (&first, found.next()) {
            let message = format!("means the same as {a:?}, which is also given");
            return Err(second.error(message).remedy(format!("keep {a:?} or {b:?}, not both")));
        }
        Ok(first.map(|(_, cursor)| cursor))
    }

    /// As [`Object::one_of`], required.
    pub(crate) fn need_one_of(&self, names: &[&'static str], what: &str) -> Result<Cursor<'_>> {
        self.one_of(names)?.ok_or_else(|| self.missing(names, what))
    }

    fn missing(&self, names: &[&'static str], what: &str) -> Error {
        let place = Place::Key(self.cursor.place(), names[0]).to_string();
        let error = self.cursor.notes().error(ErrorKind::Scene, &place, "is missing".into());
        match names.iter().find_map(|name| did_you_mean(name, self.unknown_keys())) {
            Some(misspelt) => error.remedy(format!("rename {misspelt:?} to {:?}", names[0])),
            None => error.remedy(format!("give {what}")),
        }
    }

    fn unknown_keys(&self) -> impl Iterator<Item = &'a str> {
        self.map.keys().map(String::as_str).filter(|key| self.key(key).is_none())
    }

    /// Warns of unknown keys; if strict, they are errors.
    fn check_keys(&self) {
        let notes = self.cursor.notes();
        for key in self.unknown_keys() {
            let place = Place::Key(self.cursor.place(), key);
            let cursor = Cursor::new(&self.map[key], place, notes);
            let error = cursor.error(format!("is not a key of {}", self.kind.name));
            notes.warn_or_fail(error.remedy(self.advice(key)));
        }
    }

    fn advice(&self, key: &str) -> String {
        let advice = if self.cursor.notes().strict() { "remove it" } else { "it is ignored" };
        let names = self.kind.all_keys().map(|key| key.name);
        match did_you_mean(key, names.filter(|name| !self.map.contains_key(*name))) {
            Some(meant) => format!("{advice}; did you mean {meant:?}?"),
            None => advice.to_owned(),
        }
    }

    /// The default of a key.
    fn absent(&self, key: &str) -> Absent {
        self.key(key).map_or(Absent::Required, |key| key.absent)
    }

    /// The range of a key's numbers.
    pub(crate) fn range(&self, key: &str) -> Range {
        match self.key(key).map(|key| key.takes) {
            Some(Takes::Number(range)) => range,
            _ => {
                debug_assert!(false, "{key} takes no number");
                Range::COORDINATE
            }
        }
    }

    /// The value of a key converted by `read`, or the `default`. An error, or a missing required
    /// key, is recorded, and reading continues with the value `any`.
    fn value<T>(
        &self,
        key: &'static str,
        what: &str,
        default: Option<T>,
        any: T,
        read: impl FnOnce(&Cursor<'_>) -> Result<T>,
    ) -> T {
        let notes = self.cursor.notes();
        match (self.get(key), default) {
            (Some(cursor), _) => notes.part(|| read(&cursor)).unwrap_or(any),
            (None, Some(default)) => default,
            (None, None) => {
                notes.fail(self.missing(&[key], what));
                any
            }
        }
    }

    /// A part with its own reading function; `what` describes it.
    pub(crate) fn part<T>(
        &self,
        key: &'static str,
        what: &str,
        read: impl FnOnce(&Cursor<'_>) -> Result<T>,
    ) -> Result<T> {
        self.cursor.notes().part(|| read(&self.need(key, what)?))
    }

    /// A number.
    pub(crate) fn number(&self, key: &'static str) -> f64 {
        let range = self.range(key);
        let default = match self.absent(key) {
            Absent::Is(x) => Some(x),
            _ => None,
        };
        self.value(key, &range.words(), default, 1.0, |cursor| cursor.number(range))
    }

    /// A number, or `default`.
    pub(crate) fn number_or(&self, key: &'static str, default: f64) -> f64 {
        let range = self.range(key);
        self.value(key, "", Some(default), default, |cursor| cursor.number(range))
    }

    /// An integer.
    pub(crate) fn integer(&self, key: &'static str) -> u32 {
        let (low, high) = match self.key(key).map(|key| key.takes) {
            Some(Takes::Integer(low, high)) => (low, high),
            _ => {
                debug_assert!(false, "{key} takes no integer");
                (0, u32::MAX)
            }
        };
        let default = match self.absent(key) {
            // Tables contain only integers in range.
            Absent::Is(x) => Some(x as u32),
            _ => None,
        };
        let what = integer_words(low, high);
        self.value(key, &what, default, low, |cursor| cursor.integer(low, high))
    }

    /// A point or a direction.
    pub(crate) fn point(&self, key: &'static str) -> DVec3 {
        self.value(key, POINT, self.three(key), DVec3::ONE, |cursor| cursor.point())
    }

    /// A point or a direction, or `default`.
    pub(crate) fn point_or(&self, key: &'static str, default: DVec3) -> DVec3 {
        self.value(key, "", Some(default), default, |cursor| cursor.point())
    }

    /// A colour.
    pub(crate) fn color(&self, key: &'static str) -> DVec3 {
        self.value(key, COLOR, self.three(key), DVec3::ONE, |cursor| cursor.color())
    }

    /// The default of three numbers.
    fn three(&self, key: &str) -> Option<DVec3> {
        match self.absent(key) {
            Absent::Are(three) => Some(three.into()),
            _ => None,
        }
    }

    /// A word.
    pub(crate) fn word<T: Choice>(&self, key: &'static str) -> T {
        let default = match self.absent(key) {
            Absent::Says(word) => T::VALUES.iter().find(|value| value.name() == word),
            _ => None,
        };
        let options = options();
        let read = |cursor: &Cursor<'_>| cursor.choice(&options);
        self.value(key, &words_of(&options), default.copied(), T::VALUES[0], read)
    }

    /// A word, or `default`.
    pub(crate) fn word_or<T: Choice>(&self, key: &'static str, default: T) -> T {
        self.value(key, "", Some(default), default, |cursor| cursor.choice(&options()))
    }
}

/// The values of `T` by name.
fn options<T: Choice>() -> Vec<(&'static str, T)> {
    T::VALUES.iter().map(|value| (value.name(), *value)).collect()
}
