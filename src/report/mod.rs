//! What a render tells about itself.

pub mod bench;
pub mod statistics;
pub mod summary;
