//! Numbers: rounding-error bounds, rays, random numbers, maps from the unit square to shapes, and the sRGB curve.

pub mod bounds;
pub mod exact;
pub mod float;
pub mod random;
pub mod ray;
pub mod real;
pub mod sampling;
pub mod simd;
pub mod sobol;
pub mod srgb;
pub mod trigonometry;
pub mod vector;
