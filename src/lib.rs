//! wavecrest: a data-oriented ray tracer for large triangle-mesh scenes.

pub mod accel;
pub mod accuracy;
pub mod cli;
pub mod counters;
pub mod error;
pub mod farm;
pub mod generate;
pub mod image;
pub mod kernels;
pub mod math;
pub mod memory;
pub mod plan;
pub mod prepared;
pub mod probe;
pub mod ray_file;
pub mod recursive;
pub mod render;
pub mod replace;
pub mod report;
pub mod scene;
pub mod selftest;
pub mod systems;
pub mod tile;
pub mod variant;
pub mod wavefront;
