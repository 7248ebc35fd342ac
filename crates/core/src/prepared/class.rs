//! Classes: what surfaces look like, as constants and as maps that change them from point to point.
//!
//! A new property is a constant of [`Material`] or a [`Property`] with its case in
//! `maps.rs`, and what shading makes of it.

use super::{Texture, UvMap};
use crate::kernels::{Material, Transparency};

/// What surfaces look like. Shapes that look the same share a class.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    /// The constants.
    pub material: Material,
    /// How light goes through it, if it does.
    pub transparency: Option<Transparency>,
    /// Maps that change the constants, in the order of [`Property`], one at most of each.
    pub maps: Vec<Map>,
    /// Whether it emits light, colours its highlights or keeps ambient light from being scattered.
    pub(super) is_special: bool,
    /// Whether a map is looked up at the texture coordinates of a mesh.
    pub(super) looks_up_uvs: bool,
    /// Whether vertices have opacities.
    pub(super) fades: bool,
    /// Whether what passes it straight depends on nothing but the angle: there are neither opacities nor
    /// colours to look up.
    pub(super) passes_evenly: bool,
}

/// A property that changes from point to point, and the texture that changes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The property.
    pub property: Property,
    /// The texture; `None` if every texel is white, and what changes is the base colour.
    pub texture: Option<Texture>,
}

/// A property of a class that a map changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Property {
    /// The texel replaces the base colour.
    Color,
    /// The texel multiplies the emission.
    Emission,
    /// Metalness, in blue, and roughness, in green: they determine all reflection parameters together
    /// with the base colour.
    Metal {
        /// Factor on the metalness, 0 to 1.
        metallic: f32,
        /// Factor on the roughness, 0 to 1.
        roughness: f32,
    },
    /// The share of ambient light that arrives, in red.
    Occlusion {
        /// Weight of the texture: 0 none, 1 full.
        strength: f32,
    },
    /// The shading normal, in the frame of tangent, bitangent and normal: a value x stands for 2 x - 1.
    Normal {
        /// Factor on the tangential part.
        strength: f32,
    },
    /// The opacity, in red, which multiplies the constant.
    Opacity,
    /// The alpha of vertex colours, which multiplies the opacity.
    Alpha,
    /// Emission by the base colour, in place of diffuse light.
    Unlit,
}

impl Class {
    /// The class with these constants and maps.
    pub fn new(material: Material, transparency: Option<Transparency>, maps: Vec<Map>) -> Self {
        let is_special = material.is_special();
        let is_of_mesh = |texture: &Texture| texture.coordinates.map == UvMap::Mesh;
        let looks_up_uvs = maps.iter().filter_map(|map| map.texture.as_ref()).any(is_of_mesh);
        let fades = maps.iter().any(|map| map.property == Property::Alpha);
        let is_even = |map: &Map| !matches!(map.property, Property::Opacity | Property::Alpha);
        let passes_evenly =
            maps.iter().all(is_even) && transparency.is_none_or(|through| !through.tinted);
        Self { material, transparency, maps, is_special, looks_up_uvs, fades, passes_evenly }
    }

    /// Whether its hits are shaded together with those of other such classes: all that it has are
    /// constants, and no path scatters there.
    #[inline(always)]
    pub fn is_plain(&self) -> bool {
        self.maps.is_empty() && self.transparency.is_none()
    }

    /// The texture of its base colour.
    pub fn color(&self) -> Option<&Texture> {
        self.maps.first().filter(|map| map.property == Property::Color)?.texture.as_ref()
    }

    /// The share of light that is refracted.
    pub(super) fn kt(&self) -> f32 {
        self.transparency.map_or(0.0, |transparency| transparency.kt)
    }

    pub(super) fn opacity(&self) -> f32 {
        self.transparency.map_or(1.0, |transparency| transparency.opacity)
    }
}
