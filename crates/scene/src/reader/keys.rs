//! The keys of the scene format's objects: their values and meanings.
//!
//! There is one table for each kind of object, shared by the parser and the JSON schema.

use super::cursor::Range;
use wavecrest_base::choice::Choice;

/// A kind of object.
#[derive(Clone, Copy)]
pub(crate) struct Kind {
    /// Its name in messages: "a sphere".
    pub(crate) name: &'static str,
    /// Its description, for editors.
    pub(crate) about: &'static str,
    /// Its keys, which it may share with other kinds.
    pub(crate) keys: &'static [&'static [Key]],
    /// More keys.
    pub(crate) more: &'static [&'static [Key]],
    /// Synonymous keys, of which one is required.
    pub(crate) one_of: &'static [&'static [&'static str]],
}

impl Kind {
    /// A kind with these keys.
    pub(crate) const fn new(
        name: &'static str,
        about: &'static str,
        keys: &'static [&'static [Key]],
    ) -> Self {
        Self { name, about, keys, more: &[], one_of: &[] }
    }

    /// All keys.
    pub(crate) fn all_keys(&self) -> impl Iterator<Item = &'static Key> + use<> {
        self.keys.iter().chain(self.more).copied().flatten()
    }
}

/// A key.
#[derive(Clone, Copy)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) takes: Takes,
    /// The default.
    pub(crate) absent: Absent,
    /// Its description, for editors.
    pub(crate) about: &'static str,
}

/// The values of a key.
#[derive(Clone, Copy)]
pub(crate) enum Takes {
    Anything,
    Text,
    Truth,
    Number(Range),
    /// An integer from the first to the second.
    Integer(u32, u32),
    /// One of a few numbers.
    OneOf(&'static [i32]),
    Point,
    Color,
    NumberOrPoint,
    /// A point, or one of a few numbers.
    PointOr(&'static [i32]),
    /// One of a few words.
    Choice(fn() -> Vec<&'static str>),
    /// The values of a definition of the schema.
    Definition(&'static str),
    /// An object of a kind without a definition.
    Nested(&'static Kind),
    /// A list of at least this many.
    AtLeast(usize, &'static Takes),
    /// A list of exactly this many.
    Exactly(usize, &'static Takes),
}

/// The default of a key.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Absent {
    /// It depends on other keys, or there is none.
    Open,
    /// The key is required.
    Required,
    /// It is false.
    Off,
    /// This number.
    Is(f64),
    /// This point or colour.
    Are([f64; 3]),
    /// This word.
    Says(&'static str),
}

/// One of the words of `T`.
pub(crate) const fn word<T: Choice>() -> Takes {
    Takes::Choice(words::<T>)
}

fn words<T: Choice>() -> Vec<&'static str> {
    T::VALUES.iter().map(|value| value.name()).collect()
}

/// A table of keys: above each its description, then its name, its values, and its default.
macro_rules! keys {
    ($( $(#[doc = $about:literal])+ $name:literal: $takes:expr $(, $absent:expr)?; )*) => {{
        #[allow(unused_imports, reason = "tables use what they need")]
        use $crate::reader::{word, Absent::*, Takes::*};
        &[$( $crate::reader::Key {
            name: $name,
            takes: $takes,
            absent: $crate::reader::keys!(@ $($absent)?),
            about: concat!($($about),+).trim_ascii(),
        } ),*]
    }};
    (@) => { Open };
    (@ $absent:expr) => { $absent };
}
pub(crate) use keys;
