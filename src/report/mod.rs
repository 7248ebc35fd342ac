//! What a render tells about itself.

pub mod bench;
pub mod foretold;
pub mod statistics;
pub mod summary;
