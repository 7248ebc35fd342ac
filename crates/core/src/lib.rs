//! The tracing core of wavecrest: from dense arrays of primitives to the pixels of a film.
//!
//! [`accel`] finds what rays hit, [`kernels`] compute with one value or with eight at a time, and the two tracers,
//! [`wavefront`] and [`recursive`], call these kernels in schedules of their own. [`render`] shares an image among
//! threads. Nothing here reads a file.

pub mod accel;
pub mod counters;
pub mod film;
pub mod kernels;
pub mod math;
pub mod plan;
pub mod prepared;
pub mod probe;
pub mod recursive;
pub mod render;
pub mod tile;
pub mod wavefront;
