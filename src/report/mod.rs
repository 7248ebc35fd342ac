//! What a render tells about itself.

pub mod bench;
pub mod effects;
pub mod foretold;
pub mod statistics;
pub mod summary;
