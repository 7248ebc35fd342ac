//! The precision of hits and points, and its cost.
//!
//! - [`Fast`] is what most renderers do, kept for honest comparison: single precision, the triangle
//!   test of Möller and Trumbore, unpadded boxes, and origins moved off surfaces by a fixed length.
//! - [`Robust`] is the default: no ray slips through an edge or is lost in a box, and origins are
//!   moved by a bound on their error.
//! - [`Exact`] decides in double precision, and without any rounding if that leaves a sign open:
//!   the reference. Points of surfaces are those of [`Robust`], which are in double precision too.

wavecrest_base::choices! {
    /// The choice at run time.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Precision {
        /// Single precision without error bounds: leaks at edges, and acne far from the origin.
        Fast = "fast",
        /// Single precision with error bounds; double precision where they do not decide.
        #[default]
        Robust = "robust",
        /// Double precision with exact signs.
        Exact = "exact",
    }
}

impl Precision {
    /// Its description, in a line.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Fast => "single precision without error bounds: rays can leak through edges",
            Self::Robust => "watertight, with error bounds",
            Self::Exact => "double precision with exact signs, one ray at a time",
        }
    }
}

/// The choice at compile time: kernels are generic over it.
pub trait Arithmetic: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// The precision.
    const PRECISION: Precision;

    /// The precision of surface points: [`Robust`] for [`Exact`].
    type Points: Arithmetic;

    /// Whether it is [`Fast`].
    const IS_FAST: bool = matches!(Self::PRECISION, Precision::Fast);
}

/// See [`Precision::Fast`].
#[derive(Clone, Copy, Debug)]
pub struct Fast;

/// See [`Precision::Robust`].
#[derive(Clone, Copy, Debug)]
pub struct Robust;

/// See [`Precision::Exact`].
#[derive(Clone, Copy, Debug)]
pub struct Exact;

impl Arithmetic for Fast {
    const PRECISION: Precision = Precision::Fast;

    type Points = Fast;
}

impl Arithmetic for Robust {
    const PRECISION: Precision = Precision::Robust;

    type Points = Robust;
}

impl Arithmetic for Exact {
    const PRECISION: Precision = Precision::Exact;

    type Points = Robust;
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
            $crate::kernels::precision::Precision::Robust => {
                type $kind = $crate::kernels::precision::Robust;
                $value
            }
            $crate::kernels::precision::Precision::Exact => {
                type $kind = $crate::kernels::precision::Exact;
                $value
            }
        }
    };
}
