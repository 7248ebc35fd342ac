//! Warnings, with equal ones grouped.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

use super::{Details, Error, OneLine, hash};

/// A condition that does not stop the work but that the user should know of; it reads like an
/// [`Error`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    file: Option<PathBuf>,
    place: Option<String>,
    text: String,
    /// The number of further places with the same warning.
    others: usize,
}

impl Warning {
    /// A warning with the text of `error`.
    pub fn from_error(error: &Error) -> Self {
        let Details { file, place, .. } = &*error.details;
        let text = error.message_with_value_and_remedy();
        Self { file: file.clone(), place: place.clone(), text, others: 0 }
    }

    /// The file concerned, if one is.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The warning without the name of its file.
    #[must_use]
    pub fn without_file(&self) -> Self {
        Self { file: None, ..self.clone() }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, place, text, others } = self;
        let f = &mut OneLine(f);
        if let Some(file) = file {
            write!(f, "{}: ", file.display())?;
        }
        match (place, others) {
            (Some(place), 0) => write!(f, "{place}: ")?,
            (Some(place), 1) => write!(f, "{place} and 1 other: ")?,
            (Some(place), n) => write!(f, "{place} and {n} others: ")?,
            (None, _) => {}
        }
        f.write_str(text)
    }
}

/// Warnings in the order of their discovery; equal warnings for several places are one.
#[derive(Clone, Debug, Default)]
pub struct Warnings {
    list: Vec<Warning>,
    /// The index of each warning by its text.
    known: HashMap<String, usize>,
    /// Hashes of all texts: repeated warnings count once.
    given: HashSet<u64>,
}

impl Warnings {
    /// Adds a warning with the text of `error`.
    pub fn add_error(&mut self, error: &Error) {
        // The value found may differ from place to place.
        let Details { file, place, message, remedy, .. } = &*error.details;
        let place = place.as_deref().unwrap_or_default().replace(|c: char| c.is_ascii_digit(), "");
        let what = format!("{file:?} {place} {message} {remedy:?}");
        self.add(Warning::from_error(error), what);
    }

    /// Adds a warning; one with the same text for another place increments its count.
    fn add(&mut self, warning: Warning, what: String) {
        if !self.given.insert(hash(&warning.to_string())) {
            return;
        }
        match self.known.entry(what) {
            Entry::Occupied(known) => self.list[*known.get()].others += 1 + warning.others,
            Entry::Vacant(new) => {
                new.insert(self.list.len());
                self.list.push(warning);
            }
        }
    }

    /// Adds warnings that are grouped already.
    pub fn extend(&mut self, warnings: impl IntoIterator<Item = Warning>) {
        warnings.into_iter().for_each(|warning| {
            let what = warning.to_string();
            self.add(warning, what);
        });
    }

    /// All warnings.
    pub fn into_vec(self) -> Vec<Warning> {
        self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    #[test]
    fn warnings_that_say_the_same_are_one() {
        let warning = |place: &str, value: u32| {
            let error = Error::new(ErrorKind::Scene, "is above 1").in_file("s.json").at(place);
            error.value(value).remedy("use 0 to 1")
        };
        let mut warnings = Warnings::default();
        for (place, value) in [("shapes[0].kd", 2), ("shapes[0].kd", 2), ("shapes[10].kd", 3)] {
            warnings.add_error(&warning(place, value));
        }
        warnings.add_error(&warning("shapes[0].ks", 2));
        let all: Vec<String> = warnings.clone().into_vec().iter().map(Warning::to_string).collect();
        let expected = [
            "s.json: shapes[0].kd and 1 other: is above 1, found 2; use 0 to 1",
            "s.json: shapes[0].ks: is above 1, found 2; use 0 to 1",
        ];
        assert_eq!(all, expected);
        warnings.add_error(&warning("shapes[11].kd", 3));
        let first = warnings.into_vec().remove(0).without_file();
        assert_eq!(first.to_string(), "shapes[0].kd and 2 others: is above 1, found 2; use 0 to 1");
    }
}
