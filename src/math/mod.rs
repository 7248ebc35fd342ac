//! Numbers: error bounds, random numbers, sampling.

pub mod sampling;
