//! What a surface wears.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;

/// A texture in place of the diffuse colour.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureRef {
    /// Where the image is.
    pub source: TextureSource,
    /// What its numbers stand for.
    pub encoding: Encoding,
    /// What every texel is multiplied by, once it is linear.
    pub tint: DVec3,
    /// How a look-up between texels is answered.
    pub filter: Filter,
    /// How coordinates outside 0 to 1 are taken.
    pub wrap: Wrap,
    /// How coordinates are changed before the look-up, if they are.
    pub placing: Option<Placing>,
}

/// Two rows that act on texture coordinates [u, v, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing(pub [[f64; 3]; 2]);

/// Textures of other things than the diffuse colour. None is tinted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Maps {
    /// Of the material's own light, which it multiplies.
    pub emission: Option<TextureRef>,
    /// Of metal and roughness, from which with the colour the rest of the material follows.
    pub metal: Option<MetalMap>,
    /// Of the share of ambient light that arrives, in red.
    pub occlusion: Option<StrengthMap>,
    /// Of normals: red along u, green along v, blue along the surface's own; a number x stands for 2 x - 1.
    pub normal: Option<StrengthMap>,
}

impl Maps {
    /// Those that there are, by their keys in a scene file.
    pub fn all(&self) -> impl Iterator<Item = (&'static str, &TextureRef)> {
        let all = [
            ("emissionmap", self.emission.as_ref()),
            ("metalmap", self.metal.as_ref().map(|map| &map.texture)),
            ("occlusionmap", self.occlusion.as_ref().map(|map| &map.texture)),
            ("normalmap", self.normal.as_ref().map(|map| &map.texture)),
        ];
        all.into_iter().filter_map(|(key, texture)| Some((key, texture?)))
    }

    /// As [`Maps::all`], to be changed.
    pub fn all_mut(&mut self) -> impl Iterator<Item = &mut TextureRef> {
        let metal = self.metal.as_mut().map(|map| &mut map.texture);
        let occlusion = self.occlusion.as_mut().map(|map| &mut map.texture);
        let normal = self.normal.as_mut().map(|map| &mut map.texture);
        [self.emission.as_mut(), metal, occlusion, normal].into_iter().flatten()
    }
}

/// A texture of metal, in blue, and of roughness, in green.
#[derive(Clone, Debug, PartialEq)]
pub struct MetalMap {
    /// The texture.
    pub texture: TextureRef,
    /// Factor on metal, 0 to 1.
    pub metallic: f64,
    /// Factor on roughness, 0 to 1.
    pub roughness: f64,
}

/// A texture that counts as far as its strength says.
#[derive(Clone, Debug, PartialEq)]
pub struct StrengthMap {
    /// The texture.
    pub texture: TextureRef,
    /// 0 is not at all, 1 as it is.
    pub strength: f64,
}

pub use wavecrest_core::kernels::texture::{Filter, Wrap};

/// Holes in a surface, where the alpha of an image is low.
#[derive(Clone, Debug, PartialEq)]
pub struct CutOut {
    /// Where the image is.
    pub source: TextureSource,
    /// Whether brightness stands for the alpha of an image that has none; else such an image has no hole.
    pub is_mask: bool,
    /// The least alpha that is there, above 0.
    pub threshold: f64,
    /// How a look-up between texels is answered.
    pub filter: Filter,
    /// How coordinates outside 0 to 1 are taken.
    pub wrap: Wrap,
    /// How coordinates are changed before the look-up, if they are.
    pub placing: Option<Placing>,
}

/// Where the image of a texture is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextureSource {
    /// In a file of its own: the path, already joined to the scene file's folder.
    File(PathBuf),
    /// Within the scene file.
    Embedded {
        /// Where there, such as `images[2]`: one name for one image.
        place: String,
        /// A file of any image format.
        bytes: Arc<[u8]>,
    },
}

wavecrest_base::choices! {
    /// What the numbers of an image stand for.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Encoding {
        /// Light, as they are.
        #[default]
        Linear = "linear",
        /// Light behind the sRGB curve, as in most photographs and painted textures.
        Srgb = "srgb",
    }
}
