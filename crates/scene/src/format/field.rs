//! Values of keys: how a field of a component is read from one and written to it.

use glam::DVec3;
use serde_json::Value;

use super::cursor::{Cursor, Range};
use super::keys::Takes;
use wavecrest_base::choice::Choice;
use wavecrest_base::error::Result;

/// A value of a key.
pub(crate) trait Field: Copy {
    /// Some value, with which reading continues after an error.
    const ANY: Self;

    /// The value without a key, whatever the key's own default, if there is one.
    const WITHOUT: Option<Self> = None;

    /// The value at a cursor, if the key takes it.
    fn read(cursor: &Cursor<'_>, takes: Takes) -> Result<Self>;

    /// The value as it is written; null if it is not.
    fn to_json(self) -> Value;
}

impl Field for f64 {
    const ANY: Self = 1.0;

    fn read(cursor: &Cursor<'_>, takes: Takes) -> Result<Self> {
        match takes {
            Takes::Number(range) => cursor.number(range),
            _ => cursor.number(Range::COORDINATE),
        }
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for u32 {
    const ANY: Self = 1;

    fn read(cursor: &Cursor<'_>, takes: Takes) -> Result<Self> {
        match takes {
            Takes::Integer(low, high) => cursor.integer(low, high),
            _ => cursor.integer(0, Self::MAX),
        }
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for bool {
    const ANY: Self = false;

    fn read(cursor: &Cursor<'_>, _: Takes) -> Result<Self> {
        cursor.truth()
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for DVec3 {
    const ANY: Self = Self::ONE;

    fn read(cursor: &Cursor<'_>, takes: Takes) -> Result<Self> {
        match takes {
            Takes::Color => cursor.color(),
            Takes::Direction(such_as) => cursor.direction(such_as),
            _ => cursor.point(),
        }
    }

    fn to_json(self) -> Value {
        self.to_array().to_vec().into()
    }
}

impl<T: Field> Field for Option<T> {
    const ANY: Self = Some(T::ANY);

    const WITHOUT: Option<Self> = Some(None);

    fn read(cursor: &Cursor<'_>, takes: Takes) -> Result<Self> {
        T::read(cursor, takes).map(Some)
    }

    fn to_json(self) -> Value {
        self.map_or(Value::Null, T::to_json)
    }
}

/// An enumeration whose names are values of keys.
pub(crate) trait Word: Choice {}

impl<T: Word> Field for T {
    const ANY: Self = T::VALUES[0];

    fn read(cursor: &Cursor<'_>, _: Takes) -> Result<Self> {
        let words: Vec<_> = T::VALUES.iter().map(|value| (value.name(), *value)).collect();
        cursor.choice(&words)
    }

    fn to_json(self) -> Value {
        self.name().into()
    }
}

/// Makes enumerations values of keys.
macro_rules! words {
    ($($kind:ty),+ $(,)?) => { $( impl $crate::format::Word for $kind {} )+ };
}
pub(crate) use words;
