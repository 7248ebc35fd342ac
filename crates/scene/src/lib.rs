//! From a scene file to what the tracers read.
//!
//! [`load`] reads a file into a hecs world, [`systems`] turn that into a
//! [`PreparedScene`](wavecrest_core::prepared::PreparedScene), and [`write`](mod@write) goes the other way.

pub mod components;
pub mod corners;
mod format;
pub mod generate;
pub mod gltf;
mod json_schema;
pub mod load;
mod loaded;
pub mod memory;
pub mod mesh;
mod options;
mod standalone;
pub mod survey;

mod parse;
mod query;
mod reader;
mod schema;
mod spawn;
mod staging;
pub mod systems;
mod words;
pub mod write;

pub use json_schema::json_schema;

#[cfg(test)]
mod tests;
