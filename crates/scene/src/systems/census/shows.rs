//! Visible properties of a shape's material.

use glam::{DVec3, Vec3};

use super::{Census, details};
use crate::components::{Filter, Maps, Material, TextureRef};

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
    /// The visible properties of the `i`th shape, a surface. `is_lit` if more than ambient light may
    /// reach it; `has_ambient` if there is ambient light.
    pub(super) fn of(census: Census<'_>, i: usize, is_lit: bool, has_ambient: bool) -> Self {
        let (world, entity) = (census.world, census.extracted.shapes[i].entity);
        let wears = world.get::<&TextureRef>(entity).is_ok();
        // The bounds on its material in any texel.
        let may = &census.materials[i];
        let mirrors = may.kr > 0.0 && census.settings.bounces > 0;
        let maps = world.get::<&Maps>(entity).ok();
        let metal = maps.as_ref().and_then(|maps| maps.metal.as_ref());
        let occlusion = maps.as_ref().and_then(|maps| maps.occlusion.as_ref());
        let by_normal = census.hemisphere.is_some_and(|light| !light.is_black());
        let color = world.get::<&Material>(entity).map_or(DVec3::ONE, |m| m.specular_color);
        let is_tinted = color != DVec3::ONE || metal.is_some_and(|map| map.metallic > 0.0);
        Self {
            // Diffuse colour is visible in ambient light, for any kd, and where it reflects light;
            // it also tints what metals mirror.
            texture: wears && (has_ambient || is_lit && may.kd > 0.0 || mirrors && metal.is_some()),
            emission: details::emission(world, entity) != Vec3::ZERO,
            metal: metal.is_some() && (is_lit || mirrors),
            occlusion: occlusion.is_some_and(|map| map.strength != 0.0) && has_ambient,
            tint: is_tinted && (is_lit && may.ks > 0.0 || mirrors),
            normal: maps.as_ref().is_some_and(|maps| maps.normal.is_some())
                && (is_lit || mirrors || by_normal),
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
