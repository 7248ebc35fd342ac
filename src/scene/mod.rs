//! From a scene file to a world of entities.

pub mod components;
pub mod corners;
pub mod load;
pub mod mesh;
pub mod survey;

mod parse;
mod reader;
mod schema;

pub use parse::json_schema;

#[cfg(test)]
mod tests;
