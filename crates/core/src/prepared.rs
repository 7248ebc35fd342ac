//! The scene as the tracers see it: dense arrays, a tree and a plan, immutable while rendering.

mod appearance;
mod detail;
mod fingerprint;
mod footprint;
mod interaction;
mod normal_map;
mod resample;

use std::ops::Range;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4};

pub use detail::{Detail, Metal, Occlusion};
pub use fingerprint::Fingerprints;
pub use footprint::MirrorPoint;
pub use interaction::{Face, Group, Interaction, lanes};
pub use normal_map::NormalMap;
pub use resample::{Original, Samples};

use crate::accel::Accel;
use crate::kernels::blinn_phong::Material;
use crate::kernels::camera::Camera;
use crate::kernels::camera::path::Path;
pub use crate::kernels::corners::{CornerValues, NO_VALUE};
use crate::kernels::hemisphere::Hemisphere;
use crate::kernels::light::Light;
use crate::kernels::texture::{Filter, Wrap};
pub use crate::kernels::texture::{LazyImage, Placing, UvMap};
use crate::plan::Plan;
use wavecrest_base::error::Result;

/// Everything that a render reads.
#[derive(Debug)]
pub struct PreparedScene {
    /// What is simulated.
    pub plan: Plan,
    /// Where the origin of all coordinates here lies in the scene's, in scene units.
    pub origin: DVec3,
    /// Where rays start.
    pub camera: Camera,
    /// How the camera moves, if it does. A frame is rendered once its camera has taken the place of
    /// [`Self::camera`].
    pub path: Option<Path>,
    /// What they hit.
    pub accel: Accel,
    /// What they hit looks like.
    pub appearance: Appearance,
    /// What lights it: the lights that can add more than their ambient part, in the order of the file.
    /// Contributions are added in this order.
    pub lights: Vec<Light>,
    /// What a primary ray that hits nothing returns.
    pub background: Vec3,
    /// Factor on the diffuse colour for the ambient part of all lights together, those without
    /// power too.
    pub ambient: f32,
    /// Ambient light by the normal, and what mirror rays that hit nothing show; `None` where the plan has none.
    pub hemisphere: Option<Hemisphere>,
    /// Greatest number of mirror bounces; 0 where the plan has no mirrors.
    pub bounces: u32,
    /// What the file held but the scene does not.
    pub dropped: Dropped,
}

/// What was left out while preparing, and how often.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Dropped {
    /// Triangles without area.
    pub degenerate: u64,
}

/// Work done to find out what surfaces look like, for the statistics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LookUps {
    /// Hits whose colour was interpolated between vertices.
    pub colors: u64,
    /// Texels read.
    pub texels: u64,
    /// Footprints of rays: one for each look-up in a trilinear texture, and one for each mirror ray
    /// where there are such textures.
    pub footprints: u64,
}

/// The appearance of the primitives: shapes, what they are made of, and their textures.
#[derive(Debug, Default)]
pub struct Appearance {
    /// The shapes by the number of their first primitive, in rising order.
    pub shapes: Vec<Shape>,
    /// What shapes are made of, one for each shape.
    pub materials: Vec<Material>,
    /// Where shapes come from: for each the path of its entry in the scene file.
    pub places: Vec<String>,
    /// What the user calls shapes.
    pub names: Vec<Option<String>>,
    /// What some shapes show besides, each for all shapes that show the same.
    pub details: Vec<Detail>,
    /// The images that can be seen, each once.
    pub images: Vec<LazyImage>,
    /// The images of cut-outs, which hits are tested with.
    pub cutouts: Vec<Arc<LazyImage>>,
    /// The attributes of meshes that have any that is used.
    pub meshes: Vec<MeshAttributes>,
}

/// One shape of the scene file, or of a light.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Its primitives, by number.
    pub primitives: Range<u32>,
    /// For a light's shape, the light's colour, which it shows as it is.
    pub emission: Option<Vec3>,
    /// Whether its front is where its winding runs clockwise.
    pub flipped: bool,
    /// Whether lights reach its back.
    pub two_sided: bool,
    /// Whether it is lit with the normals of its mesh.
    pub smooth: bool,
    /// Whether the colours of its mesh's vertices multiply its diffuse colour.
    pub colored: bool,
    /// The image in place of its diffuse colour.
    pub texture: Option<Texture>,
    /// What it shows besides, by its entry in [`Appearance::details`].
    pub detail: Option<u32>,
    /// The mesh's entry in [`Appearance::meshes`].
    pub mesh: Option<u32>,
}

/// An image and how a shape wears it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Which of [`Appearance::images`].
    pub image: u32,
    /// How a look-up between texels is answered.
    pub filter: Filter,
    /// How coordinates outside 0 to 1 are taken.
    pub wrap: Wrap,
    /// How points become coordinates.
    pub map: UvMap,
    /// How these are changed, if they are.
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
    pub uvs: Option<Arc<CornerValues<Vec2>>>,
    /// Colours, linear.
    pub colors: Option<CornerValues<Vec3>>,
    /// Where u grows, in world space; and the sign of the bitangent, which is across the normal and this.
    pub tangents: Option<CornerValues<Vec4>>,
}

impl Appearance {
    /// The shape that the primitive belongs to, by its place in [`Appearance::shapes`].
    #[inline]
    pub fn shape_of(&self, primitive: u32) -> usize {
        self.shapes.partition_point(|shape| shape.primitives.start <= primitive) - 1
    }

    /// The images of textures and of cut-outs.
    fn all_images(&self) -> impl Iterator<Item = &LazyImage> {
        self.images.iter().chain(self.cutouts.iter().map(Arc::as_ref))
    }

    /// Decodes every image that is not yet.
    ///
    /// # Errors
    /// When one cannot be decoded.
    pub fn decode(&self) -> Result<()> {
        self.all_images().try_for_each(|image| image.get().map(|_| ()))
    }

    /// Nothing, where every image that was looked up so far could be decoded.
    ///
    /// # Errors
    /// When one could not.
    pub fn check(&self) -> Result<()> {
        let failure = self.all_images().find_map(|image| image.decoded()?.as_ref().err());
        failure.cloned().map_or(Ok(()), Err)
    }

    /// Bytes held by attributes, details and images.
    pub fn bytes(&self) -> u64 {
        self.attribute_bytes() + self.all_images().map(LazyImage::bytes).sum::<u64>()
    }

    /// Bytes held by attributes and details, and by images once all are decoded.
    pub fn expected_bytes(&self) -> u64 {
        self.attribute_bytes() + self.all_images().map(LazyImage::expected_bytes).sum::<u64>()
    }

    fn attribute_bytes(&self) -> u64 {
        let meshes: usize = self
            .meshes
            .iter()
            .map(|mesh| {
                mesh.normals.as_ref().map_or(0, CornerValues::bytes)
                    + mesh.uvs.as_ref().map_or(0, |uvs| uvs.bytes())
                    + mesh.colors.as_ref().map_or(0, CornerValues::bytes)
                    + mesh.tangents.as_ref().map_or(0, CornerValues::bytes)
            })
            .sum();
        (meshes + size_of_val(self.details.as_slice())) as u64
    }
}
