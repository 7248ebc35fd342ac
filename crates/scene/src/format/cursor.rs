//! A JSON value with its path, and the checks that convert it to numbers, points, words and lists.

use std::fmt;
use std::ops::RangeBounds;

use glam::DVec3;
use serde_json::Value;

use super::notes::Notes;
use super::related::related;
use wavecrest_base::error::{Error, ErrorKind, Result, did_you_mean};
use wavecrest_core::math::float::MAX_COORDINATE;

/// The largest number in the format, 2^40. The product of three such numbers still fits single
/// precision, so that no colour and no determinant overflows.
const LARGEST: f64 = MAX_COORDINATE as f64;

/// The range of a key's numbers.
#[derive(Clone, Copy, PartialEq)]
pub struct Range {
    /// The least.
    pub low: f64,
    /// The greatest.
    pub high: f64,
    /// Whether `low` itself is excluded.
    pub open: bool,
}

impl Range {
    /// Any number: a coordinate.
    pub const COORDINATE: Self = Self::new(-LARGEST, LARGEST);
    /// 0 or more: a weight, a colour.
    pub(crate) const NOT_NEGATIVE: Self = Self::at_least(0.0);
    /// A share.
    pub(crate) const UNIT: Self = Self::new(0.0, 1.0);
    /// Above 0: a length.
    pub(crate) const POSITIVE: Self = Self { open: true, ..Self::NOT_NEGATIVE };

    /// From `low` to `high`, both included.
    pub(crate) const fn new(low: f64, high: f64) -> Self {
        Self { low, high, open: false }
    }

    /// `low` or more.
    pub(crate) const fn at_least(low: f64) -> Self {
        Self::new(low, LARGEST)
    }

    /// Whether a number is in the range.
    pub(crate) fn contains(self, x: f64) -> bool {
        (if self.open { x > self.low } else { x >= self.low }) && x <= self.high
    }

    /// The range in words.
    pub fn words(self) -> String {
        let Self { low, high, open } = self;
        let [low, high] = [low, high].map(|bound| match bound {
            LARGEST => "2^40".to_owned(),
            bound if bound == -LARGEST => "-2^40".to_owned(),
            bound => bound.to_string(),
        });
        let from = if open { "above" } else { "from" };
        let to = if open { "and at most" } else { "to" };
        format!("a number {from} {low} {to} {high}")
    }
}

/// A JSON path: it reads `scene.shapes[3].radius`, and nothing at the top.
#[derive(Clone, Copy)]
pub(crate) enum Place<'a> {
    /// The whole file.
    Top,
    /// Under a key of an object.
    Key(&'a Place<'a>, &'a str),
    /// An element of an array.
    Index(&'a Place<'a>, usize),
}

impl fmt::Display for Place<'_> {
    // As deep as the JSON, which serde_json limits to 128.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Top => Ok(()),
            Self::Key(Self::Top, key) => f.write_str(key),
            Self::Key(parent, key) => write!(f, "{parent}.{key}"),
            Self::Index(parent, index) => write!(f, "{parent}[{index}]"),
        }
    }
}

/// A JSON value that knows its place.
#[derive(Clone, Copy)]
pub(crate) struct Cursor<'a> {
    pub(super) value: &'a Value,
    place: Place<'a>,
    notes: &'a Notes<'a>,
}

impl<'a> Cursor<'a> {
    /// The `value` at `place`.
    pub(crate) fn new(value: &'a Value, place: Place<'a>, notes: &'a Notes<'a>) -> Self {
        Self { value, place, notes }
    }

