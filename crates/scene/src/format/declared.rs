//! Components that are declared once: with their fields' keys, values, defaults and descriptions.
//!
//! From a declaration come the reader of scene files, the writer and the JSON schema. An object of
//! a scene file is a list of declarations ([`Kind`](super::Kind)), and becomes one entity.

use glam::DVec3;
use hecs::{Component, EntityBuilder, EntityRef};
use serde_json::Value;

use super::cursor::{COLOR, Cursor, POINT, Range, integer_words, words_of};
use super::keys::{Absent, Key, Takes};
use super::object::Object;
use super::writer::Writer;
use wavecrest_base::choice::Choice;
use wavecrest_base::error::Result;

/// A component with keys of its own in a scene file.
pub(crate) trait Declared: Component + Clone {
    /// Its keys.
    const KEYS: &'static [Key];

    /// Reads it from an object with these keys; `None` if the object does without.
    fn read(object: &Object<'_>) -> Result<Option<Self>>;

    /// Writes it to an object with these keys.
    fn write(&self, to: &mut Writer<'_>);
}

/// A [`Declared`] component as a value.
#[derive(Clone, Copy)]
pub(crate) struct Declaration {
    pub(crate) keys: &'static [Key],
    /// Adds the component of an object to its entity.
    pub(crate) read: fn(&Object<'_>, &mut EntityBuilder) -> Result<()>,
    /// Writes the component of an entity, if it has one.
    pub(crate) write: fn(EntityRef<'_>, &mut Writer<'_>),
    /// Adds a copy of the component of an entity, if it has one, to another.
    pub(crate) copy: fn(EntityRef<'_>, &mut EntityBuilder),
    /// Whether an entity has the component.
    pub(crate) is_in: fn(EntityRef<'_>) -> bool,
}

impl Declaration {
    /// The declaration of `C`.
    pub(crate) const fn of<C: Declared>() -> Self {
        let (read, write, copy) = (read::<C>, write::<C>, copy::<C>);
        Self { keys: C::KEYS, read, write, copy, is_in: |entity| entity.has::<C>() }
    }

    /// Keys that become no component of their own: several read them.
    pub(crate) const fn of_keys(keys: &'static [Key]) -> Self {
        let is_in: fn(EntityRef<'_>) -> bool = |_| true;
        Self { keys, read: |_, _| Ok(()), write: |_, _| {}, copy: |_, _| {}, is_in }
    }

    /// The keys of `C`, which are checked, in objects whose entity does without it.
    pub(crate) const fn checked<C: Declared>() -> Self {
        Self { read: |object, _| C::read(object).map(drop), ..Self::of_keys(C::KEYS) }
    }
}

fn read<C: Declared>(object: &Object<'_>, entity: &mut EntityBuilder) -> Result<()> {
    if let Some(component) = C::read(object)? {
        entity.add(component);
    }
    Ok(())
}

fn write<C: Declared>(entity: EntityRef<'_>, to: &mut Writer<'_>) {
    entity.get::<&C>().into_iter().for_each(|component| component.write(to));
}

fn copy<C: Declared>(from: EntityRef<'_>, to: &mut EntityBuilder) {
    from.get::<&C>().into_iter().for_each(|component| _ = to.add(C::clone(&component)));
}

/// A value of a key.
pub(crate) trait Field: Copy {
    /// The value of a `key`, or `usual`, or the key's own default. An error is recorded, and reading
    /// continues with some value.
    fn read(object: &Object<'_>, key: &Key, usual: Option<Self>) -> Self;

    /// The value as it is written; null if it is not.
    fn to_json(self) -> Value;
}

impl Field for f64 {
    fn read(object: &Object<'_>, key: &Key, usual: Option<Self>) -> Self {
        let range = match key.takes {
            Takes::Number(range) => range,
            _ => Range::COORDINATE,
        };
        let own = match key.absent {
            Absent::Is(x) => Some(x),
            _ => None,
        };
        object.value(key, || range.words(), usual.or(own), 1.0, |cursor| cursor.number(range))
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for u32 {
    fn read(object: &Object<'_>, key: &Key, usual: Option<Self>) -> Self {
        let (low, high) = match key.takes {
            Takes::Integer(low, high) => (low, high),
            _ => (0, u32::MAX),
        };
        let own = match key.absent {
            // Tables contain only integers in range.
            Absent::Is(x) => Some(x as u32),
            _ => None,
        };
        let what = || integer_words(low, high);
        object.value(key, what, usual.or(own), low, |cursor| cursor.integer(low, high))
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for bool {
    fn read(object: &Object<'_>, key: &Key, usual: Option<Self>) -> Self {
        let what = || "true or false".to_owned();
        object.value(key, what, usual.or(Some(false)), false, |cursor| cursor.truth())
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for DVec3 {
    fn read(object: &Object<'_>, key: &Key, usual: Option<Self>) -> Self {
        let own = match key.absent {
            Absent::Are(three) => Some(three.into()),
            _ => None,
        };
        let what = if matches!(key.takes, Takes::Color) { COLOR } else { POINT };
        let read = |cursor: &Cursor<'_>| match key.takes {
            Takes::Color => cursor.color(),
            Takes::Direction(such_as) => cursor.direction(such_as),
            _ => cursor.point(),
        };
        object.value(key, || what.to_owned(), usual.or(own), Self::ONE, read)
    }

    fn to_json(self) -> Value {
        self.to_array().to_vec().into()
    }
}

impl<T: Field> Field for Option<T> {
    fn read(object: &Object<'_>, key: &Key, usual: Option<Self>) -> Self {
        let usual = usual.flatten();
        (usual.is_some() || object.has(key.name)).then(|| T::read(object, key, usual))
    }

    fn to_json(self) -> Value {
        self.map_or(Value::Null, T::to_json)
    }
}

/// Reads a word of `T`, as [`Field::read`] does.
pub(crate) fn read_word<T: Choice>(object: &Object<'_>, key: &Key, usual: Option<T>) -> T {
    let own = match key.absent {
        Absent::Says(word) => T::VALUES.iter().copied().find(|value| value.name() == word),
        _ => None,
    };
    let options =
        || -> Vec<(&str, T)> { T::VALUES.iter().map(|value| (value.name(), *value)).collect() };
    let read = |cursor: &Cursor<'_>| cursor.choice(&options());
    object.value(key, || words_of(&options()), usual.or(own), T::VALUES[0], read)
}

/// Makes values of keys of enumerations.
macro_rules! words {
    ($($kind:ty),+ $(,)?) => { $(
        impl $crate::format::Field for $kind {
            fn read(
                object: &$crate::format::Object<'_>,
                key: &$crate::format::Key,
                usual: Option<Self>,
            ) -> Self {
                $crate::format::read_word(object, key, usual)
            }

            fn to_json(self) -> serde_json::Value {
                self.name().into()
            }
        }
    )+ };
}
pub(crate) use words;

/// Declares a component: above each field its description, then its key, its values, its default,
/// and the keys that it needs.
macro_rules! component {
    (
        $(#[$attribute:meta])*
        pub struct $Name:ident {
            $(
                $(#[doc = $about:literal])+
                pub $field:ident: $type:ty =
                    $key:literal $(| $old:literal)*: $takes:expr $(, $absent:expr)?
                    $(=> $($need:literal)|+)?;
            )+
        }
    ) => {
        $(#[$attribute])*
        pub struct $Name {
            $( $(#[doc = $about])+ pub $field: $type, )+
        }

        impl $Name {
            pub(crate) const FIELDS: &'static [$crate::format::Key] = $crate::format::keys! {
                $( $(#[doc = $about])+ $key $(| $old)*: $takes $(, $absent)? $(=> $($need)|+)?; )+
            };

            /// Reads the fields; those left out are those of `usual`, or the keys' own defaults.
            pub(crate) fn fields(
                object: &$crate::format::Object<'_>,
                usual: Option<&Self>,
            ) -> Self {
                Self {
                    $( $field: object.read_or($key, usual.map(|usual| usual.$field)), )+
                }
            }

            /// Writes the fields.
            pub(crate) fn write_fields(&self, to: &mut $crate::format::Writer<'_>) {
                $( to.put($key, self.$field); )+
            }
        }
    };
}
pub(crate) use component;

/// Makes a component [`Declared`] that every object with its keys has; `check` is the name of a
/// function that checks the fields together, warns of them and may change them.
macro_rules! declared {
    ($Name:ident $(, $check:expr)?) => {
        impl $crate::format::Declared for $Name {
            const KEYS: &'static [$crate::format::Key] = Self::FIELDS;

            fn read(
                object: &$crate::format::Object<'_>,
            ) -> wavecrest_base::error::Result<Option<Self>> {
                #[allow(unused_mut, reason = "some have no check")]
                let mut component = Self::fields(object, None);
                $( $check(&mut component, object)?; )?
                Ok(Some(component))
            }

            fn write(&self, to: &mut $crate::format::Writer<'_>) {
                self.write_fields(to);
            }
        }
    };
}
pub(crate) use declared;
