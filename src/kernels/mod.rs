//! Pure functions: values in, values out. They know no queues, no world, no files.

pub mod camera;
pub mod light;
pub mod texture;
