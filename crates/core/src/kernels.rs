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

// The types that every module uses, by their names alone.
pub(crate) use blinn_phong::{Material, Reflection};
pub(crate) use camera::Camera;
pub(crate) use corners::CornerValues;
pub(crate) use differential::{Differential, Footprint};
pub(crate) use disk::Disk;
pub(crate) use environment::Environment;
pub(crate) use hemisphere::Hemisphere;
pub(crate) use light::{Light, LightPoint};
pub(crate) use precision::{Arithmetic, Precision};
pub(crate) use shade::{MirrorRequest, ShadingPoint, ShadowRequest};
pub(crate) use slab::{Aabb, SlabRay};
pub(crate) use surface::SurfacePoint;
pub(crate) use texture::{Filter, Image, LazyImage, UvMap, Wrap};
pub(crate) use transmission::{Refracted, Transparency};
pub(crate) use triangle::{LaneHits, ShearedSpace};
