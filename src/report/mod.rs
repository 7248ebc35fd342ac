//! What a render tells about itself.

pub mod statistics;
