//! From a scene file to a world of entities.

mod alone;
pub mod components;
pub mod corners;
mod form;
pub mod gltf;
pub mod load;
pub mod mesh;
pub mod survey;

mod parse;
mod reader;
mod schema;
mod spawn;
mod staging;
pub mod write;

pub use parse::json_schema;

#[cfg(test)]
mod tests;
