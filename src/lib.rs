//! wavecrest: a data-oriented ray tracer for large triangle-mesh scenes.

pub mod accel;
pub mod cli;
pub mod error;
pub mod generate;
pub mod image;
pub mod kernels;
pub mod math;
pub mod scene;
