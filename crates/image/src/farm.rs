//! Images rendered in parts: resumed after an interruption, or rendered by many machines.
//!
//! A render goes over the tiles of an image, once or in several [`Passes`]. The sums of the samples of a tile so far are a unit
//! of a [`part`] file: the same kind for a [`checkpoint`] of a render and for a [`shard`] of an image that [`merge`]
//! assembles. The sums are those of a single process, in double precision, so the image is the same to the last bit.
//!
//! The tiles follow from the image, not from threads or batches: see [`Identity::grid`]. In fast
//! precision an image may depend on the search of the tree (see
//! [`wavecrest_core::kernels::precision::Precision`]): use the same settings on all machines.

pub mod checkpoint;
mod identity;
pub mod merge;
pub mod part;
mod passes;
pub mod shard;

pub use identity::Identity;
pub use part::{Author, Pass};
pub use passes::Passes;
pub use shard::Shard;
