//! Conversion of MTL materials. SCENES.md states the rule.

use std::path::PathBuf;

use glam::DVec3;

use super::Mtl;
use super::map::Map;
use crate::components::{CutOut, Encoding, Filter, Material, TextureRef, TextureSource, Wrap};
use crate::surface::THRESHOLD;

/// The lighting models with mirrors: with ray tracing, glass, and Fresnel without ray tracing.
const MIRRORS: [u32; 3] = [3, 5, 8];

/// The models without a highlight.
const MATT: [u32; 2] = [0, 1];

/// The sharpest highlight.
const SHARPEST: f64 = 1e6;

/// The appearance of a surface.
#[derive(Clone, Debug)]
pub(crate) struct Look {
    pub(crate) material: Material,
    pub(crate) texture: Option<TextureRef>,
    pub(crate) cutout: Option<CutOut>,
    /// Whether any of it is opaque.
    pub(crate) is_there: bool,
}

/// The material, with its images at the paths that `find` returns.
pub(crate) fn surface(mtl: &Mtl, mut find: impl FnMut(&str) -> Option<PathBuf>) -> Look {
    let is_model = |models: &[u32]| mtl.illum.is_some_and(|model| models.contains(&model));
    let exponent = mtl.ns.unwrap_or(0.0).min(SHARPEST);
    let gloss = mtl.ks.map_or(0.0, |ks| ks.element_sum() / 3.0).min(1.0);
    let kr = if is_model(&MIRRORS) { gloss } else { 0.0 };
    // An exponent of 0 would be a highlight everywhere.
    let has_highlight = exponent > 0.0 && !is_model(&MATT);
    let kd = mtl.kd.unwrap_or(DVec3::ONE);
    let mut found = |map: &Option<Map>| {
        let map = map.as_ref()?;
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        Some((TextureSource::File(find(&map.name)?), wrap))
    };
    let texture = found(&mtl.map_kd).map(|(source, wrap)| TextureRef {
        source,
        encoding: Encoding::Srgb,
        // Many programs write black if there is an image.
        tint: if kd == DVec3::ZERO { DVec3::ONE } else { kd },
        filter: Filter::Trilinear,
        wrap,
        placing: None,
    });
    let (filter, d) = (Filter::Bilinear, mtl.d.unwrap_or(1.0));
    let cutout = found(&mtl.map_d).filter(|_| d >= THRESHOLD).map(|(source, wrap)| CutOut {
        source,
        is_mask: true,
        // d multiplies the image's alpha.
        threshold: THRESHOLD / d,
        filter,
        // In a scene file both share the wrap mode.
        wrap: texture.as_ref().map_or(wrap, |texture| texture.wrap),
        placing: None,
    });
    let material = Material {
        ks: if has_highlight { gloss } else { 0.0 },
        kd: 1.0 - kr,
        specular_exponent: exponent,
        diffuse_color: kd,
        kr,
        emission: mtl.ke.unwrap_or(DVec3::ZERO),
        specular_color: DVec3::ONE,
    };
    Look { material, texture, cutout, is_there: d >= THRESHOLD }
}
