//! From a scene file to what the tracers read.
//!
//! [`load`] reads a file into a hecs world, [`systems`] turn that into a
//! [`PreparedScene`](wavecrest_core::prepared::PreparedScene), and [`write`](mod@write) goes the other way.

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
