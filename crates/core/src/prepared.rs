//! The scene as the tracers see it: dense arrays, a tree and a plan, immutable while rendering.

mod appearance;
mod class;
mod differential;
mod fingerprint;
mod group;
mod interaction;
mod interface;
mod look_up;
mod maps;
mod media;
mod path;
mod resample;
mod shadow_crossings;
mod transmission;

use std::ops::Range;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4};

pub use class::{Class, Map, Property};
pub use group::{Face, Group};
pub use interaction::{Interaction, surface};
pub use media::{MediumStack, Solid};
pub use path::{Branch, MOST_RAYS, PathState};
pub use resample::{Original, Samples};
pub use shadow_crossings::ShadowCrossings;
pub use transmission::{Meeting, Scattered, ScatteredRays};

use crate::accel::Accel;
pub use crate::counters::SampleCounts;
use crate::kernels::camera::path::Path;
pub use crate::kernels::corners::{CornerValues, NO_VALUE};
pub use crate::kernels::shade::Visible;
pub use crate::kernels::texture::{LazyImage, Placing, UvMap};
use crate::kernels::{Camera, Environment, Filter, Hemisphere, Light, Wrap};
use crate::plan::Plan;
use group::{GroupHits, three};
use interface::{Interface, InterfaceHit};
use maps::MappedHits;
use media::Sides;
use wavecrest_base::error::Result;

/// Everything that a render reads; immutable, but for chunks and images that wait for a first ray.
#[derive(Debug)]
pub struct PreparedScene {
    /// The effects to simulate.
    pub plan: Plan,
    /// The origin of all coordinates here, in the scene's coordinates and units.
    pub origin: DVec3,
    /// Where rays start.
    pub camera: Camera,
    /// The path of a moving camera. To render a frame, replace [`Self::camera`] by the path's
    /// camera.
    pub path: Option<Path>,
    /// The geometry and tree.
    pub accel: Accel,
    /// The appearance of the geometry.
    pub appearance: Appearance,
    /// The lights that can add more than their ambient part, in the order of the file.
    /// Contributions are added in this order.
    pub lights: Vec<Light>,
    /// Colour of rays that hit nothing and were not mirrored.
    pub background: Vec3,
    /// Factor on the diffuse colour for the ambient part of all lights together, including lights
    /// without power.
    pub ambient: f32,
    /// Hemispheric ambient light, which is also the colour of mirror rays that hit nothing; `None`
    /// if the plan has none.
    pub hemisphere: Option<Hemisphere>,
    /// What is around the scene; `None` if the plan has nothing, and rays that hit nothing see the
    /// background or the hemispheric light.
    pub environment: Option<Environment>,
    /// What is inside of shapes, in the order of priority where they overlap.
    pub solids: Vec<Solid>,
    /// Which rays and which light count.
    pub visible: Visible,
    /// How often a ray may be mirrored or refracted; 0 if the plan has neither.
    pub bounces: u32,
    /// The number of triangles of the file that were dropped, as they have no area.
    pub degenerate: u64,
}

/// The appearance of the primitives: shapes, materials and textures.
#[derive(Debug, Default)]
pub struct Appearance {
    /// The shapes by the number of their first primitive, in rising order.
    pub shapes: Vec<Shape>,
    /// The classes of shapes.
    pub classes: Vec<Class>,
    /// For each shape the path of its entry in the scene file.
    pub paths: Vec<String>,
    /// The names of shapes.
    pub names: Vec<Option<String>>,
    /// The index in `shapes` of a ground that is no part of the file.
    pub ground: Option<usize>,
    /// The images that may be visible, each once.
    pub images: Vec<LazyImage>,
    /// The images of cut-outs, which decide hits.
    pub cutouts: Vec<Arc<LazyImage>>,
    /// The attributes in use of meshes.
    pub meshes: Vec<MeshAttributes>,
}

