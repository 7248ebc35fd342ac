//! From a scene file to a world of entities.

pub mod components;
pub mod mesh;
