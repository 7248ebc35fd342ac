//! The keys of the scene format's objects: their values and meanings.
//!
//! There is one table for each component and each nested object, shared by the reader, the writer
//! and the JSON schema.

use hecs::{EntityBuilder, EntityRef};
use serde_json::{Map, Value};

use super::cursor::{COLOR, Cursor, POINT, Range, integer_words, quoted};
use super::writer::Writer;
use wavecrest_base::choice::Choice;
use wavecrest_base::error::Result;

/// A table of keys: above each its description, then its name or a constant with it, others for it,
/// its values, its default, and after an arrow the keys of which it needs one.
macro_rules! keys {
    ($(
        $(#[doc = $about:literal])+
        $($name:literal)? $($named:ident)? $(| $old:literal)*: $takes:expr $(, $absent:expr)?
            $(=> $need:literal $(| $or:literal)*)?;
    )*) => {{
        #[allow(unused_imports, reason = "tables use what they need")]
        use $crate::format::{word, Absent::*, Takes::*};
        &[$( $crate::format::Key {
            name: $($name)? $($named)?,
            synonyms: &[$($old),*],
            takes: $takes,
            absent: $crate::format::keys!(@ $($absent)?),
            needs: &[$($need $(, $or)*)?],
            about: concat!(
                $($about),+ $(, " Has no effect without `", $need, $("` or `", $or,)* "`.")?
            ).trim_ascii(),
        } ),*]
    }};
    (@) => { Open };
    (@ $absent:expr) => { $absent };
}
pub(crate) use keys;

/// A [`Declared`](super::Declared) component as a value.
#[derive(Clone, Copy)]
pub struct Declaration {
    /// Its keys.
    pub keys: &'static [Key],
    /// Adds the component of an object to its entity.
    pub(crate) read: fn(&Object<'_>, &mut EntityBuilder) -> Result<()>,
    /// Writes the component of an entity, if it has one.
    pub(crate) write: fn(EntityRef<'_>, &mut Writer<'_>),
    /// Adds a copy of the component of an entity, if it has one, to another.
    pub(crate) copy: fn(EntityRef<'_>, &mut EntityBuilder),
    /// Whether an entity has the component.
    pub(crate) is_in: fn(EntityRef<'_>) -> bool,
}

/// A JSON object, and the keys that its kind allows.
///
/// The keys are declared before any is read, so that a missing key can be matched with a misspelt
/// one.
pub(crate) struct Object<'a> {
    pub(super) cursor: Cursor<'a>,
    pub(super) map: &'a Map<String, Value>,
    pub(super) kind: Kind,
}

/// A kind of object.
#[derive(Clone, Copy)]
pub struct Kind {
    /// Its name in messages: "a sphere".
    pub name: &'static str,
    /// Its description, for editors.
    pub about: &'static str,
    /// The value of its key `type`; empty if it has no such key.
    pub word: &'static str,
    /// The key whose presence tells it from later kinds with the same word; empty if none does.
    pub(crate) discriminator: &'static str,
    /// Its keys, but for those of its components.
    pub keys: &'static [Key],
    /// The name of a key that objects of this kind do without; empty if there is none.
    pub(crate) without: &'static str,
    /// The components that its other keys become. The first tells that an entity is of this kind.
    pub(crate) components: &'static [Declaration],
    /// More components, which other kinds have too.
    pub(crate) more: &'static [&'static [Declaration]],
    /// Components whose keys are allowed but not looked at.
    pub(crate) unread: &'static [Declaration],
}

impl Kind {
    /// A kind with these keys.
    pub(crate) const fn new(name: &'static str, about: &'static str, keys: &'static [Key]) -> Self {
        let (word, discriminator, without, components): (_, _, _, &[Declaration]) =
            ("", "", "", &[]);
        Self { name, about, word, discriminator, keys, without, components, more: &[], unread: &[] }
    }

    /// A kind whose objects become entities with these components.
    pub(crate) const fn entity(
        word: &'static str,
        name: &'static str,
        about: &'static str,
        components: &'static [Declaration],
    ) -> Self {
        Self { word, components, ..Self::new(name, about, &[]) }
    }

    /// Its components.
    pub fn declarations(&self) -> impl Iterator<Item = &'static Declaration> + use<> {
        self.components.iter().chain(self.more.iter().copied().flatten())
    }

    /// The key with this name, or this other name.
    pub fn key(&self, name: &str) -> Option<Key> {
        self.all_keys().find(|key| key.name == name || key.synonyms.contains(&name))
    }

    /// Its keys and those of its components. Those that are allowed but not read take [`Takes::Anything`].
    pub fn all_keys(&self) -> impl Iterator<Item = Key> + use<> {
        let typed: &[Key] = if self.word.is_empty() { &[] } else { TYPE };
        let keys = typed.iter().chain(self.keys);
        let keys = keys.chain(self.declarations().flat_map(|component| component.keys));
        let unread = self.unread.iter().flat_map(|component| component.keys);
        let ignored = |key: &Key| Key { takes: Takes::Anything, absent: Absent::Open, ..*key };
        let without = self.without;
        keys.copied().chain(unread.map(ignored)).filter(move |key| key.name != without)
    }
}

/// The key of objects of several kinds.
pub(super) const TYPE: &[Key] = keys! {
    /// The kind of object.
    "type": Anything, Required;
};

/// Kinds of objects that their key `type` tells apart.
#[derive(Clone, Copy)]
pub struct Variants {
    /// What they are: "a light".
    pub name: &'static str,
    /// The same for editors.
    pub about: &'static str,
    /// The kinds.
    pub kinds: &'static [Kind],
}

impl Variants {
    /// The values of `type`, each once.
    pub(crate) fn words(&self) -> Vec<(&'static str, &'static str)> {
        let mut words: Vec<_> = self.kinds.iter().map(|kind| (kind.word, kind.word)).collect();
        words.dedup();
        words
    }
}

/// A key of an object.
#[derive(Clone, Copy)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// Other names for it.
    pub synonyms: &'static [&'static str],
    /// Its values.
    pub takes: Takes,
    /// The default.
    pub absent: Absent,
    /// Other keys: without any of them it has no effect.
    pub needs: &'static [&'static str],
    /// Its description, for editors.
    pub about: &'static str,
}

