//! Visible properties of a shape's material.

use glam::{DVec3, Vec3};

use super::{Census, Faces, details};
use crate::components::{Filter, Maps, Material, StrengthMap, TextureRef};

/// Which properties of a shape's material are visible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shows {
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
        let (world, output) = (census.world, &census.extracted.shapes[i]);
        let entity = output.entity;
        let wears = world.get::<&TextureRef>(entity).is_ok();
        // The bounds on its material in any texel.
        let may = &census.materials[i];
        let mirrors = may.kr > 0.0 && census.settings.bounces > 0 && faces.any();
        let maps = world.get::<&Maps>(entity).ok();
        let metal = maps.as_ref().and_then(|maps| maps.metal.as_ref());
        let varied = metal.filter(|map| !map.is_constant());
        let occlusion = maps.as_ref().and_then(|maps| maps.occlusion.as_ref());
        let normal = maps.as_ref().and_then(|maps| maps.normal.as_ref());
        let is_colored = wears || may.color != Vec3::ZERO;
        let by_normal = is_colored && census.hemisphere.is_some_and(|light| !light.is_black());
        let color = world.get::<&Material>(entity).map_or(DVec3::ONE, |m| m.specular_color);
        let is_tinted = metal.map_or(color != DVec3::ONE, |map| map.metallic > 0.0);
        Self {
            // Diffuse colour is visible in ambient light, for any kd, and where it reflects light;
            // it also tints what metals mirror.
            texture: wears
                && (has_ambient || is_lit && may.kd > 0.0 || mirrors && varied.is_some()),
            emission: details::emission(world, entity) != Vec3::ZERO,
            metal: varied.is_some() && (is_lit || mirrors),
            occlusion: occlusion.is_some_and(StrengthMap::has_effect) && has_ambient && is_colored,
            tint: is_tinted && (is_lit && may.ks > 0.0 || mirrors),
            normal: normal.is_some_and(StrengthMap::has_effect) && (is_lit || mirrors || by_normal),
        }
    }

    /// Whether any visible texture of the `i`th shape is trilinear.
    pub(super) fn trilinear(self, census: Census<'_>, i: usize) -> bool {
        let entity = census.extracted.shapes[i].entity;
        let is_trilinear = |texture: &TextureRef| texture.filter == Filter::Trilinear;
        let own = census.world.get::<&TextureRef>(entity);
        let maps = census.world.get::<&Maps>(entity);
        let shows = |key: &str| match key {
            "emissionmap" => self.emission,
            "metalmap" => self.metal,
            "occlusionmap" => self.occlusion,
            _ => self.normal,
        };
        self.texture && own.is_ok_and(|texture| is_trilinear(&texture))
            || maps.is_ok_and(|maps| maps.all().any(|(key, map)| shows(key) && is_trilinear(map)))
    }
}
