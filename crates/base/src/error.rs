//! Errors that the reader can fix: they name the file, the place in it, the value found there, and
//! the remedy.

mod warning;

use std::fmt::{self, Write};
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::io::ErrorKind as IoKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use warning::{Warning, Warnings};

/// A result that fails with an [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// The broad kind of an [`Error`], for callers that branch on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The operating system refused to read or write.
    Io,
    /// The text or the bytes do not follow their format (JSON, PLY, OBJ, ray file).
    Syntax,
    /// A well-formed value violates the scene format.
    Scene,
    /// A mesh refers to missing data, or data that is not finite.
    Mesh,
    /// A texture cannot be decoded.
    Texture,
    /// A request exceeds a limit.
    Limit,
    /// A command line requests something impossible.
    Usage,
    /// The number of the signal that ended the work early.
    Interrupted(u8),
}

/// An error that names the file, the place, the value and the remedy, as far as they are known.
///
/// It reads `FILE: PLACE: MESSAGE, found VALUE; REMEDY`. Several errors of a file are on separate
/// lines.
///
/// ```
/// use wavecrest_base::error::{Error, ErrorKind};
/// let error = Error::new(ErrorKind::Scene, "the radius of a sphere must be above 0")
///     .in_file("scene.json")
///     .at("scene.shapes[3].radius")
///     .value(-2.0)
///     .remedy("use a positive number, such as 1");
/// assert_eq!(
///     error.to_string(),
///     "scene.json: scene.shapes[3].radius: the radius of a sphere must be above 0, found -2; \
///      use a positive number, such as 1"
/// );
/// ```
#[derive(Clone, Debug)]
pub struct Error {
    // Boxed, so that results stay small on success.
    details: Box<Details>,
}

#[derive(Clone, Debug)]
struct Details {
    kind: ErrorKind,
    message: String,
    file: Option<PathBuf>,
    place: Option<String>,
    value: Option<String>,
    remedy: Option<String>,
    source: Option<Arc<dyn std::error::Error + Send + Sync>>,
    /// More errors of the same file.
    others: Vec<Error>,
    /// The number of further errors that are not listed.
    unlisted: usize,
}

impl Error {
    /// An error of `kind`; `message` says what is wrong, as the start of a sentence.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        let message = message.into();
        let details = Details {
            kind,
            message,
            file: None,
            place: None,
            value: None,
            remedy: None,
            source: None,
            others: Vec::new(),
            unlisted: 0,
        };
        Self { details: Box::new(details) }
    }

    /// This error, followed by `others` and by the number of unlisted errors.
    ///
    /// It reads as several lines, one for each error.
    #[must_use]
    pub fn followed_by(mut self, others: Vec<Error>, unlisted: usize) -> Self {
        (self.details.others, self.details.unlisted) = (others, unlisted);
        self
    }

    /// A failure of the operating system while `doing` something ("cannot open the file").
    pub fn io(doing: impl Into<String>, file: impl Into<PathBuf>, source: std::io::Error) -> Self {
        let (doing, file) = (doing.into(), file.into());
        let failed = |why: &str| Self::new(ErrorKind::Io, format!("{doing}: {why}"));
        let error = match source.kind() {
            IoKind::NotFound => failed("there is no such file").remedy(other_name(&file)),
            IoKind::IsADirectory => failed("it is a folder").remedy("name a file"),
            IoKind::NotSeekable => failed("it is not a regular file").remedy("name a regular file"),
            IoKind::PermissionDenied => failed("permission denied").remedy("check who owns it"),
            IoKind::StorageFull => failed("the disk is full").remedy("make room and try again"),
            _ => failed(&source.to_string()),
        };
        error.in_file(file).because(source)
    }

    /// Sets the file, unless it is set already.
    #[must_use]
    pub fn in_file(mut self, file: impl Into<PathBuf>) -> Self {
        self.details.file.get_or_insert_with(|| file.into());
        self
    }

    /// Sets the place in the file (a JSON path, a line, an element), unless it is set already.
    #[must_use]
    pub fn at(mut self, place: impl Into<String>) -> Self {
        self.details.place.get_or_insert_with(|| place.into());
        self
    }

    /// Sets the value found.
    #[must_use]
    pub fn value(mut self, value: impl fmt::Display) -> Self {
        self.details.value = Some(shorten(&value.to_string()));
        self
    }

    /// Sets the remedy.
    #[must_use]
    pub fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.details.remedy = Some(remedy.into());
        self
    }

    /// Sets the error that caused this one.
    #[must_use]
    pub fn because(mut self, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        self.details.source = Some(source.into().into());
        self
    }

    /// The broad kind.
    pub fn kind(&self) -> ErrorKind {
        self.details.kind
    }

    /// The file, if any.
    pub fn file(&self) -> Option<&Path> {
        self.details.file.as_deref()
    }

    /// The place in the file: a JSON path, a line, an element.
    pub fn place(&self) -> Option<&str> {
        self.details.place.as_deref()
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.details.source.as_deref().map(|source| source as _)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.fmt_first(&mut OneLine(f))?;
        self.details.others.iter().try_for_each(|other| write!(f, "\n{other}"))?;
        match self.details.unlisted {
            0 => Ok(()),
            1 => f.write_str("\n1 more error is not listed"),
            n => write!(f, "\n{n} more errors are not listed"),
        }
    }
}