    /// The value itself.
    pub(crate) fn value(&self) -> &'a Value {
        self.value
    }

    /// The notes shared by the file's cursors.
    pub(crate) fn notes(&self) -> &'a Notes<'a> {
        self.notes
    }

    /// The JSON path.
    pub(crate) fn path(&self) -> String {
        self.place.to_string()
    }

    /// The value of a `key`; null if it is not there.
    pub(crate) fn under<'s>(&'s self, key: &'s str) -> Cursor<'s> {
        let value = self.value.get(key).unwrap_or(&Value::Null);
        Cursor::new(value, Place::Key(&self.place, key), self.notes)
    }

    /// An error about this place, without the value.
    pub(crate) fn error_here(&self, message: impl Into<String>) -> Error {
        self.notes.error(ErrorKind::Scene, &self.path(), message)
    }

    /// An error about this value, including the value.
    pub(crate) fn error(&self, message: impl Into<String>) -> Error {
        self.error_of(ErrorKind::Scene, message)
    }

    /// An error of a given kind about this value, including the value.
    pub(crate) fn error_of(&self, kind: ErrorKind, message: impl Into<String>) -> Error {
        self.notes.error(kind, &self.path(), message).value(brief(self.value))
    }

    /// Adds a warning about this value, including the value.
    pub(crate) fn warn(&self, message: impl Into<String>, remedy: &str) {
        self.notes.warn(&self.error(message).remedy(remedy));
    }

    pub(super) fn must_be(&self, what: &str) -> Error {
        self.error(format!("must be {what}"))
    }

    /// A finite number in `range`.
    pub(crate) fn number(&self, range: Range) -> Result<f64> {
        let number = self.value.as_f64().filter(|x| range.contains(*x));
        number.ok_or_else(|| {
            let error = self.must_be(&range.words());
            match self.value {
                Value::Array(_) if matches!(self.place, Place::Key(_, "intensity")) => {
                    error.remedy("give one number, and the list as \"color\"")
                }
                Value::Array(_) => error.remedy("give one number, not a list"),
                Value::String(text) if text.parse::<f64>().is_ok() => {
                    error.remedy("remove the quotes")
                }
                _ => error,
            }
        })
    }

    /// An integer from `low` to `high`; `8.0` counts as one. One that is too large is over a limit.
    pub(crate) fn integer(&self, low: u32, high: u32) -> Result<u32> {
        let number = self.value.as_f64().filter(|x| x.fract() == 0.0);
        if let Some(x) = number.filter(|x| (low.into()..=high.into()).contains(x)) {
            // Exact: it is an integer in the range of u32.
            return Ok(x as u32);
        }
        let too_large = number.is_some_and(|x| x > high.into());
        let kind = if too_large { ErrorKind::Limit } else { ErrorKind::Scene };
        Err(self.error_of(kind, format!("must be {}", integer_words(low, high))))
    }

    pub(crate) fn truth(&self) -> Result<bool> {
        self.value.as_bool().ok_or_else(|| self.must_be("true or false"))
    }

    /// A list of exactly `N` numbers in `range`; `what` describes it.
    pub(crate) fn numbers<const N: usize>(&self, what: &str, range: Range) -> Result<[f64; N]> {
        let items = self.array(what)?;
        if items.len() != N {
            return Err(self.must_be(what));
        }
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(self.items(items)) {
            *number = item.number(range)?;
        }
        Ok(numbers)
    }

    /// A point or a direction.
    pub(crate) fn point(&self) -> Result<DVec3> {
        self.numbers(POINT, Range::COORDINATE).map(DVec3::from_array)
    }

    /// A direction, of any length but 0, such as `such_as`.
    pub(super) fn direction(&self, such_as: &str) -> Result<DVec3> {
        let direction = self.point()?;
        if direction == DVec3::ZERO {
            let error = self.error("must not be zero");
            return Err(error.remedy(format!("use a vector such as {such_as}")));
        }
        Ok(direction)
    }

    /// A colour: no channel is negative.
    pub(crate) fn color(&self) -> Result<DVec3> {
        self.numbers(COLOR, Range::NOT_NEGATIVE).map(DVec3::from_array)
    }

    /// A list; `what` describes it.
    pub(crate) fn array(&self, what: &str) -> Result<&'a [Value]> {
        self.value.as_array().map(Vec::as_slice).ok_or_else(|| self.must_be(what))
    }

    /// Cursors to the elements of this list.
    pub(crate) fn items<'s>(&'s self, items: &'s [Value]) -> impl Iterator<Item = Cursor<'s>> {
        let step = |(i, value)| Cursor::new(value, Place::Index(&self.place, i), self.notes);
        items.iter().enumerate().map(step)
    }

    /// A list read element by element; `what` describes it.
    pub(crate) fn each<T>(
        &self,
        what: &str,
        read: impl FnMut(Cursor<'_>) -> Result<T>,
    ) -> Result<Vec<T>> {
        self.items(self.array(what)?).map(read).collect()
    }

    /// As [`Cursor::each`], of one of some numbers of elements.
    pub(crate) fn each_of<T>(
        &self,
        counts: impl RangeBounds<usize>,
        what: &str,
        read: impl FnMut(Cursor<'_>) -> Result<T>,
    ) -> Result<Vec<T>> {
        let all = self.each(what, read)?;
        if counts.contains(&all.len()) { Ok(all) } else { Err(self.must_be(what)) }
    }

    /// As [`Cursor::each`], of exactly `N` elements.
    pub(crate) fn exactly<const N: usize, T>(
        &self,
        what: &str,
        read: impl FnMut(Cursor<'_>) -> Result<T>,
    ) -> Result<[T; N]> {
        self.each(what, read)?.try_into().map_err(|_| self.must_be(what))
    }

    /// As [`Cursor::each`], to the end of the list: every element's error is recorded, and one is returned.
    pub(crate) fn every<T>(
        &self,
        what: &str,
        mut read: impl FnMut(Cursor<'_>) -> Result<T>,
    ) -> Result<Vec<T>> {
        let items = self.items(self.array(what)?);
        let parts: Vec<Result<T>> = items.map(|item| self.notes.part(|| read(item))).collect();
        parts.into_iter().collect()
    }

    /// A nonempty text; `what` describes it.
    pub(crate) fn text(&self, what: &str) -> Result<&'a str> {
        self.value.as_str().filter(|s| !s.is_empty()).ok_or_else(|| self.must_be(what))
    }

    /// One of a few words, in exactly this spelling.
    pub(crate) fn choice<T: Copy>(&self, options: &[(&'static str, T)]) -> Result<T> {
        let word = self.value.as_str().unwrap_or_default();
        if let Some((_, meaning)) = options.iter().find(|(name, _)| *name == word) {
            return Ok(*meaning);
        }
        let names = || options.iter().map(|(name, _)| *name);
        let error = self.must_be(&quoted(names()));
        let related = related(word).filter(|own| names().any(|name| name == *own));
        Err(match related.or_else(|| did_you_mean(word, names())) {
            Some(meant) => error.remedy(format!("did you mean {meant:?}?")),
            None => error,
        })
    }
}

/// The description of a point.
pub(crate) const POINT: &str = "three numbers [x, y, z]";

/// The description of a colour.
pub(crate) const COLOR: &str = "three numbers [r, g, b]";

/// The integers from `low` to `high` in words.
pub(crate) fn integer_words(low: u32, high: u32) -> String {
    format!("an integer from {low} to {high}")
}

/// The words that a choice takes: `"a", "b" or "c"`.
pub(super) fn quoted(words: impl IntoIterator<Item = &'static str>) -> String {
    let quoted: Vec<String> = words.into_iter().map(|word| format!("{word:?}")).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}

/// The start of a value as JSON. Messages show 80 characters, so writing out a whole mesh would be
/// a waste.
fn brief(value: &Value) -> String {
    const ENOUGH: usize = 400;
    let mut start = [0; ENOUGH];
    let mut room = &mut start[..];
    // The writer fails where it is full; that is not an error.
    let _ = serde_json::to_writer(&mut room, value);
    let left = room.len();
    String::from_utf8_lossy(&start[..start.len() - left]).into_owned()
}
