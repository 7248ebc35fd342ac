//! Values of keys: how a field of a component is read from one and written to it.

use glam::DVec3;
use serde_json::Value;

use super::cursor::{Cursor, Range};
use super::keys::{Absent, Takes};
use wavecrest_base::choice::Choice;
use wavecrest_base::error::Result;

/// A value of a key.
pub(crate) trait Field: Copy {
    /// The value at a cursor, if the key takes it.
    fn read(cursor: &Cursor<'_>, takes: Takes) -> Result<Self>;

    /// The key's own default, if it has one.
    fn own_default(absent: Absent) -> Option<Self>;

    /// Some value that the key takes, with which reading continues after an error.
    fn any(takes: Takes) -> Self;

    /// The value as it is written; null if it is not.
    fn to_json(self) -> Value;
}

impl Field for f64 {
    fn read(cursor: &Cursor<'_>, takes: Takes) -> Result<Self> {
        match takes {
            Takes::Number(range) => cursor.number(range),
            _ => cursor.number(Range::COORDINATE),
        }
    }

    fn own_default(absent: Absent) -> Option<Self> {
        if let Absent::Is(x) = absent { Some(x) } else { None }
    }

    fn any(_: Takes) -> Self {
        1.0
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for u32 {
    fn read(cursor: &Cursor<'_>, takes: Takes) -> Result<Self> {
        match takes {
            Takes::Integer(low, high) => cursor.integer(low, high),
            _ => cursor.integer(0, Self::MAX),
        }
    }

    fn own_default(absent: Absent) -> Option<Self> {
        // Tables contain only integers in range.
        f64::own_default(absent).map(|x| x as Self)
    }

    fn any(takes: Takes) -> Self {
        if let Takes::Integer(low, _) = takes { low } else { 0 }
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for bool {
    fn read(cursor: &Cursor<'_>, _: Takes) -> Result<Self> {
        cursor.truth()
    }

    fn own_default(_: Absent) -> Option<Self> {
        Some(false)
    }

    fn any(_: Takes) -> Self {
        false
    }

    fn to_json(self) -> Value {
        self.into()
    }
}

impl Field for DVec3 {
    fn read(cursor: &Cursor<'_>, takes: Takes) -> Result<Self> {
        match takes {
            Takes::Color => cursor.color(),
            Takes::Direction(such_as) => cursor.direction(such_as),
            _ => cursor.point(),
        }
    }

    fn own_default(absent: Absent) -> Option<Self> {
        if let Absent::Are(three) = absent { Some(three.into()) } else { None }
    }

    fn any(_: Takes) -> Self {
        Self::ONE
    }

    fn to_json(self) -> Value {
        self.to_array().to_vec().into()
    }
}

/// None where the key is absent, whatever its default.
impl<T: Field> Field for Option<T> {
    fn read(cursor: &Cursor<'_>, takes: Takes) -> Result<Self> {
        T::read(cursor, takes).map(Some)
    }

    fn own_default(_: Absent) -> Option<Self> {
        Some(None)
    }

    fn any(takes: Takes) -> Self {
        Some(T::any(takes))
    }

    fn to_json(self) -> Value {
        self.map_or(Value::Null, T::to_json)
    }
}

/// An enumeration whose names are values of keys.
pub(crate) trait Word: Choice {}

impl<T: Word> Field for T {
    fn read(cursor: &Cursor<'_>, _: Takes) -> Result<Self> {
        let words: Vec<_> = T::VALUES.iter().map(|value| (value.name(), *value)).collect();
        cursor.choice(&words)
    }

    fn own_default(absent: Absent) -> Option<Self> {
        if let Absent::Says(word) = absent { T::by_name(word) } else { None }
    }

    fn any(_: Takes) -> Self {
        T::VALUES[0]
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
