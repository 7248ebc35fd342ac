//! What a material of an MTL file is here. SCENES.md states the rule.

use glam::DVec3;

use super::Mtl;
use crate::components::{Encoding, Filter, Material, TextureRef, TextureSource, Wrap};

/// The models of lighting that mirror: with rays, as glass does, by Fresnel's law, and without rays.
const MIRRORS: [u32; 3] = [3, 5, 8];

/// The models without a highlight.
const MATT: [u32; 2] = [0, 1];

/// The sharpest highlight.
const SHARPEST: f64 = 1e6;

/// The material, and its texture where the image that it names is at a path, which `find` knows.
pub(crate) fn surface(
    mtl: &Mtl,
    find: impl FnOnce(&str) -> Option<std::path::PathBuf>,
) -> (Material, Option<TextureRef>) {
    let is_model = |models: &[u32]| mtl.illum.is_some_and(|model| models.contains(&model));
    let exponent = mtl.ns.unwrap_or(0.0).min(SHARPEST);
    let gloss = mtl.ks.map_or(0.0, |ks| ks.element_sum() / 3.0).min(1.0);
    let kr = if is_model(&MIRRORS) { gloss } else { 0.0 };
    // An exponent of 0 would be a highlight everywhere.
    let has_highlight = exponent > 0.0 && !is_model(&MATT);
    let texture = mtl.map_kd.as_ref().and_then(|map| Some((map.clamp, find(&map.name)?)));
    let kd = mtl.kd.unwrap_or(DVec3::ONE);
    let material = Material {
        ks: if has_highlight { gloss } else { 0.0 },
        kd: 1.0 - kr,
        specular_exponent: exponent,
        diffuse_color: kd,
        kr,
        emission: mtl.ke.unwrap_or(DVec3::ZERO),
    };
    let texture = texture.map(|(clamp, path)| TextureRef {
        source: TextureSource::File(path),
        encoding: Encoding::Srgb,
        // Many programs write black beside an image.
        tint: if kd == DVec3::ZERO { DVec3::ONE } else { kd },
        filter: Filter::Trilinear,
        wrap: if clamp { Wrap::Clamp } else { Wrap::Repeat },
    });
    (material, texture)
}
