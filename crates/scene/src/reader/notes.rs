//! What is said of a file while it is read.

use std::cell::RefCell;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use wavecrest_base::error::{Error, ErrorKind, Result, Warning};

/// What the cursors of one file share: its name, how strict we are, the warnings so far.
pub(crate) struct Notes<'a> {
    file: &'a Path,
    strict: bool,
    /// Whether files outside the folder of the file that names them are read.
    outside: bool,
    warnings: RefCell<Vec<Warning>>,
    /// Files that were read besides.
    files: RefCell<Vec<PathBuf>>,
    /// The messages of warnings that are given once.
    given: RefCell<HashSet<String>>,
}

impl<'a> Notes<'a> {
    /// No warnings yet. If `strict`, an unknown key is an error.
    pub(crate) fn new(file: &'a Path, strict: bool) -> Self {
        let (warnings, files, given) = Default::default();
        Self { file, strict, outside: false, warnings, files, given }
    }

    /// Has files be read that are outside the folder of the file that names them.
    pub(crate) fn reading_outside(self, outside: bool) -> Self {
        Self { outside, ..self }
    }

    /// Whether files outside the folder of the file that names them are read.
    pub(crate) fn reads_outside(&self) -> bool {
        self.outside
    }

    /// The scene file.
    pub(crate) fn file(&self) -> &'a Path {
        self.file
    }

    /// An error in this file at `place`.
    pub(crate) fn error(&self, kind: ErrorKind, place: &str, message: String) -> Error {
        let error = Error::new(kind, message).in_file(self.file);
        if place.is_empty() { error } else { error.at(place) }
    }

    /// Keeps a warning that reads as `error` does.
    pub(crate) fn warn(&self, error: &Error) {
        self.pass_on(Warning::from_error(error));
    }

    /// Warns of what was found at `place`, the first time only: of a thousand materials with normal maps, one is
    /// reported.
    pub(crate) fn once(&self, place: &str, message: &str, remedy: &str) {
        if self.given.borrow_mut().insert(message.to_owned()) {
            self.warn(&self.error(ErrorKind::Scene, place, message.to_owned()).remedy(remedy));
        }
    }

    /// Keeps a warning that reads as `error` does, unless there has been one of the same words.
    pub(crate) fn warn_once(&self, error: &Error) {
        if self.given.borrow_mut().insert(error.to_string()) {
            self.warn(error);
        }
    }

    /// Keeps a warning made elsewhere.
    pub(crate) fn pass_on(&self, warning: Warning) {
        self.warnings.borrow_mut().push(warning);
    }

    /// A warning; an error where we are strict.
    pub(crate) fn warn_or_fail(&self, error: Error) -> Result<()> {
        if self.strict {
            return Err(error);
        }
        self.warn(&error);
        Ok(())
    }

    /// Whether unknown keys are errors.
    pub(crate) fn strict(&self) -> bool {
        self.strict
    }

    /// A path of the scene file, joined to the folder that it is in.
    pub(crate) fn resolve(&self, path: &str) -> PathBuf {
        self.file.parent().unwrap_or(Path::new("")).join(path)
    }

    /// Keeps the name of a file that is read, the first time.
    pub(crate) fn reads(&self, path: &Path) {
        let mut files = self.files.borrow_mut();
        if !files.iter().any(|known| known == path) {
            files.push(path.to_owned());
        }
    }

    /// All warnings and files, in the order in which they were found.
    pub(crate) fn into_parts(self) -> (Vec<Warning>, Vec<PathBuf>) {
        (self.warnings.into_inner(), self.files.into_inner())
    }
}
