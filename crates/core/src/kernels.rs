//! Pure functions of values, without queues, world or files, shared by both tracers.
//!
//! Intersection has two steps. `intersect` decides whether and at which t a ray meets a shape;
//! [`surface`] computes the point, its error bound and its normal, and is skipped for shadow rays.

pub mod blinn_phong;
pub mod camera;
pub mod corners;
pub mod differential;
pub mod disk;
pub mod environment;
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
pub mod transmission;
pub mod triangle;
