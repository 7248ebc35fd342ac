//! Materials: from metallic-roughness to Blinn-Phong with a mirror.
//!
//! The models differ, so the rule is our own; [`Material::metal`] states it. Unsupported properties are
//! reported. A surface with weak or textured emission shows it; one with even emission as bright as
//! white becomes a light.

use glam::DVec3;

use crate::components::{Channels, Encoding, Map, Maps, Material, Sides, TextureRef, Transparency};
use crate::format::Range;
use crate::staging;
use crate::surface::THRESHOLD;
use wavecrest_base::error::Result;
use wavecrest_core::kernels::metal::DIELECTRIC;

use super::fields::Fields;
use super::texture::TextureInfo;

/// An element of `materials`, or the default material.
#[derive(Clone, Debug)]
pub(super) struct MaterialElement {
    model: MetallicRoughness,
    /// The lowest opaque alpha; 0 if alpha is ignored or blends.
    cutoff: f64,
    /// Whether alpha is opacity.
    pub(super) blends: bool,
    /// Light that goes through, but for its opacity and colour.
    transparency: Transparency,
    /// The texture of the emission.
    glow: Option<TextureInfo>,
    /// The textures of ambient light and of normals.
    occlusion: Option<TextureInfo>,
    normal: Option<TextureInfo>,
    /// Whether it shows its plain colour under any light.
    is_unlit: bool,
    /// Which sides lights reach.
    pub(super) sides: Sides,
    /// Its emission, black for none.
    pub(super) emission: DVec3,
    /// The material in place of all that.
    own: Option<Material>,
}

/// The parameters of the model of reflection.
#[derive(Clone, Debug)]
struct MetallicRoughness {
    base_color: DVec3,
    /// The alpha of the base colour, a factor on that of its texture.
    alpha: f64,
    /// The texture of the base colour.
    texture: Option<TextureInfo>,
    /// The texture of metalness and roughness.
    metal: Option<TextureInfo>,
    metallic: f64,
    roughness: f64,
}

/// The extension with colours of scattered and of mirrored light in place of metalness.
pub(super) const GLOSS: &str = "KHR_materials_pbrSpecularGlossiness";

/// The texture under a key, whose strength is under the key `scale`, if any.
fn texture(of: &Fields<'_>, key: &str, scale: Option<&str>) -> Result<Option<TextureInfo>> {
    of.object(key)?.map(|found| TextureInfo::read(&found, scale)).transpose()
}

impl MetallicRoughness {
    /// That of an element of `materials`.
    fn of(fields: &Fields<'_>) -> Result<Self> {
        let usual = fields.object("pbrMetallicRoughness")?;
        match fields.extension(GLOSS, Self::of_gloss)?.filter(|_| usual.is_none()) {
            Some(gloss) => Ok(gloss),
            None => Self::read(&usual.unwrap_or(fields.nothing())),
        }
    }

    fn read(model: &Fields<'_>) -> Result<Self> {
        let [r, g, b, alpha] = model.numbers("baseColorFactor", Range::UNIT)?.unwrap_or([1.0; 4]);
        Ok(Self {
            base_color: DVec3::new(r, g, b),
            alpha,
            texture: texture(model, "baseColorTexture", None)?,
            metal: texture(model, "metallicRoughnessTexture", None)?,
            metallic: model.number_or("metallicFactor", Range::UNIT, 1.0)?,
            roughness: model.number_or("roughnessFactor", Range::UNIT, 1.0)?,
        })
    }

    /// That of the extension [`GLOSS`]: a metal if it mirrors more than it scatters.
    fn of_gloss(model: &Fields<'_>) -> Result<Self> {
        let [r, g, b, alpha] = model.numbers("diffuseFactor", Range::UNIT)?.unwrap_or([1.0; 4]);
        let (diffuse, own) = (DVec3::new(r, g, b), texture(model, "diffuseTexture", None)?);
        let specular = model.vector_or("specularFactor", Range::UNIT, DVec3::ONE)?;
        let has_map = model.get("specularGlossinessTexture").is_some();
        if has_map {
            let message = "the texture of specular and gloss is ignored";
            model.warn(message, "it scatters its diffuse colour");
        }
        let is_metal = !has_map && specular.max_element() > diffuse.max_element().max(DIELECTRIC);
        let gloss = model.number_or("glossinessFactor", Range::UNIT, 1.0)?;
        Ok(Self {
            base_color: if is_metal { specular } else { diffuse },
            alpha,
            texture: own.filter(|_| !is_metal),
            metal: None,
            metallic: if is_metal { 1.0 } else { 0.0 },
            roughness: if has_map { 1.0 } else { 1.0 - gloss },
        })
    }
}

