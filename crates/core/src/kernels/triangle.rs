//! Where a ray meets a triangle.
//!
//! A hit is defined in exact arithmetic ([`exact`]): the ray and the corners are taken as the
//! numbers of single precision that they are, the triangle is closed, and t is rounded once when it
//! is returned. Two triangles that share an edge leave no gap, whatever the ray, and coplanar triangles
//! are met at the same t.
//!
//! - [`filter`] tests one ray against the eight triangles of a leaf, in single precision and with
//!   bounds: certain hits with an interval for t, certain misses, and open pairs.
//! - [`settle`](meet) decides nearly all open pairs in double precision, also with bounds, and
//!   computes the t of hits.
//! - [`exact`] decides the rest. It takes microseconds a pair, and happens for a few rays in
//!   millions, unless rays are aimed at edges.
//!
//! A ray through an edge meets both triangles there, and [crosses](crossing()) one of them.

mod area;
pub mod exact;
pub mod filter;
pub(crate) mod settle;

pub use area::{is_degenerate, normal};
pub use filter::{LaneHits, ShearedSpace};
pub(crate) use settle::settled;
pub use settle::{crossing, meet};

/// The least normal number: a bound on what underflow adds to a sum of a few products, far above
/// the true error, as processors divide subnormal numbers a hundred times slower.
const UNDERFLOW: f32 = f32::MIN_POSITIVE;

#[cfg(test)]
mod tests;
