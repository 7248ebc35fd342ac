//! JSON objects with known keys, read and written.

use glam::DVec3;
use hecs::{EntityBuilder, EntityRef};
use serde_json::Value;

use super::cursor::{Cursor, Place, quoted};
use super::field::Field;
use super::keys::{Absent, Declaration, Key, Kind, Object, TYPE, Variants};
use super::related::related;
use super::writer::Writer;
use wavecrest_base::error::{Error, Result, did_you_mean};

impl<'a> Cursor<'a> {
    /// The value as an object with the keys of its `kind`.
    pub(crate) fn object(&self, kind: Kind) -> Result<Object<'a>> {
        let object = self.any_object(kind)?;
        object.check_keys();
        Ok(object)
    }

    /// The value as an object of the kind that its key `type` names.
    pub(crate) fn variant(&self, variants: &Variants) -> Result<Object<'a>> {
        let words = variants.words();
        let object = self.any_object(Kind::new(variants.name, "", TYPE))?;
        let names = quoted(words.iter().map(|(word, _)| *word));
        let word = object.need("type", &names)?.choice(&words)?;
        let is_given = |key: &str| key.is_empty() || self.value().get(key).is_some();
        let is_it = |kind: &&Kind| kind.word == word && is_given(kind.discriminator);
        let kind = variants.kinds.iter().find(is_it);
        // The last of each word needs no key.
        self.object(*kind.ok_or_else(|| self.must_be(variants.name))?)
    }

    fn any_object(&self, kind: Kind) -> Result<Object<'a>> {
        let what = || self.must_be(&format!("{}, an object {{ ... }}", kind.name));
        let map = self.value().as_object().ok_or_else(what)?;
        Ok(Object { cursor: *self, map, kind })
    }
}

