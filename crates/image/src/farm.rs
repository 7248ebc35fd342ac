//! Images that are made in parts: by a process that was interrupted and goes on, or by many machines.
//!
//! A render is cut into units, each some [blocks](wavecrest_core::render::units::Blocks) of the samples of a tile. The
//! sums of finished units are kept in a file, [`part`]: the same kind whether it is a [`checkpoint`] of a
//! render that goes on or a [`shard`] of an image that is put together by [`merge`]. As the sums are those that
//! one process would make, in double precision, so is the image, to the last bit.
//!
//! Which tiles there are follows from the image, and not from threads or batches: see [`Identity::grid`]. In
//! fast arithmetic an image may depend on how a tree is searched (see
//! [`wavecrest_core::kernels::precision::Precision`]): there, all machines should be asked for the same.

pub mod checkpoint;
mod identity;
pub mod merge;
pub mod part;
mod session;
pub mod shard;
mod store;

pub use identity::Identity;
pub use session::{Author, Session};
pub use shard::Shard;
