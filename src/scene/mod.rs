//! From a scene file to a world of entities.

mod alone;
pub mod components;
pub mod corners;
pub mod gltf;
pub mod load;
pub mod mesh;

mod parse;
mod reader;
mod schema;
mod staging;
pub mod write;

#[cfg(test)]
mod tests;
