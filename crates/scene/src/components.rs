//! The components of scene entities: plain data, one concept each, declared where the feature is.
//!
//! A shape is an entity with [`Order`], [`JsonPath`], one of [`Sphere`], [`Disk`], [`Quad`],
//! [`Triangle`] or [`Mesh`], and [`Material`], [`Sides`], [`Shading`]; optionally [`Facing`], [`Transform`],
//! [`Transparency`], [`TextureRef`], [`Maps`], [`CutOut`], [`Name`]. A point light is an entity with [`PointLight`],
//! which [`Spot`] narrows to a cone. A distant light has [`DirectionalLight`]. An area light has
//! [`AreaLight`] and the geometry of its shape. Ambient light by the normal is an entity with [`Sky`], what surrounds the
//! scene one with [`Environment`]. The camera has [`View`], [`ThinLens`] unless it is a pinhole, and [`CameraPath`] if it
//! moves. An instance has [`InstanceOf`] in place of a shape's geometry. One entity holds [`Settings`].
//! A shape that is added to a file without lights has [`Added`].
//!
//! Lengths are in the scene's own unit; colours are linear, 0 to 1. Numbers keep the precision of
//! the file; the systems round them once, after the transform.

use std::path::PathBuf;

use glam::DVec3;

pub use crate::camera::{
    CameraKey, CameraPath, Falloff, FovAxis, FreeCamera, Interpolation, Sampling, ThinLens, View,
};
pub use crate::environment::{Environment, Surroundings};
pub use crate::lights::{AreaLight, DirectionalLight, PointLight, Sky, Spot};
pub use crate::mesh::VertexColors;
pub use crate::shapes::{
    Disk, Facing, Hidden, InstanceOf, Materials, Mesh, MeshFile, Name, Quad, Shading, Sides,
    Sphere, Transform, Triangle,
};
pub use crate::surface::{
    Channels, CutOut, Encoding, Filter, LookUp, Map, Maps, Material, Placing, TextureRef,
    Transparency, Wrap,
};
pub use crate::texture_source::TextureSource;

/// The place of the entity in the scene file, such as `scene.shapes[3]`, for messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JsonPath(pub String);

/// A shape that is added to a file without lights, and is no part of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Added {
    /// The ground on which it stands.
    Ground,
    /// The lamp of a closed room.
    Lamp,
}

/// The index of the entity among the shapes, or among the lights, of the file. Primitives and
/// lights are numbered in this order, because a world does not keep one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Order(pub u32);

/// Settings of the whole scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The scene file: relative paths start from its folder.
    pub file: PathBuf,
    /// How often a ray may be mirrored or refracted after the camera ray.
    pub bounces: u32,
    /// Colour of rays that hit nothing and were not mirrored.
    pub background: DVec3,
    /// A factor on the diffuse colour, added once for each light, visible or not; 0 if the world has
    /// a [`Sky`].
    pub ambient: f64,
    /// Transfer curve of 8-bit images, unless one is requested.
    pub transfer: Encoding,
}
