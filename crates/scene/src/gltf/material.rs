//! Materials: from metallic-roughness to Blinn-Phong with a mirror.
//!
//! The two models are not alike, so that the rule is ours; [`look`] states it. What it leaves out is
//! reported: blending, and all textures but that of the base colour. A surface that glows weakly shows its own light; one
//! that glows as brightly as white is a light.

use glam::DVec3;

use crate::components::{Material, Sides};
use crate::parse::THRESHOLD;
use crate::reader::Range;
use wavecrest_base::error::Result;

use super::fields::Fields;
use super::texture::TextureInfo;

/// An element of `materials`, or what a mesh without one has.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    base_color: DVec3,
    /// The alpha of the base colour, by which that of its texture is multiplied.
    alpha: f64,
    /// The least alpha that is there; 0 where alpha plays no part.
    cutoff: f64,
    /// The texture of the base colour.
    pub(super) texture: Option<TextureInfo>,
    metallic: f64,
    roughness: f64,
    is_unlit: bool,
    /// Which sides lights reach.
    pub(super) sides: Sides,
    /// Its own light, black for none.
    pub(super) emission: DVec3,
}

/// Factors of the format.
const UNIT: Range = Range::new(0.0, 1.0);

impl Surface {
    /// The format's default material: white, and as rough as can be.
    pub(super) const DEFAULT: Self = Self {
        base_color: DVec3::ONE,
        alpha: 1.0,
        cutoff: 0.0,
        texture: None,
        metallic: 1.0,
        roughness: 1.0,
        is_unlit: false,
        sides: Sides::Front,
        emission: DVec3::ZERO,
    };

    /// Reads an element of `materials`, of a file with so many textures.
    pub(super) fn read(fields: &Fields<'_>, textures: usize) -> Result<Self> {
        remark(fields);
        let cutoff = cutoff(fields)?;
        let sides = if fields.flag("doubleSided")? { Sides::Both } else { Sides::Front };
        let emission = emission(fields)?;
        let is_unlit = fields.extension("KHR_materials_unlit", |_| Ok(()))?.is_some();
        let default = Self { cutoff, sides, emission, is_unlit, ..Self::DEFAULT };
        let Some(model) = fields.object("pbrMetallicRoughness")? else { return Ok(default) };
        let base_color = model.numbers::<4>("baseColorFactor", UNIT)?;
        let texture = model.object("baseColorTexture")?;
        // Most of what such a texture covers is no metal; the factor alone would make all of it one.
        let is_mapped = model.get("metallicRoughnessTexture").is_some();
        let metallic = model.number_or("metallicFactor", UNIT, 1.0)?;
        Ok(Self {
            alpha: base_color.map_or(1.0, |color| color[3]),
            base_color: base_color.map_or(DVec3::ONE, |[r, g, b, _]| DVec3::new(r, g, b)),
            texture: texture.map(|found| TextureInfo::read(&found, textures)).transpose()?,
            metallic: if is_mapped { 0.0 } else { metallic },
            roughness: model.number_or("roughnessFactor", UNIT, 1.0)?,
            ..default
        })
    }

    /// What the surface is made of.
    pub(super) fn material(&self) -> Material {
        let reflecting = look(self.base_color, self.metallic, self.roughness);
        match self.is_unlit {
            true if self.texture.is_none() => Material {
                kd: 0.0,
                diffuse_color: DVec3::ZERO,
                emission: self.base_color,
                ..look(DVec3::ZERO, 0.0, 1.0)
            },
            true => Material { ks: 0.0, kr: 0.0, kd: 1.0, ..reflecting },
            false => Material { emission: self.emission, ..reflecting },
        }
    }

    /// What the texture is multiplied by.
    pub(super) fn tint(&self) -> DVec3 {
        self.base_color
    }

    /// The least alpha of its texture that is there; 0 where all is, `None` where nothing can be.
    pub(super) fn threshold(&self) -> Option<f64> {
        match self.cutoff {
            0.0 => Some(0.0),
            // Its texture has an alpha of 1 at most.
            cutoff => (cutoff <= self.alpha).then(|| cutoff / self.alpha),
        }
    }

    /// Whether the surface is a light.
    pub(super) fn is_light(&self) -> bool {
        !self.is_unlit && self.emission.max_element() >= BRIGHT
    }
}

/// The emission from which on a surface is a light: as bright as a white one that faces all lights.
const BRIGHT: f64 = 1.0;
/// What a smooth surface that is no metal reflects of light that falls on it straight.
const DIELECTRIC: f64 = 0.04;
/// The greatest exponent that comes of a roughness. Its highlight of a point is about a degree wide.
const GREATEST_EXPONENT: f64 = 10_000.0;

