//! Errors, warnings and files recorded while reading a file.

use std::cell::RefCell;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::folder::Folder;
use wavecrest_base::error::{Error, ErrorKind, Result, Warning, Warnings, hash};

/// Largest number of listed errors of a file.
const MOST_ERRORS: usize = 10;

/// The state shared by the cursors of one file: its name, strictness, errors and warnings.
pub(crate) struct Notes<'a> {
    file: &'a Path,
    /// Whether unknown keys are errors.
    pub(crate) strict: bool,
    /// Whether files outside the folder of the referring file are read.
    pub(crate) outside: bool,
    /// The first errors.
    errors: RefCell<Vec<Error>>,
    warnings: RefCell<Warnings>,
    /// What is left out without harm.
    harmless: RefCell<Warnings>,
    /// Other files read.
    files: RefCell<Vec<PathBuf>>,
    /// Hashes of the texts of all errors, each once.
    given: RefCell<HashSet<u64>>,
}

impl<'a> Notes<'a> {
    /// Empty notes. If `strict`, unknown keys are errors; `outside` allows files outside the folder
    /// of the referring file.
    pub(crate) fn new(file: &'a Path, strict: bool, outside: bool) -> Self {
        let (errors, warnings, harmless, files, given) = Default::default();
        Self { file, strict, outside, errors, warnings, harmless, files, given }
    }

    /// The folder of this file, and the files that it may refer to.
    pub(crate) fn folder(&self) -> Folder {
        Folder::of(self.file, self.outside)
    }

    /// The scene file.
    pub(crate) fn file(&self) -> &'a Path {
        self.file
    }

    /// An error in this file at `place`.
    pub(crate) fn error(&self, kind: ErrorKind, place: &str, message: impl Into<String>) -> Error {
        let error = Error::new(kind, message).in_file(self.file);
        if place.is_empty() { error } else { error.at(place) }
    }

    /// Adds a warning with the text of `error`.
    pub(crate) fn warn(&self, error: &Error) {
        self.warnings.borrow_mut().add_error(error);
    }

    /// Adds a warning about the value at `place`.
    pub(crate) fn note(&self, place: &str, message: &str, remedy: &str) {
        self.warn(&self.error(ErrorKind::Scene, place, message).remedy(remedy));
    }

    /// Adds a note about what is left out at `place` without harm.
    pub(crate) fn leave_out(&self, place: &str, message: &str, remedy: &str) {
        let error = self.error(ErrorKind::Scene, place, message).remedy(remedy);
        self.harmless.borrow_mut().add_error(&error);
    }

    /// Adds warnings made elsewhere.
    pub(crate) fn pass_on(&self, warnings: Vec<Warning>) {
        self.warnings.borrow_mut().extend(warnings);
    }

    /// Adds a warning, or an error if strict.
    pub(crate) fn warn_or_fail(&self, error: Error) {
        if self.strict { self.fail(error) } else { self.warn(&error) }
    }

    /// Records an error, so that reading can continue. Repeated errors count once.
    pub(crate) fn fail(&self, error: Error) {
        if !self.given.borrow_mut().insert(hash(&error.to_string())) {
            return;
        }
        let mut errors = self.errors.borrow_mut();
        if errors.len() < MOST_ERRORS {
            errors.push(error);
        }
    }

    /// Reads a part of the file, and records its error. Further errors of a part are dropped: they
    /// may follow from the first.
    pub(crate) fn part<T>(&self, read: impl FnOnce() -> Result<T>) -> Result<T> {
        let before = self.given.borrow().len();
        read().inspect_err(|error| {
            if self.given.borrow().len() == before {
                self.fail(error.clone());
            }
        })
    }

    /// Reads the whole file: if there are errors, the result is all of them.
    pub(crate) fn whole<T>(&self, read: impl FnOnce() -> Result<T>) -> Result<T> {
        let result = self.part(read);
        let mut errors = self.errors.take().into_iter();
        match errors.next() {
            Some(first) => {
                let unlisted = self.given.borrow().len().saturating_sub(MOST_ERRORS);
                Err(first.followed_by(errors.collect(), unlisted))
            }
            None => result,
        }
    }

    /// A path in the scene file, joined to its folder.
    pub(crate) fn resolve(&self, path: &str) -> PathBuf {
        self.file.parent().unwrap_or(Path::new("")).join(path)
    }

    /// Records a file that is read, once.
    pub(crate) fn reads(&self, path: &Path) {
        let mut files = self.files.borrow_mut();
        if !files.iter().any(|known| known == path) {
            files.push(path.to_owned());
        }
    }

    /// All warnings, what is left out without harm, and files, in the order of their discovery.
    pub(crate) fn into_parts(self) -> (Vec<Warning>, Vec<Warning>, Vec<PathBuf>) {
        let Self { warnings, harmless, files, .. } = self;
        let [warnings, harmless] = [warnings, harmless].map(|all| all.into_inner().into_vec());
        (warnings, harmless, files.into_inner())
    }
}