impl MaterialElement {
    /// Reads an element of `materials`; of nothing, the format's default material: white, and fully
    /// rough.
    pub(super) fn read(fields: &Fields<'_>) -> Result<Self> {
        let cutoff = fields.number_or("alphaCutoff", Range::NOT_NEGATIVE, THRESHOLD)?;
        let mode = fields.get("alphaMode").and_then(|cursor| cursor.value().as_str());
        Ok(Self {
            cutoff: if mode == Some("MASK") { cutoff } else { 0.0 },
            blends: mode == Some("BLEND"),
            sides: if fields.flag("doubleSided")? { Sides::Both } else { Sides::Front },
            transparency: transparency(fields)?,
            emission: emission(fields)?,
            is_unlit: fields.extension("KHR_materials_unlit", |_| Ok(()))?.is_some(),
            glow: texture(fields, "emissiveTexture", None)?,
            occlusion: texture(fields, "occlusionTexture", Some("strength"))?,
            normal: texture(fields, "normalTexture", Some("scale"))?,
            model: MetallicRoughness::of(fields)?,
            own: None,
        })
    }

    /// That of meshes from files of meshes, in place of the format's default: alpha is opacity.
    pub(super) fn of_meshes(self) -> Self {
        Self { own: Some(staging::MATERIAL), blends: true, sides: Sides::Both, ..self }
    }

    /// The material, with or without an emission texture.
    pub(super) fn material(&self, glow: Option<&Map>) -> Material {
        if let Some(own) = self.own {
            return own;
        }
        if self.is_unlit {
            let diffuse_color = self.model.base_color;
            return Material { diffuse_color, unlit: true, ..Material::MATTE };
        }
        // Such a texture is usually mostly black: without it, even emission would be wrong.
        let is_whole = glow.is_some() == self.glow.is_some();
        let material =
            Material::metal(self.model.base_color, self.model.metallic, self.model.roughness);
        Material {
            // Light that goes through is not scattered.
            kd: material.kd * (1.0 - self.transparency(false).kt),
            emission: if is_whole { self.emission } else { DVec3::ZERO },
            ..material
        }
    }

    /// The metal map of a base colour that varies, if it needs one in place of constants: fully rough
    /// metals mirror nothing.
    pub(super) fn metal_by_color(&self) -> Option<Map> {
        let (metallic, roughness) = (self.model.metallic, self.model.roughness);
        let is_seen = !self.is_unlit && metallic > 0.0 && roughness < 1.0;
        is_seen.then_some(Map { texture: None, strength: 1.0, metallic, roughness })
    }

    /// The light that goes through it, tinted by the base colour, which may vary: metals let none through.
    pub(super) fn transparency(&self, varies: bool) -> Transparency {
        Transparency {
            opacity: if self.blends { self.model.alpha } else { 1.0 },
            kt: match &self.model.metal {
                _ if self.is_unlit => 0.0,
                // The texture is mostly that of the roughness.
                Some(_) => self.transparency.kt,
                None => self.transparency.kt * (1.0 - self.model.metallic),
            },
            color: match (varies, self.transparency.thin) {
                (true, _) => DVec3::ONE,
                (false, true) => self.model.base_color,
                // Once on the way in and out.
                (false, false) => self.model.base_color.powf(0.5),
            },
            tinted: varies,
            ..self.transparency
        }
    }

