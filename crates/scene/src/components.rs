//! What an entity of the scene can carry: plain data, one concept a component.
//!
//! A shape is an entity with [`Order`], [`JsonPath`], one of [`Sphere`], [`Quad`], [`Triangle`] or
//! [`Mesh`], and [`Material`], [`Sides`], [`Shading`], perhaps [`Facing`], [`Transform`],
//! [`TextureRef`], [`Maps`], [`CutOut`], [`Name`]. A point light is an entity with [`PointLight`], which [`Spot`] narrows to a
//! cone; a light from infinitely far away is one with [`DirectionalLight`], and an area light one with [`AreaLight`] and
//! the geometry of its shape. The camera is one with [`View`] and
//! [`Pinhole`] or [`ThinLens`]. One entity holds [`Settings`].
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

/// What the user calls the entity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name(pub String);

/// Where in the scene file the entity stands, such as `scene.shapes[3]`: for messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JsonPath(pub String);

/// The entity's place among the shapes, or among the lights, of the file. Primitives and lights
/// are numbered in this order, because a world's own order is not kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Order(pub u32);

/// What holds for the whole scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The scene file: relative paths start from its folder.
    pub file: PathBuf,
    /// Greatest number of mirror bounces after the primary ray.
    pub bounces: u32,
    /// What a primary ray that hits nothing returns.
    pub background: DVec3,
    /// Light that needs no ray.
    pub ambient: Ambient,
}

/// Ambient light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ambient {
    /// A factor on the diffuse colour, added once for each light, visible or not.
    Even(f64),
    /// Light from a sky and from the ground, added once, by the normal.
    Hemisphere {
        /// The colour on a surface that faces up.
        sky: DVec3,
        /// The colour on one that faces down.
        ground: DVec3,
        /// Where the sky is, of any length above 0.
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
    /// The file that it was read from, if one was.
    pub file: Option<PathBuf>,
}

/// The prototype of an instance: an entity with a sphere, quad, triangle or mesh, which is held once. All else
/// is the instance's own: its [`Transform`] leads from the prototype's own space to the world's, that of the
/// other entity plays no part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstanceOf(pub Entity);

/// Marks a shape that is not seen itself: only its instances are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hidden;

/// Which side of a [`Quad`] or a [`Triangle`] is its front. Absent: the one its winding gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facing {
    /// The other side than the winding gives.
    Flipped,
    /// The side that this vector points to, in the shape's own space.
    Toward(DVec3),
}

/// From the shape's own space to the world's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform(pub DAffine3);

wavecrest_base::choices! {
    /// Which sides of a surface the lights reach.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Sides {
        /// The front; the back shows ambient light only.
        Front = "front",
        /// Both.
        Both = "both",
    }
}

wavecrest_base::choices! {
    /// Which normal a mesh is lit with.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Shading {
        /// The triangle's own.
        Flat = "flat",
        /// Interpolated from the vertices, where the mesh has normals.
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
    /// Diffuse colour, where no texture replaces it.
    pub diffuse_color: DVec3,
    /// Weight of the mirror ray; 0 for none.
    pub kr: f64,
    /// Light of its own, which is seen and falls on nothing else; black for none.
    pub emission: DVec3,
    /// Colour of the highlight, and of what it mirrors.
    pub specular_color: DVec3,
}

wavecrest_base::choices! {
    /// What the colours of a mesh file's vertices stand for.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum VertexColors {
        /// Light behind the sRGB curve, as most programs write and show them.
        #[default]
        Srgb = "srgb",
        /// Light, as they are.
        Linear = "linear",
        /// Nothing: they are left out.
        None = "none",
    }
}

wavecrest_base::choices! {
    /// Whose materials the faces of a mesh file have.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Materials {
        /// The shape's.
        #[default]
        Shape = "shape",
        /// The file's, where it has some.
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
    /// Where it is.
    pub position: DVec3,
    /// Its colour.
    pub color: DVec3,
    /// How its strength falls with distance.
    pub falloff: Falloff,
}

/// What makes a spot of the [`PointLight`] of the same entity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Where it shines to, of any length above 0.
    pub direction: DVec3,
    /// Up to this angle off that direction, in degrees, it has its full strength.
    pub inner_degrees: f64,
    /// From this angle on it has none: at least the other, at most 90 degrees.
    pub outer_degrees: f64,
}

/// A light from infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Its strength everywhere, shared by its samples.
    pub intensity: f64,
    /// Its colour.
    pub color: DVec3,
    /// Where it shines to, of any length above 0.
    pub direction: DVec3,
    /// The angle that it is seen under, in degrees, up to 180; at 0 its rays are parallel.
    pub angle_degrees: f64,
    /// How directions to it are chosen.
    pub sampling: Sampling,
    /// Number of them: all (random, sobol), or along each side of a square grid (jittered).
    pub samples: u32,
}

/// A light whose shape is the geometry that the same entity carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaLight {
    /// Its strength, shared by its samples.
    pub intensity: f64,
    /// Its colour: also what a primary or mirror ray that meets it returns.
    pub color: DVec3,
    /// How its strength falls with distance.
    pub falloff: Falloff,
    /// How points are chosen on it.
    pub sampling: Sampling,
    /// Number of points: all of them (random, sobol), or along each side of a square grid (jittered).
    pub samples: u32,
}

/// Where the camera stands, where it looks, and the image it makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Its place.
    pub location: DVec3,
    /// A point in the middle of the image.
    pub look: DVec3,
    /// The direction that is up in the image, not necessarily at right angles to the view.
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
    /// How rays are spread over a pixel.
    pub sampling: Sampling,
}

pub use wavecrest_core::kernels::camera::FovAxis;
pub use wavecrest_core::kernels::camera::path::Interpolation;

/// Where a camera is at a frame: what is not said here is as its [`View`] says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraKey {
    /// The frame.
    pub frame: u32,
    /// Its place.
    pub location: DVec3,
    /// A point in the middle of the image.
    pub look: DVec3,
    /// The direction that is up in the image.
    pub up: DVec3,
    /// Full angle of view in degrees.
    pub fov_degrees: f64,
    /// Distance of the plane in focus, along the view axis, above 0; no matter for a pinhole.
    pub focal: f64,
}

/// How a camera moves: another component of its entity.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    /// Its keys, one at least, by rising frames.
    pub keys: Vec<CameraKey>,
    /// What lies between them.
    pub interpolation: Interpolation,
}

/// A camera all of whose rays pass through its location.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pinhole;

/// A camera with a lens, sharp in one plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Diameter of the lens disk, 0 or more.
    pub aperture: f64,
    /// Distance of the plane in focus, along the view axis, above 0.
    pub focal: f64,
    /// How points are chosen on the lens.
    pub sampling: Sampling,
    /// Number of angles (jittered); times `samples_y`, the number of rays a pixel.
    pub samples_x: u32,
    /// Number of radii (jittered).
    pub samples_y: u32,
}