impl Key {
    /// Its name, and others for it.
    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> + use<> {
        [self.name].into_iter().chain(self.synonyms.iter().copied())
    }

    /// Whether it is set in an object, but none of the keys that it needs. 0 and false are as good
    /// as nothing.
    pub(super) fn is_idle(&self, object: &Map<String, Value>) -> bool {
        let is_set = |name: &&str| {
            object.get(*name).is_some_and(|value| *value != false && value.as_f64() != Some(0.0))
        };
        !self.needs.is_empty() && is_set(&self.name) && !self.needs.iter().any(is_set)
    }
}

/// The values of a key.
#[derive(Clone, Copy)]
pub enum Takes {
    /// Any value.
    Anything,
    /// A text.
    Text,
    /// True or false.
    Truth,
    /// A number in a range.
    Number(Range),
    /// An integer from the first to the second.
    Integer(u32, u32),
    /// One of a few numbers.
    OneOf(&'static [i32]),
    /// Three numbers.
    Point,
    /// A point other than 0, such as this.
    Direction(&'static str),
    /// Three numbers that are not negative.
    Color,
    /// One of a few words.
    Choice(fn() -> Vec<&'static str>),
    /// An object of a kind.
    Object(&'static Kind),
    /// An object of one of a few kinds.
    Variants(&'static Variants),
    /// The first for a list, or for an object if it is one; the second for anything else.
    Either(&'static Takes, &'static Takes),
    /// A matrix of four rows, the last of them [0, 0, 0, 1].
    Matrix,
    /// A list of at least this many.
    AtLeast(usize, &'static Takes),
    /// A list of exactly this many.
    Exactly(usize, &'static Takes),
}

impl Takes {
    /// The values in words.
    pub(super) fn words(self) -> String {
        match self {
            Self::Truth => "true or false".to_owned(),
            Self::Number(range) => range.words(),
            Self::Integer(low, high) => integer_words(low, high),
            Self::Point | Self::Direction(_) => POINT.to_owned(),
            Self::Color => COLOR.to_owned(),
            Self::Choice(words) => quoted(words()),
            _ => "a value".to_owned(),
        }
    }
}

/// The default of a key.
#[derive(Clone, Copy, PartialEq)]
pub enum Absent {
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

impl Absent {
    /// The default as a value of the key, if it has one.
    pub(super) fn value(self) -> Option<Value> {
        match self {
            Self::Open | Self::Required => None,
            Self::Off => Some(false.into()),
            Self::Is(x) => Some(plain(x)),
            Self::Are(three) => Some(three.map(plain).to_vec().into()),
            Self::Says(word) => Some(word.into()),
        }
    }
}

/// The number, an integer without a decimal point.
pub(super) fn plain(x: f64) -> Value {
    // No number of a table is beyond 2^53.
    if x.fract() == 0.0 { Value::from(x as i64) } else { x.into() }
}

/// One of the words of `T`.
pub(crate) const fn word<T: Choice>() -> Takes {
    Takes::Choice(words::<T>)
}

fn words<T: Choice>() -> Vec<&'static str> {
    T::VALUES.iter().map(|value| value.name()).collect()
}