impl Error {
    fn fmt_first(&self, f: &mut OneLine<'_, '_>) -> fmt::Result {
        let Details { file, place, .. } = &*self.details;
        if let Some(file) = file {
            write!(f, "{}: ", file.display())?;
        }
        if let Some(place) = place {
            write!(f, "{place}: ")?;
        }
        f.write_str(&self.message_with_value_and_remedy())
    }

    fn message_with_value_and_remedy(&self) -> String {
        let Details { message, value, remedy, .. } = &*self.details;
        let mut text = message.clone();
        if let Some(value) = value {
            text += &format!(", found {value}");
        }
        if let Some(remedy) = remedy {
            text += &format!("; {remedy}");
        }
        text
    }
}

/// A hash of a text.
pub fn hash(text: &str) -> u64 {
    BuildHasherDefault::<DefaultHasher>::default().hash_one(text)
}

/// The remedy for a missing file.
fn other_name(file: &Path) -> String {
    /// Largest number of file names to read in a folder.
    const MOST: usize = 10_000;
    let folder = file.parent().filter(|folder| *folder != Path::new(""));
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).into_iter().flatten();
    let names = entries.take(MOST).filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let names: Vec<String> = names.collect();
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    match did_you_mean(&name, names.iter().map(String::as_str)) {
        Some(near) => format!("did you mean {}?", file.with_file_name(near).display()),
        None => "check the path".to_owned(),
    }
}

/// A value for a message: at most 80 characters.
fn shorten(text: &str) -> String {
    const LIMIT: usize = 80;
    if text.chars().count() <= LIMIT {
        return text.to_owned();
    }
    text.chars().take(LIMIT - 3).chain("...".chars()).collect()
}

/// Writes control characters as spaces: text from a file must not move the terminal's cursor.
struct OneLine<'a, 'b>(&'a mut fmt::Formatter<'b>);

impl fmt::Write for OneLine<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.chars().try_for_each(|c| self.0.write_char(if c.is_control() { ' ' } else { c }))
    }
}

/// The candidate closest to a misspelt `word`, if one is close enough.
///
/// The distance is the Damerau-Levenshtein distance, which counts a swap of neighbours as one step;
/// up to a third of the letters may differ. Case does not count.
pub fn did_you_mean<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let lower = word.to_lowercase();
    candidates
        .into_iter()
        .map(|c| (strsim::damerau_levenshtein(&lower, &c.to_lowercase()), c))
        .filter(|(distance, c)| *distance <= (c.chars().count().max(3)) / 3)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, c)| c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_from_a_file_stays_on_one_line() {
        let error = Error::new(ErrorKind::Scene, "an unknown key")
            .at("scene.a\u{1b}[2J\nb")
            .value("x\ty".repeat(60));
        let text = error.to_string();
        assert!(text.starts_with("scene.a [2J b: an unknown key, found x yx y"), "{text}");
        assert!(text.ends_with("...") && !text.chars().any(char::is_control));
    }

    #[test]
    fn each_of_several_errors_has_its_line() {
        let error = |text: &str| Error::new(ErrorKind::Scene, text).in_file("a\nb");
        let all = error("one").followed_by(vec![error("two")], 0);
        assert_eq!(all.to_string(), "a b: one\na b: two");
        let all = error("one").followed_by(vec![error("two")], 1);
        assert_eq!(all.to_string(), "a b: one\na b: two\n1 more error is not listed");
        let all = error("one").followed_by(Vec::new(), 12);
        assert_eq!(all.to_string(), "a b: one\n12 more errors are not listed");
    }

    #[test]
    fn near_words_are_meant_and_far_ones_are_not() {
        let types = ["sphere", "plane", "triangle"];
        assert_eq!(did_you_mean("Shpere", types), Some("sphere"));
        assert_eq!(did_you_mean("box", types), None);
    }
}
