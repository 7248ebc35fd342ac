//! What the user should know of a file, each thing once: a file of a thousand materials that all have a
//! normal map says so in one line.

use std::cell::RefCell;
use std::collections::HashSet;

use crate::reader::Notes;
use wavecrest_base::error::ErrorKind;

/// Warnings, none of which is given twice.
pub(super) struct Remarks<'a> {
    pub(super) notes: &'a Notes<'a>,
    given: RefCell<HashSet<String>>,
}

impl<'a> Remarks<'a> {
    /// None yet.
    pub(super) fn new(notes: &'a Notes<'a>) -> Self {
        Self { notes, given: RefCell::default() }
    }

    /// Warns of what is so at `place`, unless it was so at another.
    pub(super) fn once(&self, place: &str, message: &str, remedy: &str) {
        if self.given.borrow_mut().insert(message.to_owned()) {
            let error = self.notes.error(ErrorKind::Scene, place, message.to_owned());
            self.notes.warn(&error.remedy(remedy));
        }
    }
}