impl<'a> Object<'a> {
    /// The value of its key `type`; empty if it has no such key.
    pub(crate) fn word(&self) -> &'static str {
        self.kind.word
    }

    /// The object as a value.
    pub(crate) fn cursor(&self) -> &Cursor<'a> {
        &self.cursor
    }

    /// The value of an optional `key`, by any of its names.
    pub(crate) fn get(&self, key: &'static str) -> Option<Cursor<'_>> {
        let known = self.kind.key(key);
        debug_assert!(known.is_some(), "{key} is read but not among the keys");
        self.value_of(&known?)
    }

    fn value_of(&self, key: &Key) -> Option<Cursor<'_>> {
        let name = key.names().find(|name| self.map.contains_key(*name))?;
        Some(self.cursor.under(name))
    }

    /// Whether a key of this kind is set.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.kind.key(key).is_some_and(|key| key.names().any(|name| self.map.contains_key(name)))
    }

    /// Warns of the value of a `key`, if it is there.
    pub(crate) fn warn(&self, key: &'static str, message: &str, remedy: &str) {
        self.get(key).into_iter().for_each(|cursor| cursor.warn(message, remedy));
    }

    /// Warns of a number, or a channel of a colour, above 1. Invalid values are reported when they are
    /// read.
    pub(crate) fn warn_above_1(&self, key: &'static str, message: &str, remedy: &str) {
        let Some(cursor) = self.get(key) else { return };
        let number = cursor.value().as_f64();
        let greatest = number.or_else(|| cursor.color().ok().map(DVec3::max_element));
        if greatest.is_some_and(|x| x > 1.0) {
            cursor.warn(message, remedy);
        }
    }

    /// The value of a required `key`; `what` describes it.
    pub(crate) fn need(&self, key: &'static str, what: &str) -> Result<Cursor<'_>> {
        self.get(key).ok_or_else(|| self.missing(key, what))
    }

    /// Adds the components of the object's kind to its `entity`. The errors of all are recorded,
    /// and one is returned.
    pub(crate) fn components(&self, entity: &mut EntityBuilder) -> Result<()> {
        let read =
            |component: &Declaration| self.cursor.notes().part(|| (component.read)(self, entity));
        self.kind.declarations().map(read).fold(Ok(()), Result::and)
    }

    fn missing(&self, key: &'static str, what: &str) -> Error {
        let error = self.cursor.under(key).error_here("is missing");
        let mut names = self.kind.key(key).into_iter().flat_map(|key| key.names());
        let theirs = || self.unknown_keys().find(|other| related(other) == Some(key));
        match names.find_map(|name| did_you_mean(name, self.unknown_keys())) {
            Some(misspelt) => error.remedy(format!("rename {misspelt:?} to {key:?}")),
            None => error.remedy(match theirs() {
                Some(theirs) => format!("give {what}, in place of {theirs:?}"),
                None => format!("give {what}"),
            }),
        }
    }

    fn unknown_keys(&self) -> impl Iterator<Item = &'a str> {
        self.map.keys().map(String::as_str).filter(|key| self.kind.key(key).is_none())
    }

    /// Warns of unknown keys; if strict, they are errors. So are synonyms of one key. Warns of keys
    /// without those that they need.
    fn check_keys(&self) {
        let notes = self.cursor.notes();
        let has_others = |key: &Key| !key.synonyms.is_empty() || !key.needs.is_empty();
        for key in self.kind.all_keys().filter(has_others) {
            let given: Vec<_> = key.names().filter(|name| self.map.contains_key(*name)).collect();
            if let [first, other, ..] = given[..] {
                let message = format!("means the same as {first:?}, which is also given");
                let error = self.cursor.under(other).error(message);
                notes.fail(error.remedy(format!("keep {first:?} or {other:?}, not both")));
            }
            if key.is_idle(self.map) {
                let needs = key.needs.join("\" or \"");
                let message = format!("has no effect without \"{needs}\"");
                self.warn(key.name, &message, &format!("add \"{needs}\", or remove it"));
            }
        }
        for key in self.unknown_keys() {
            let message = format!("is not a key of {}", self.kind.name);
            let error = self.cursor.under(key).error(message);
            notes.warn_or_fail(error.remedy(self.advice(key)));
        }
    }

    fn advice(&self, key: &str) -> String {
        let advice = if self.cursor.notes().strict { "remove it" } else { "it is ignored" };
        let names = || self.kind.all_keys().flat_map(|key| key.names());
        let free = |name: &&str| !self.map.contains_key(*name);
        let related = related(key).filter(|own| names().any(|name| name == *own)).filter(free);
        match related.or_else(|| did_you_mean(key, names().filter(free))) {
            Some(meant) => format!("{advice}; did you mean {meant:?}?"),
            None => advice.to_owned(),
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

    /// The value of a key, or its default. An error is recorded.
    pub(crate) fn read<T: Field>(&self, key: &'static str) -> T {
        self.read_or(key, None)
    }

    /// The value of a key, or `usual`, or its default. An error is recorded. A required key has no
    /// usual value, and a key of other kinds has no other.
    pub(crate) fn read_or<T: Field>(&self, key: &'static str, usual: Option<T>) -> T {
        let Some(key) = self.kind.key(key) else {
            debug_assert!(usual.is_some(), "{key} is a key of every kind that reads it");
            return usual.unwrap_or(T::ANY);
        };
        let notes = self.cursor.notes();
        let read = |cursor: &Cursor<'_>| notes.part(|| T::read(cursor, key.takes));
        if let Some(cursor) = self.value_of(&key) {
            return read(&cursor).unwrap_or(T::ANY);
        }
        let usual = usual.filter(|_| key.absent != Absent::Required).or(T::WITHOUT);
        let own = || read(&Cursor::new(&key.absent.value()?, Place::Top, notes)).ok();
        usual.or_else(own).unwrap_or_else(|| {
            notes.fail(self.missing(key.name, &key.takes.words()));
            T::ANY
        })
    }
}

impl Writer<'_> {
    /// The object of an `entity` with the components of a `kind`.
    pub(crate) fn of(mut self, kind: &Kind, entity: EntityRef<'_>) -> Value {
        self.components(kind, entity);
        self.end()
    }

    /// Writes the components of an `entity` of a `kind`, without keys of no effect.
    pub(crate) fn components(&mut self, kind: &Kind, entity: EntityRef<'_>) {
        kind.declarations().for_each(|component| (component.write)(entity, self));
        while let Some(idle) = kind.all_keys().find(|key| key.is_idle(&self.map)) {
            self.remove(idle.name);
        }
    }

    /// The same for the kind that its components tell: of several, the one with the most.
    pub(crate) fn variant(mut self, variants: &Variants, entity: EntityRef<'_>) -> Value {
        let is_of = |kind: &&Kind| kind.components.first().is_some_and(|own| (own.is_in)(entity));
        let kinds = variants.kinds.iter().filter(is_of);
        match kinds.max_by_key(|kind| kind.components.len()) {
            Some(kind) => {
                self.set("type", kind.word);
                self.of(kind, entity)
            }
            None => Value::Null,
        }
    }

    /// Writes a field.
    pub(crate) fn put(&mut self, key: &str, value: impl Field) {
        let value = value.to_json();
        if !value.is_null() {
            self.set(key, value);
        }
    }
}
