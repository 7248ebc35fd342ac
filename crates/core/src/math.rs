//! Numbers: rounding-error bounds, rays, random numbers, maps from the unit square to shapes, and the sRGB curve.

pub mod exact;
pub mod float;
pub mod lanes;
pub mod random;
pub mod ray;
pub mod sampling;
pub mod simd;
pub mod sobol;
pub mod srgb;