/// The material of a base colour C, metallic m and roughness r:
///
/// - kr = m (1 - r)^2: metals are mirrors as far as they are smooth,
/// - kd = 1 - kr, with the diffuse colour C: what is not mirrored is scattered,
/// - exponent n = 2 / r^4 - 2, rounded, at most 10 000: the width of the highlight of the format's model
///   (Karis, *Specular BRDF Reference*, 2013),
/// - ks = (1 - r) min(1, F (n + 2) / 8), with F = 0.04 (1 - m) + m times the mean of C: its height, less
///   what a rough surface scatters anyway.
///
/// Mirror and highlight are white.
pub(super) fn look(color: DVec3, metallic: f64, roughness: f64) -> Material {
    let kr = metallic * (1.0 - roughness) * (1.0 - roughness);
    let alpha = roughness * roughness;
    let exponent = (2.0 / (alpha * alpha) - 2.0).min(GREATEST_EXPONENT).round();
    let mean = (color.x + color.y + color.z) / 3.0;
    let straight = DIELECTRIC * (1.0 - metallic) + metallic * mean;
    let ks = (1.0 - roughness) * (straight * (exponent + 2.0) / 8.0).min(1.0);
    Material {
        ks,
        kd: 1.0 - kr,
        specular_exponent: exponent,
        diffuse_color: color,
        kr,
        emission: DVec3::ZERO,
    }
}

fn emission(fields: &Fields<'_>) -> Result<DVec3> {
    let factor = fields.numbers::<3>("emissiveFactor", Range::NOT_NEGATIVE)?;
    let strength = fields.extension("KHR_materials_emissive_strength", |found| {
        found.number_or("emissiveStrength", Range::NOT_NEGATIVE, 1.0)
    })?;
    let emission = factor.map_or(DVec3::ZERO, DVec3::from_array) * strength.unwrap_or(1.0);
    if emission != DVec3::ZERO && fields.get("emissiveTexture").is_some() {
        // Most of such a texture is black as a rule: a light all over would be wrong.
        let message = "a surface with an emissive texture gives off no light";
        fields.once(message, "leave the texture out, and all of it is a light");
        return Ok(DVec3::ZERO);
    }
    Ok(emission)
}

/// The least alpha that is there: what is blended is there or is not.
fn cutoff(fields: &Fields<'_>) -> Result<f64> {
    let cutoff = fields.number_or("alphaCutoff", Range::NOT_NEGATIVE, THRESHOLD)?;
    match fields.get("alphaMode").and_then(|cursor| cursor.value().as_str()) {
        Some("MASK") => Ok(cutoff),
        Some("BLEND") => {
            let message = "surfaces that are to be blended are cut out at an alpha of 0.5";
            fields.once(message, "nothing is seen through what is there");
            Ok(THRESHOLD)
        }
        _ => Ok(0.0),
    }
}

/// Tells what of a material is left out.
fn remark(fields: &Fields<'_>) {
    let model = fields.object("pbrMetallicRoughness").ok().flatten();
    if model.is_some_and(|model| model.get("metallicRoughnessTexture").is_some()) {
        let remedy = "the surface is no metal, of the roughness that its factor says";
        fields.once("a texture of metal and roughness is ignored", remedy);
    }
    if fields.get("normalTexture").is_some() || fields.get("occlusionTexture").is_some() {
        fields.once("textures of normals and occlusion are ignored", "the mesh alone has a form");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_follow_the_rule() {
        let white = |metallic, roughness| look(DVec3::ONE, metallic, roughness);
        let matte = white(0.0, 1.0);
        assert_eq!((matte.kd, matte.ks, matte.kr, matte.specular_exponent), (1.0, 0.0, 0.0, 0.0));
        let mirror = white(1.0, 0.0);
        assert_eq!((mirror.kd, mirror.kr, mirror.specular_exponent), (0.0, 1.0, 10_000.0));
        let plastic = white(0.0, 0.5);
        assert_eq!((plastic.kd, plastic.kr, plastic.specular_exponent), (1.0, 0.0, 30.0));
        assert!((plastic.ks - 0.08).abs() < 1e-12);
        for metallic in [0.0, 0.3, 1.0] {
            for roughness in [0.0, 1e-9, 0.2, 0.7, 1.0] {
                let Material { ks, kd, kr, specular_exponent, .. } = white(metallic, roughness);
                assert!((0.0..=1.0).contains(&ks) && (0.0..=1.0).contains(&kr) && kd + kr <= 1.0);
                assert!((0.0..=10_000.0).contains(&specular_exponent));
            }
        }
    }
}
