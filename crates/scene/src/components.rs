//! The components of scene entities: plain data, one concept each.
//!
//! A shape is an entity with [`Order`], [`JsonPath`], one of [`Sphere`], [`Quad`], [`Triangle`] or
//! [`Mesh`], and [`Material`], [`Sides`], [`Shading`]; optionally [`Facing`], [`Transform`],
//! [`TextureRef`], [`Maps`], [`CutOut`], [`Name`]. A point light is an entity with [`PointLight`],
//! which [`Spot`] narrows to a cone. A distant light has [`DirectionalLight`]. An area light has
//! [`AreaLight`] and the geometry of its shape. The camera has [`View`] and [`Pinhole`] or
//! [`ThinLens`]. One entity holds [`Settings`].
//!
//! Lengths are in the scene's own unit; colours are linear, 0 to 1. Numbers keep the precision of
//! the file; the systems round them once, after the transform.

mod textures;

use std::path::PathBuf;

use glam::{DAffine3, DVec3};
use hecs::Entity;

use super::mesh::MeshData;
pub use textures::{
    CutOut, Encoding, Filter, Maps, MetalMap, Placing, StrengthMap, TextureRef, TextureSource, Wrap,
};

/// The name of the entity in the scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name(pub String);

/// The place of the entity in the scene file, such as `scene.shapes[3]`, for messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JsonPath(pub String);

/// The index of the entity among the shapes, or among the lights, of the file. Primitives and
/// lights are numbered in this order, because a world does not keep one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Order(pub u32);

/// Settings of the whole scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The scene file: relative paths start from its folder.
    pub file: PathBuf,
    /// Largest number of mirror bounces after the camera ray.
    pub bounces: u32,
    /// Colour of camera rays that hit nothing.
    pub background: DVec3,
    /// Ambient light.
    pub ambient: Ambient,
}

/// Ambient light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ambient {
    /// A factor on the diffuse colour, added once for each light, visible or not.
    Even(f64),
    /// Light from a sky and from the ground, added once, weighted by the normal.
    Hemisphere {
        /// The colour on a surface that faces up.
        sky: DVec3,
        /// The colour on a surface that faces down.
        ground: DVec3,
        /// Direction of the sky, of any length above 0.
        up: DVec3,
    },
}

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: DVec3,
    /// Its radius, above 0.
    pub radius: f64,
}

/// A planar quad: bottom left, top left, top right, bottom right as seen from its front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    /// The corners in that order.
    pub points: [DVec3; 4],
}

/// One triangle. It is half a [`Quad`]: its front is where the points run clockwise, so that u
/// along `points[0]` to `points[2]` and v along `points[0]` to `points[1]` read left to right and
/// bottom to top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// The corners.
    pub points: [DVec3; 3],
}

/// A triangle mesh. Its front is where the corners run counter-clockwise, as in mesh files.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The arrays. The geometry system moves them out, so that a large mesh is never held twice.
    pub data: MeshData,
    /// Positions of an inline mesh in double precision, if they have more digits than single
    /// precision: they are moved before they are rounded.
    pub points: Option<Vec<DVec3>>,
    /// The file of the mesh, if any.
    pub file: Option<PathBuf>,
}

/// The prototype of an instance: an entity with a sphere, quad, triangle or mesh, which is stored
/// once. Everything else is the instance's own: its [`Transform`] goes from the prototype's own
/// space to the world; the other entity's transform is ignored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstanceOf(pub Entity);

/// Marks a shape that is not rendered itself; only its instances are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hidden;

/// Which side of a [`Quad`] or a [`Triangle`] is its front. Without this component, the winding
/// decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facing {
    /// Opposite to the winding's side.
    Flipped,
    /// The side that this vector points to, in the shape's own space.
    Toward(DVec3),
}

/// The transform from the shape's own space to the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform(pub DAffine3);

wavecrest_base::choices! {
    /// The sides of a surface that lights reach.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Sides {
        /// The front; the back shows ambient light only.
        Front = "front",
        /// Both.
        Both = "both",
    }
}

wavecrest_base::choices! {
    /// The shading normals of a mesh.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Shading {
        /// The triangle's own.
        Flat = "flat",
        /// Interpolated from the vertices, if the mesh has normals.
        Smooth = "smooth",
    }
}

