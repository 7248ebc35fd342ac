//! Numbers: rounding-error bounds, rays, random numbers, maps from the unit square to shapes, and the sRGB curve.

pub mod bounds;
pub mod exact;
pub mod float;
pub mod multisets;
pub mod random;
pub mod ray;
pub mod real;
pub mod sampling;
pub mod simd;
pub mod sobol;
pub mod srgb;
pub mod trigonometry;
pub mod vector;

// The types and kernels that every module uses, by their names alone.
pub(crate) use random::Stream;
pub(crate) use ray::Ray;
pub(crate) use real::{Mask, Real, Single, both};
pub(crate) use simd::{
    AnyWidth, LANES, Lanes, dispatch_any_width, entry, is_wide, outlined, set_bits,
};
pub(crate) use vector::{Line, Vector};
