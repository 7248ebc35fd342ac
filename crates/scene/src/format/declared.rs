//! Components that are declared once: with their fields' keys, values, defaults and descriptions.
//!
//! From a declaration come the reader of scene files, the writer and the JSON schema. An object of
//! a scene file is a list of declarations ([`Kind`](super::Kind)), and becomes one entity.

use hecs::{Component, EntityRef};

use super::keys::{Declaration, Key, Object};
use super::writer::Writer;
use wavecrest_base::error::Result;

/// A component with keys of its own in a scene file.
pub(crate) trait Declared: Component + Clone {
    const KEYS: &'static [Key];

    /// Reads it from an object with these keys; `None` if the object does without.
    fn read(object: &Object<'_>) -> Result<Option<Self>>;

    /// Writes it to an object with these keys.
    fn write(&self, to: &mut Writer<'_>);
}

impl Declaration {
    /// The declaration of `C`.
    pub(crate) const fn of<C: Declared>() -> Self {
        Self {
            keys: C::KEYS,
            read: |object, entity| {
                C::read(object)?.map(|component| entity.add(component));
                Ok(())
            },
            write: |entity, to| {
                entity.get::<&C>().into_iter().for_each(|component| component.write(to));
            },
            copy: |from, to| {
                from.get::<&C>().into_iter().for_each(|component| _ = to.add(C::clone(&component)));
            },
            is_in: |entity| entity.has::<C>(),
        }
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
