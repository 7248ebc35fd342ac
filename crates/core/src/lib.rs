//! The tracing core of wavecrest: from dense arrays of primitives to the pixels of a film.
//!
//! [`geometry`] defines hits, [`accel`] finds them, [`kernels`] compute with one value or eight at a
//! time, and the two tracers, [`wavefront`] and [`recursive`], call these kernels in their own
//! schedules. [`render`] distributes an image over threads. Nothing here reads a file.

pub mod accel;
pub mod counters;
pub mod film;
pub mod geometry;
pub mod kernels;
pub mod math;
pub mod plan;
pub mod prepared;
pub mod probe;
pub mod recursive;
pub mod render;
pub mod tile;
pub mod wavefront;
