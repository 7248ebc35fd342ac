//! Visible properties of a shape's material.

use glam::{DVec3, Vec3};

use super::{Census, Faces};
use crate::components::{Filter, Map, Maps, SurfaceComponents, TextureRef};
use crate::surface::{EMISSION_MAP, METAL_MAP, OCCLUSION_MAP, OPACITY_MAP};
use wavecrest_core::plan::schedule::Step;

/// Which properties of a shape's material are visible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Shows {
    /// Its base colour, where vertex colours or a texture vary it.
    pub color: bool,
    /// The texture of its colour.
    pub texture: bool,
    /// Emission.
    pub emission: bool,
    /// The texture of metalness and roughness.
    pub metal: bool,
    /// The texture of ambient light.
    pub occlusion: bool,
    /// The colour of its highlight, or of mirrored light.
    pub tint: bool,
    /// The texture of its normals.
    pub normal: bool,
}

impl Shows {
    /// The visible properties of the `i`th shape, a surface of which these `faces` are visible and
    /// can be lit. `is_lit` if more than ambient light may reach them; `has_ambient` if there is
    /// ambient light.
    pub(super) fn of(
        census: Census<'_>,
        i: usize,
        (is_lit, faces): (bool, Faces),
        has_ambient: bool,
    ) -> Self {
        let SurfaceComponents { material, transparency, texture, maps, .. } = census.surfaces[i];
        let wears = texture.is_some();
        // The bounds on its material in any texel.
        let may = &census.materials[i];
        let mirrors = may.kr > 0.0 && census.settings.bounces > 0 && faces.any();
        let Maps { metal, occlusion, normal, .. } = maps;
        let varied = metal.as_ref().filter(|map| !map.is_constant());
        let is_colored = wears || may.color != Vec3::ZERO;
        let by_normal = is_colored && census.hemisphere.is_some_and(|light| !light.is_black());
        let color = material.map_or(DVec3::ONE, |m| m.specular_color);
        let is_tinted = metal.as_ref().map_or(color != DVec3::ONE, |map| map.metallic > 0.0);
        let is_unlit = material.is_some_and(|material| material.unlit);
        let is_tinted_through = transparency.is_some_and(|found| found.tinted && found.kt > 0.0);
        let has_ambient = has_ambient && may.ambient > 0.0;
        // Base colour is visible in ambient light, for any kd, and where it reflects light; it also
        // tints what metals mirror and what is refracted.
        let color = has_ambient
            || is_lit && may.kd > 0.0
            || mirrors && varied.is_some()
            || is_unlit
            || is_tinted_through;
        Self {
            color,
            texture: wears && color,
            emission: may.emission != Vec3::ZERO || is_unlit && is_colored,
            metal: varied.is_some() && (is_lit || mirrors || has_ambient),
            occlusion: occlusion.as_ref().is_some_and(Map::has_effect)
                && has_ambient
                // Rays find what is in the way.
                && !census.hemisphere.is_some_and(|light| light.traced)
                && is_colored,
            tint: is_tinted && (is_lit && may.ks > 0.0 || mirrors),
            normal: normal.as_ref().is_some_and(Map::has_effect)
                && (is_lit || mirrors || by_normal || census.extracted.shapes[i].is_transparent),
        }
    }

    /// The properties after a change of each, with the step that looks it up.
    pub(in crate::systems) fn map(self, change: impl Fn(Step, bool) -> bool) -> Self {
        Self {
            color: change(Step::Colors, self.color),
            texture: change(Step::Texels, self.texture),
            emission: change(Step::Emission, self.emission),
            metal: change(Step::Maps, self.metal),
            occlusion: change(Step::Maps, self.occlusion),
            tint: change(Step::Tints, self.tint),
            normal: change(Step::NormalMaps, self.normal),
        }
    }

    /// Whether any visible texture of the `i`th shape is trilinear.
    pub(super) fn trilinear(self, census: Census<'_>, i: usize) -> bool {
        let SurfaceComponents { texture, maps, .. } = census.surfaces[i];
        let is_trilinear = |texture: &TextureRef| texture.look_up.filter == Filter::Trilinear;
        let shows = |key: &str| match key {
            EMISSION_MAP => self.emission,
            METAL_MAP => self.metal,
            OCCLUSION_MAP => self.occlusion,
            OPACITY_MAP => census.extracted.shapes[i].is_transparent,
            _ => self.normal,
        };
        self.texture && texture.is_some_and(is_trilinear)
            || maps
                .all()
                .any(|(key, map)| shows(key) && map.texture.as_ref().is_some_and(is_trilinear))
    }
}