    /// The textures of the colour and of other properties, as far as `texture` returns them for
    /// their key, encoding and factor.
    pub(super) fn textures(
        &self,
        mut texture: impl FnMut(&TextureInfo, Encoding, DVec3) -> Option<TextureRef>,
    ) -> (Option<TextureRef>, Maps) {
        let mut of = |info: &Option<TextureInfo>, encoding, tint| {
            info.as_ref().and_then(|info| texture(info, encoding, tint))
        };
        let alpha = of(&self.model.texture.filter(|_| self.blends), Encoding::Linear, DVec3::ONE);
        let opacity =
            alpha.map(|texture| TextureRef { channels: Channels::Alpha, ..texture }.into());
        let color = of(&self.model.texture, Encoding::Srgb, self.model.base_color);
        if self.is_unlit {
            return (color, Maps { opacity, ..Maps::default() });
        }
        let shows_light = self.emission != DVec3::ZERO;
        let glow = self.glow.filter(|_| shows_light);
        let mut plain = |info: Option<TextureInfo>| -> Option<Map> {
            let texture = of(&info, Encoding::Linear, DVec3::ONE)?;
            Some(Map { strength: info?.strength, ..texture.into() })
        };
        let (metallic, roughness) = (self.model.metallic, self.model.roughness);
        let metal = plain(self.model.metal).map(|map| Map { metallic, roughness, ..map });
        let (occlusion, normal) = (plain(self.occlusion), plain(self.normal));
        let emission = of(&glow, Encoding::Srgb, DVec3::ONE).map(Map::from);
        (color, Maps { emission, metal, occlusion, normal, opacity })
    }

    /// The lowest opaque alpha of its texture; 0 if everything is opaque, `None` if nothing is.
    pub(super) fn threshold(&self) -> Option<f64> {
        match self.cutoff {
            0.0 => (!self.blends || self.model.alpha > 0.0).then_some(0.0),
            // The alpha of its texture is at most 1.
            cutoff => (cutoff <= self.model.alpha).then(|| cutoff / self.model.alpha),
        }
    }

    /// Whether the surface is a light.
    pub(super) fn is_light(&self) -> bool {
        !self.is_unlit && self.glow.is_none() && self.emission.max_element() >= BRIGHT
    }
}

/// The emission from which on a surface is a light: that of a white surface that faces all lights.
const BRIGHT: f64 = 1.0;

fn emission(fields: &Fields<'_>) -> Result<DVec3> {
    let factor = fields.vector_or("emissiveFactor", Range::NOT_NEGATIVE, DVec3::ZERO)?;
    let strength = fields.extension("KHR_materials_emissive_strength", |found| {
        found.number_or("emissiveStrength", Range::NOT_NEGATIVE, 1.0)
    })?;
    Ok(factor * strength.unwrap_or(1.0))
}

/// Light that goes through the surface: without a volume, it is a thin sheet.
fn transparency(fields: &Fields<'_>) -> Result<Transparency> {
    let mut own = Transparency { thin: true, ..Transparency::OPAQUE };
    fields.extension("KHR_materials_transmission", |found| {
        if found.get("transmissionTexture").is_some() {
            found.warn("the texture of transmission is ignored", "its factor is used");
        }
        own.kt = found.number_or("transmissionFactor", Range::UNIT, own.kt)?;
        Ok(())
    })?;
    fields.extension("KHR_materials_ior", |found| {
        // Stands for a mirror at any angle, in materials converted from specular and gloss.
        if found.get("ior").is_some_and(|ior| ior.value().as_f64() == Some(0.0)) {
            found.warn("an index of refraction of 0 is ignored", "1.5 is used");
        } else {
            own.ior = found.number_or("ior", Transparency::IOR, own.ior)?;
        }
        Ok(())
    })?;
    fields.extension("KHR_materials_volume", |found| {
        if found.get("thicknessTexture").is_some() {
            found.warn("the texture of thickness is ignored", "its factor is used");
        }
        let number = |key| found.number_or(key, Range::NOT_NEGATIVE, 0.0);
        own.thin = number("thicknessFactor")? == 0.0;
        own.attenuation_color = found.vector_or("attenuationColor", Range::UNIT, DVec3::ONE)?;
        // Without a distance, nothing is absorbed.
        own.attenuation_distance = number("attenuationDistance")?;
        Ok(())
    })?;
    Ok(own)
}
