//! Reads scenes and prepares them for the tracers.
//!
//! [`load`] reads a file into a hecs world, [`systems`] turn that into a
//! [`PreparedScene`](wavecrest_core::prepared::PreparedScene), and [`write`](mod@write) writes a
//! world as a scene file.

pub mod components;
pub mod corners;
pub mod generate;
pub mod gltf;
pub mod load;
pub mod memory;
pub mod mesh;
pub mod mtl;
pub mod survey;

mod folder;
mod parse;
mod query;
mod reader;
mod schema;
pub mod systems;
pub mod write;

pub use parse::json_schema;

#[cfg(test)]
mod tests;
