//! Pure functions: values in, values out. They know no queues, no world, no files, and both
//! tracers call the same ones.
//!
//! A ray meets a shape in two steps. `intersect` decides whether and at which t; [`surface`]
//! rebuilds the point, its error bound and its normal, and is left out for shadow rays.

pub mod blinn_phong;
pub mod camera;
pub mod corners;
pub mod differential;
pub mod hemisphere;
pub mod light;
pub mod metal;
pub mod precision;
pub mod quad;
pub mod shade;
pub mod slab;
pub mod sphere;
pub mod surface;
pub mod texture;
pub mod triangle;
