//! Types of numbers in binary files.

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// Evaluates `$value` with `$number` as the type of numbers of the kind `$kind`.
macro_rules! with_type {
    ($kind:expr, $number:ident => $value:expr) => {
        with_type!(
            $kind, $number => $value,
            I8 i8, U8 u8, I16 i16, U16 u16, I32 i32, U32 u32, F32 f32, F64 f64
        )
    };
    ($kind:expr, $number:ident => $value:expr, $($name:ident $type:ty),+) => {
        match $kind { $(Scalar::$name => { type $number = $type; $value })+ }
    };
}
pub(in crate::mesh) use with_type;

impl Scalar {
    /// Size of a binary number of this type in bytes.
    pub(crate) fn size(self) -> usize {
        with_type!(self, N => size_of::<N>())
    }

    /// The largest integer of this type; `None` for other types.
    pub(crate) fn greatest(self) -> Option<u32> {
        let is_whole = !matches!(self, Self::F32 | Self::F64);
        let sign = u32::from(matches!(self, Self::I8 | Self::I16 | Self::I32));
        is_whole.then(|| u32::MAX >> (u32::BITS - 8 * self.size() as u32 + sign))
    }

    /// The little-endian number at the start of some bytes, if there are enough. `f64` represents
    /// every value of every type.
    #[allow(clippy::useless_conversion, reason = "one of the types is f64")]
    pub(crate) fn number(self, bytes: &[u8]) -> Option<f64> {
        with_type!(self, N => bytes.first_chunk().map(|bytes| f64::from(N::from_le_bytes(*bytes))))
    }
}