/// Blinn-Phong, with a mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Weight of the highlight.
    pub ks: f64,
    /// Weight of the diffuse reflection.
    pub kd: f64,
    /// Exponent of the highlight, 0 or more.
    pub specular_exponent: f64,
    /// Diffuse colour, unless a texture replaces it.
    pub diffuse_color: DVec3,
    /// Weight of the mirror ray; 0 for none.
    pub kr: f64,
    /// Emission, which is visible but does not light other surfaces; black for none.
    pub emission: DVec3,
    /// Colour of the highlight and of mirrored light.
    pub specular_color: DVec3,
}

wavecrest_base::choices! {
    /// The encoding of vertex colours in a mesh file.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum VertexColors {
        /// sRGB-encoded, as in most programs.
        #[default]
        Srgb = "srgb",
        /// Linear.
        Linear = "linear",
        /// Ignored.
        None = "none",
    }
}

wavecrest_base::choices! {
    /// The source of the materials of a mesh file's faces.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Materials {
        /// The shape's.
        #[default]
        Shape = "shape",
        /// The file's, if it has any.
        File = "file",
    }
}

pub use wavecrest_core::kernels::light::Falloff;
pub use wavecrest_core::math::sampling::Sampling;

/// A light at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Its strength.
    pub intensity: f64,
    /// Position.
    pub position: DVec3,
    /// Its colour.
    pub color: DVec3,
    /// Falloff with distance.
    pub falloff: Falloff,
}

/// Narrows the [`PointLight`] of the same entity to a spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Direction of the light, of any length above 0.
    pub direction: DVec3,
    /// Angle off that direction up to which it has full strength, in degrees.
    pub inner_degrees: f64,
    /// Angle from which on it has none: at least the inner angle, at most 90 degrees.
    pub outer_degrees: f64,
}

/// A light infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Its strength everywhere, shared by its samples.
    pub intensity: f64,
    /// Its colour.
    pub color: DVec3,
    /// Direction of the light, of any length above 0.
    pub direction: DVec3,
    /// Its diameter in the sky, in degrees, up to 180; at 0 its rays are parallel.
    pub angle_degrees: f64,
    /// Distribution of the directions to it.
    pub sampling: Sampling,
    /// Number of directions (random, sobol), or along each side of a square grid (jittered).
    pub samples: u32,
}

/// A light whose shape is the geometry of the same entity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaLight {
    /// Its strength, shared by its samples.
    pub intensity: f64,
    /// Its colour, which camera and mirror rays that hit it return too.
    pub color: DVec3,
    /// Falloff with distance.
    pub falloff: Falloff,
    /// Distribution of the points on it.
    pub sampling: Sampling,
    /// Number of points (random, sobol), or along each side of a square grid (jittered).
    pub samples: u32,
}

/// Position and direction of the camera, and the size of its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Position.
    pub location: DVec3,
    /// A point at the centre of the image.
    pub look: DVec3,
    /// The direction that is up in the image, not necessarily perpendicular to the view.
    pub up: DVec3,
    /// Full angle of view across the side that `fov_axis` names, in degrees.
    pub fov_degrees: f64,
    /// The side across which `fov_degrees` is measured.
    pub fov_axis: FovAxis,
    /// Width of the image in pixels.
    pub width: u32,
    /// Height of the image in pixels.
    pub height: u32,
    /// Side of the grid of rays in each pixel; 1 is a single ray through the centre.
    pub antialias: u32,
    /// Distribution of rays over a pixel.
    pub sampling: Sampling,
}

pub use wavecrest_core::kernels::camera::FovAxis;
pub use wavecrest_core::kernels::camera::path::Interpolation;

/// The camera at a frame; omitted values are those of its [`View`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraKey {
    /// The frame.
    pub frame: u32,
    /// Position.
    pub location: DVec3,
    /// A point at the centre of the image.
    pub look: DVec3,
    /// The direction that is up in the image.
    pub up: DVec3,
    /// Full angle of view in degrees.
    pub fov_degrees: f64,
    /// Distance of the plane in focus, along the view axis, above 0; ignored for a pinhole.
    pub focal: f64,
}

/// The path of a camera, a component of its entity.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    /// Its keys, at least one, in the order of their frames.
    pub keys: Vec<CameraKey>,
    /// Interpolation between keys.
    pub interpolation: Interpolation,
}

/// A camera all of whose rays pass through its location.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pinhole;

/// A camera with a lens, in focus in one plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Diameter of the lens disk, 0 or more.
    pub aperture: f64,
    /// Distance of the plane in focus, along the view axis, above 0.
    pub focal: f64,
    /// Distribution of the points on the lens.
    pub sampling: Sampling,
    /// Number of angles (jittered); times `samples_y`, the number of rays for each pixel.
    pub samples_x: u32,
    /// Number of radii (jittered).
    pub samples_y: u32,
}
