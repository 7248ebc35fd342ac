//! What a render tells about itself.

pub mod bench;
pub mod effects;
pub mod foretold;
mod markup;
pub mod page;
pub mod plot;
pub mod statistics;
pub mod summary;