/// One shape of the scene file, or of a light.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    /// Its primitives, by number.
    pub primitives: Range<u32>,
    /// The colour of the light whose shape it is, shown unlit; `None` for others.
    pub light: Option<Vec3>,
    /// Whether its front is where its winding is clockwise.
    pub flipped: bool,
    /// Whether lights reach its back.
    pub two_sided: bool,
    /// Whether it is shaded with the normals of its mesh.
    pub smooth: bool,
    /// Whether vertex colours of its mesh multiply its base colour.
    pub colored: bool,
    /// Index of its class in [`Appearance::classes`].
    pub class: u32,
    /// Index of its mesh in [`Appearance::meshes`].
    pub mesh: Option<u32>,
    /// Index in [`PreparedScene::solids`] of what its front encloses, if light goes through that.
    pub solid: Option<u32>,
}

/// An image and its mapping to a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Index in [`Appearance::images`].
    pub image: u32,
    /// Filtering between texels.
    pub filter: Filter,
    /// Wrap mode of coordinates outside 0 to 1.
    pub wrap: Wrap,
    /// Its coordinates.
    pub coordinates: Coordinates,
}

/// The texture coordinates of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinates {
    /// The map from points.
    pub map: UvMap,
    /// A change of its coordinates, if any.
    pub placing: Option<Placing>,
}

/// Values at the corners of a mesh's triangles.
#[derive(Clone, Debug, Default)]
pub struct MeshAttributes {
    /// The number of the mesh's first triangle.
    pub first_triangle: u32,
    /// The number of the mesh's first position.
    pub first_position: u32,
    /// Shading normals in world space.
    pub normals: Option<CornerValues<Vec3>>,
    /// Texture coordinates.
    pub uvs: Option<CornerValues<Vec2>>,
    /// Colours, linear.
    pub colors: Option<CornerValues<Vec3>>,
    /// The alphas of colours, where some are below 1 and opacity or cut-outs use them.
    pub alphas: Option<CornerValues<f32>>,
    /// The direction in which u grows, in world space, with the sign of the bitangent, which is
    /// orthogonal to it and the normal.
    pub tangents: Option<CornerValues<Vec4>>,
}

impl Appearance {
    /// The index in [`Appearance::shapes`] of the shape that contains the primitive.
    #[inline]
    pub fn shape_of(&self, primitive: u32) -> usize {
        self.shapes.partition_point(|shape| shape.primitives.start <= primitive) - 1
    }

    /// As [`Self::shape_of`], of a primitive that is likely on the shape at this index.
    #[inline(always)]
    pub fn shape_beside(&self, shape: usize, primitive: u32) -> usize {
        match self.shapes.get(shape) {
            Some(known) if known.primitives.contains(&primitive) => shape,
            _ => self.shape_of(primitive),
        }
    }

    /// The class of a shape.
    #[inline(always)]
    pub fn class(&self, shape: &Shape) -> &Class {
        &self.classes[shape.class as usize]
    }

    /// The images of textures and of cut-outs.
    pub fn all_images(&self) -> impl Iterator<Item = &LazyImage> {
        self.images.iter().chain(self.cutouts.iter().map(Arc::as_ref))
    }

    /// Decodes all images that are not decoded yet.
    ///
    /// # Errors
    /// If an image cannot be decoded.
    pub fn decode(&self) -> Result<()> {
        self.all_images().try_for_each(|image| image.get().map(|_| ()))
    }

    /// Checks that every image looked up so far could be decoded.
    ///
    /// # Errors
    /// If one could not be decoded.
    pub fn check(&self) -> Result<()> {
        let failure = self.all_images().find_map(|image| image.decoded()?.as_ref().err());
        failure.cloned().map_or(Ok(()), Err)
    }

    /// Bytes held by attributes and images.
    pub fn bytes(&self) -> u64 {
        let meshes: usize = self
            .meshes
            .iter()
            .map(|mesh| {
                mesh.normals.as_ref().map_or(0, CornerValues::bytes)
                    + mesh.uvs.as_ref().map_or(0, CornerValues::bytes)
                    + mesh.colors.as_ref().map_or(0, CornerValues::bytes)
                    + mesh.alphas.as_ref().map_or(0, CornerValues::bytes)
                    + mesh.tangents.as_ref().map_or(0, CornerValues::bytes)
            })
            .sum();
        meshes as u64 + self.all_images().map(LazyImage::bytes).sum::<u64>()
    }
}
