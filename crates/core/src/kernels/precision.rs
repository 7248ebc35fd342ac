//! The precision of hits and points, and its cost.
//!
//! - [`Exact`] is the default: every hit is that of exact arithmetic. Of the closed triangles that a
//!   ray meets in exact arithmetic within its range, it is the one with the least t; of equal t one
//!   that shadow rays pass, then the lowest number. Filters in single precision with error bounds
//!   decide most hits, and origins are moved off surfaces by a bound on their error.
//! - [`Fast`] takes these filters as they are: single precision without error bounds, as in most
//!   renderers, and origins moved by a fixed length.
//! - [`Reference`] is no precision to choose but the reference for the hits of [`Exact`]: each pair
//!   of ray and triangle in exact arithmetic, without filters ([`KernelChoice::Reference`]).
//!
//! [`KernelChoice::Reference`]: crate::accel::KernelChoice::Reference

wavecrest_base::choices! {
    /// The choice at run time.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Precision {
        /// The filters of exact taken as they are: single precision without error bounds.
        Fast = "fast",
        /// Every hit is that of exact arithmetic.
        #[default]
        Exact = "exact" | "robust",
    }
}

impl Precision {
    /// Its description, in a line.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Fast => "single precision without error bounds: rays can leak through edges",
            Self::Exact => "every hit is that of exact arithmetic",
        }
    }
}

/// The choice at compile time: kernels are generic over it.
pub trait Arithmetic: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// Whether it is [`Fast`].
    const IS_FAST: bool = false;

    /// Whether it is [`Reference`].
    const IS_REFERENCE: bool = false;

    /// What the reference kernel computes in: [`Fast`] is a reference for itself, as the kernel must
    /// not affect answers.
    type Reference: Arithmetic;
}

/// See [`Precision::Fast`].
#[derive(Clone, Copy, Debug)]
pub struct Fast;

/// See [`Precision::Exact`].
#[derive(Clone, Copy, Debug)]
pub struct Exact;

/// Each pair of ray and triangle in exact arithmetic.
#[derive(Clone, Copy, Debug)]
pub struct Reference;

impl Arithmetic for Fast {
    const IS_FAST: bool = true;

    type Reference = Fast;
}

impl Arithmetic for Exact {
    type Reference = Reference;
}

impl Arithmetic for Reference {
    const IS_REFERENCE: bool = true;

    type Reference = Reference;
}

/// Evaluates an expression with a type parameter for a precision known at run time: the only place
/// where kernels are chosen by precision.
///
/// ```
/// use wavecrest_core::kernels::precision::{Arithmetic, Precision};
/// fn is_fast<P: Arithmetic>() -> bool {
///     P::IS_FAST
/// }
/// assert!(wavecrest_core::with_precision!(Precision::Fast, P => is_fast::<P>()));
/// ```
#[macro_export]
macro_rules! with_precision {
    ($precision:expr, $kind:ident => $value:expr) => {
        match $precision {
            $crate::kernels::precision::Precision::Fast => {
                type $kind = $crate::kernels::precision::Fast;
                $value
            }
            $crate::kernels::precision::Precision::Exact => {
                type $kind = $crate::kernels::precision::Exact;
                $value
            }
        }
    };
}
