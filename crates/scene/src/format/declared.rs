//! Components that are declared once: with their fields' keys, values, defaults and descriptions.
//!
//! From a declaration come the reader of scene files, the writer and the JSON schema. An object of
//! a scene file is a list of declarations ([`Kind`](super::Kind)), and becomes one entity.

use glam::DVec3;
use hecs::{Component, EntityBuilder, EntityRef};
use serde_json::Value;

use super::cursor::{COLOR, POINT, integer_words, words_of};
use super::keys::{Absent, Key, Takes};
use super::object::{Object, options};
use crate::format::Writer;
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
        Self { keys: C::KEYS, read, write, copy, is_in: is_in::<C> }
    }

    /// Keys that several components read.
    pub(crate) const fn without(keys: &'static [Key]) -> Self {
        let (read, write, copy): Functions = (|_, _| Ok(()), |_, _| {}, |_, _| {});
        Self { keys, read, write, copy, is_in: |_| true }
    }

    /// The same for objects whose entity does without `C`: its keys are only checked.
    pub(crate) const fn checked<C: Declared>() -> Self {
        Self { read: |object, _| C::read(object).map(drop), ..Self::without(C::KEYS) }
    }
}

type Functions = (
    fn(&Object<'_>, &mut EntityBuilder) -> Result<()>,
    fn(EntityRef<'_>, &mut Writer<'_>),
    fn(EntityRef<'_>, &mut EntityBuilder),
);

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

fn is_in<C: Component>(entity: EntityRef<'_>) -> bool {
    entity.has::<C>()
}

/// A value of a key.
pub(crate) trait Field: Copy {
    /// The value of a key, or `usual`, or the key's own default. An error is recorded, and reading
    /// continues with some value.
    fn read(object: &Object<'_>, key: &'static str, usual: Option<Self>) -> Self;

    /// The value as it is written.
    fn to_json(self) -> Value;
}

impl Field for f64 {
    fn read(object: &Object<'_>, key: &'static str, usual: Option<Self>) -> Self {
        let range = object.range(key);
        let own = match object.absent(key) {
            Absent::Is(x) => Some(x),
            _ => None,
        };
        object.value(key, &range.words(), usual.or(own), 1.0, |cursor| cursor.number(range))
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for u32 {
    fn read(object: &Object<'_>, key: &'static str, usual: Option<Self>) -> Self {
        let (low, high) = match object.takes(key) {
            Some(Takes::Integer(low, high)) => (low, high),
            _ => {
                debug_assert!(false, "{key} takes no integer");
                (0, u32::MAX)
            }
        };
        let own = match object.absent(key) {
            // Tables contain only integers in range.
            Absent::Is(x) => Some(x as u32),
            _ => None,
        };
        let what = integer_words(low, high);
        object.value(key, &what, usual.or(own), low, |cursor| cursor.integer(low, high))
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for DVec3 {
    fn read(object: &Object<'_>, key: &'static str, usual: Option<Self>) -> Self {
        let own = match object.absent(key) {
            Absent::Are(three) => Some(three.into()),
            _ => None,
        };
        let (takes, usual) = (object.takes(key), usual.or(own));
        let what = if matches!(takes, Some(Takes::Color)) { COLOR } else { POINT };
        object.value(key, what, usual, Self::ONE, |cursor| match takes {
            Some(Takes::Color) => cursor.color(),
            Some(Takes::Direction(such_as)) => cursor.direction(such_as),
            _ => cursor.point(),
        })
    }

    fn to_json(self) -> Value {
        self.to_array().to_vec().into()
    }
}

/// Reads and writes a word of `T`, as [`Field`] does.
pub(crate) fn read_word<T: Choice>(object: &Object<'_>, key: &'static str, usual: Option<T>) -> T {
    let own = match object.absent(key) {
        Absent::Says(word) => T::VALUES.iter().copied().find(|value| value.name() == word),
        _ => None,
    };
    let options = options();
    let read = |cursor: &super::Cursor<'_>| cursor.choice(&options);
    object.value(key, &words_of(&options), usual.or(own), T::VALUES[0], read)
}

/// Makes values of keys of enumerations.
macro_rules! words {
    ($($kind:ty),+ $(,)?) => { $(
        impl $crate::format::Field for $kind {
            fn read(
                object: &$crate::format::Object<'_>,
                key: &'static str,
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

/// Declares a component: above each field its description, then its key, its values and its
/// default. `read_or` takes the values of keys that are left out from another.
macro_rules! component {
    (
        $(#[$attribute:meta])*
        pub struct $Name:ident {
            $(
                $(#[doc = $about:literal])+
                pub $field:ident: $type:ty =
                    $key:literal $(| $old:literal)*: $takes:expr $(, $absent:expr)?;
            )+
        }
    ) => {
        $(#[$attribute])*
        pub struct $Name {
            $( $(#[doc = $about])+ pub $field: $type, )+
        }

        impl $Name {
            pub(crate) const FIELDS: &'static [$crate::format::Key] = $crate::format::keys! {
                $( $(#[doc = $about])+ $key $(| $old)*: $takes $(, $absent)?; )+
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
