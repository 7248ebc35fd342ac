//! Reads scenes and prepares them for the tracers.
//!
//! [`load`] reads a file into a hecs world, [`systems`] turn that into a
//! [`PreparedScene`](wavecrest_core::prepared::PreparedScene), and [`write`](mod@write) writes a
//! world as a scene file.

pub mod components;
pub mod generate;
pub mod load;
pub mod mesh;
pub mod mtl;

mod camera;
mod corners;
mod environment;
mod folder;
mod format;
mod gltf;
mod image_file;
mod lights;
mod options;
mod query;
mod scene_file;
mod shapes;
mod staging;
mod surface;
pub mod systems;
mod texture_source;
pub mod write;

/// The keys of scene files, for tools that describe them; [`json_schema`] says the same to editors.
pub mod keys {
    pub use crate::format::{Absent, Declaration, Key, Kind, Range, Takes, Variants};
    pub use crate::scene_file::file;
}

/// The crate of the world.
pub use hecs;
pub use scene_file::json_schema;

#[cfg(test)]
mod tests;
