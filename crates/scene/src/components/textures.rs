//! Textures of a surface.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;

/// A texture that replaces the diffuse colour.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureRef {
    /// The image.
    pub source: TextureSource,
    /// The encoding of its values.
    pub encoding: Encoding,
    /// A linear factor on every texel.
    pub tint: DVec3,
    /// Filtering between texels.
    pub filter: Filter,
    /// Wrap mode of coordinates outside 0 to 1.
    pub wrap: Wrap,
    /// A change of the coordinates before the look-up, if any.
    pub placing: Option<Placing>,
}

/// Two rows of a matrix that acts on texture coordinates [u, v, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing(pub [[f64; 3]; 2]);

/// Textures of properties other than the diffuse colour. None is tinted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Maps {
    /// Multiplies the material's emission.
    pub emission: Option<TextureRef>,
    /// Metalness and roughness, which determine the rest of the material together with the colour.
    pub metal: Option<MetalMap>,
    /// The share of ambient light that arrives, in the red channel.
    pub occlusion: Option<StrengthMap>,
    /// Normals: red along u, green along v, blue along the surface normal; a value x stands for 2 x
    /// - 1.
    pub normal: Option<StrengthMap>,
}

impl Maps {
    /// The maps that are set, with their keys in a scene file.
    pub fn all(&self) -> impl Iterator<Item = (&'static str, &TextureRef)> {
        let all = [
            ("emissionmap", self.emission.as_ref()),
            ("metalmap", self.metal.as_ref().map(|map| &map.texture)),
            ("occlusionmap", self.occlusion.as_ref().map(|map| &map.texture)),
            ("normalmap", self.normal.as_ref().map(|map| &map.texture)),
        ];
        all.into_iter().filter_map(|(key, texture)| Some((key, texture?)))
    }

    /// As [`Maps::all`], mutable.
    pub fn all_mut(&mut self) -> impl Iterator<Item = &mut TextureRef> {
        let metal = self.metal.as_mut().map(|map| &mut map.texture);
        let occlusion = self.occlusion.as_mut().map(|map| &mut map.texture);
        let normal = self.normal.as_mut().map(|map| &mut map.texture);
        [self.emission.as_mut(), metal, occlusion, normal].into_iter().flatten()
    }
}

/// A texture of metalness, in blue, and of roughness, in green.
#[derive(Clone, Debug, PartialEq)]
pub struct MetalMap {
    /// The texture.
    pub texture: TextureRef,
    /// Factor on the metalness, 0 to 1.
    pub metallic: f64,
    /// Factor on the roughness, 0 to 1.
    pub roughness: f64,
}

impl MetalMap {
    /// Whether all texels give the same material.
    pub(crate) fn is_constant(&self) -> bool {
        [self.metallic, self.roughness].iter().all(|&factor| factor as f32 == 0.0)
    }
}

/// A texture with a strength.
#[derive(Clone, Debug, PartialEq)]
pub struct StrengthMap {
    /// The texture.
    pub texture: TextureRef,
    /// 0 for no effect, 1 for the full effect.
    pub strength: f64,
}

impl StrengthMap {
    /// Whether the texture changes anything.
    pub(crate) fn has_effect(&self) -> bool {
        self.strength as f32 != 0.0
    }
}

pub use wavecrest_core::kernels::texture::{Filter, Wrap};

/// Holes in a surface, where the alpha of an image is low.
#[derive(Clone, Debug, PartialEq)]
pub struct CutOut {
    /// The image.
    pub source: TextureSource,
    /// Whether brightness replaces a missing alpha channel; otherwise an image without alpha has no
    /// holes.
    pub is_mask: bool,
    /// The lowest alpha that is opaque, above 0.
    pub threshold: f64,
    /// Filtering between texels.
    pub filter: Filter,
    /// Wrap mode of coordinates outside 0 to 1.
    pub wrap: Wrap,
    /// A change of the coordinates before the look-up, if any.
    pub placing: Option<Placing>,
}

/// The source of a texture's image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextureSource {
    /// A separate file: the path, already joined to the scene file's folder.
    File(PathBuf),
    /// Within the scene file.
    Embedded {
        /// The place in the file, such as `images[2]`: unique for each image.
        place: String,
        /// An image file of any format.
        bytes: Arc<[u8]>,
    },
}

wavecrest_base::choices! {
    /// The encoding of an image's values.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Encoding {
        /// Linear.
        #[default]
        Linear = "linear",
        /// sRGB-encoded, as in most photographs and painted textures.
        Srgb = "srgb",
    }
}
