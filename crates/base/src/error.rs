//! What can go wrong, said so that the reader can mend it: the file, the place in it, the value
//! found there, and what would be right.

use std::fmt::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A result whose failure is an [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// The broad kind of an [`Error`]: what a caller may want to branch on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The operating system refused to read or write.
    Io,
    /// The text or the bytes do not follow their format (JSON, PLY, OBJ, ray file).
    Syntax,
    /// A well-formed value is not one that the scene format allows.
    Scene,
    /// A mesh names data that it does not have, or that is not finite.
    Mesh,
    /// A texture cannot be decoded.
    Texture,
    /// Something asked for is larger than is allowed.
    Limit,
    /// A command line asks for what cannot be done.
    Usage,
    /// A signal ended the work before its time: its number.
    Interrupted(u8),
}

/// An error that names the file, the place, the value and the remedy, as far as each is known.
///
/// It reads `FILE: PLACE: MESSAGE, found VALUE; REMEDY`.
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
    // Boxed, so that a result is small where all goes well.
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
}

impl Error {
    /// An error of `kind` whose `message` says what is wrong, as the start of a sentence.
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
        };
        Self { details: Box::new(details) }
    }

    /// A failure of the operating system while it was `doing` something ("cannot open the file").
    pub fn io(doing: impl Into<String>, file: impl Into<PathBuf>, source: std::io::Error) -> Self {
        let message = format!("{}: {}", doing.into(), source);
        Self::new(ErrorKind::Io, message).in_file(file).because(source)
    }

    /// Names the file, unless one is named already.
    #[must_use]
    pub fn in_file(mut self, file: impl Into<PathBuf>) -> Self {
        self.details.file.get_or_insert_with(|| file.into());
        self
    }

    /// Names the place in the file (a JSON path, a line, an element), unless one is named already.
    #[must_use]
    pub fn at(mut self, place: impl Into<String>) -> Self {
        self.details.place.get_or_insert_with(|| place.into());
        self
    }

    /// Shows the value that was found.
    #[must_use]
    pub fn value(mut self, value: impl fmt::Display) -> Self {
        self.details.value = Some(shorten(&value.to_string()));
        self
    }

    /// Says what would be right.
    #[must_use]
    pub fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.details.remedy = Some(remedy.into());
        self
    }

    /// Keeps the error that caused this one.
    #[must_use]
    pub fn because(mut self, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        self.details.source = Some(source.into().into());
        self
    }

    /// The broad kind.
    pub fn kind(&self) -> ErrorKind {
        self.details.kind
    }

    /// The file concerned, if one is.
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
        let Details { message, file, place, value, remedy, .. } = &*self.details;
        let f = &mut OneLine(f);
        if let Some(file) = file {
            write!(f, "{}: ", file.display())?;
        }
        if let Some(place) = place {
            write!(f, "{place}: ")?;
        }
        f.write_str(message)?;
        if let Some(value) = value {
            write!(f, ", found {value}")?;
        }
        if let Some(remedy) = remedy {
            write!(f, "; {remedy}")?;
        }
        Ok(())
    }
}

/// Something that does not stop the work but that the user should know: it reads like an [`Error`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    text: String,
}

impl Warning {
    /// The warning that reads as `error` does.
    pub fn from_error(error: &Error) -> Self {
        Self { text: error.to_string() }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// A value as shown in a message: at most 80 characters.
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

/// The candidate nearest to a misspelt `word`, if one is near enough to be meant.
///
/// Nearness is the Damerau-Levenshtein distance, which counts a swap of neighbours as one step;
/// a third of the letters may differ. Case does not count.
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
    fn near_words_are_meant_and_far_ones_are_not() {
        let types = ["sphere", "plane", "triangle"];
        assert_eq!(did_you_mean("Shpere", types), Some("sphere"));
        assert_eq!(did_you_mean("box", types), None);
    }
}
