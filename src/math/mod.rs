//! Numbers: rounding-error bounds, rays, random numbers, and maps from the unit square to shapes.

pub mod exact;
pub mod float;
pub mod lanes;
pub mod random;
pub mod ray;
pub mod sampling;
pub mod simd;
pub mod sobol;
