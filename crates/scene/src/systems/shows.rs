//! Which properties of a shape's material are visible: only they are looked up.

use glam::{DVec3, Vec3};
use hecs::World;

use super::frame::Frame;
use super::lights;
use super::sky::hemisphere;
use super::surface::{SurfaceColumns, SurfaceComponents};
use super::textures::Images;
use super::visibility::{Faces, MaterialBound, Shows, Source, Visibility};
use crate::components::{Filter, Map, Maps, TextureRef};
use crate::surface::{EMISSION_MAP, METAL_MAP, OCCLUSION_MAP, OPACITY_MAP};
use wavecrest_base::error::Result;
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::hemisphere::Hemisphere;
use wavecrest_core::plan::schedule::Step;
use wavecrest_core::prepared::Shape;

/// Finds the visible properties of each shape.
///
/// # Errors
/// If the image of an occlusion map cannot be decoded: one that is 1 everywhere does not show.
pub(crate) fn run(world: &World, frame: &Frame, images: &mut Images) -> Result<()> {
    let hemisphere = hemisphere(world);
    let is_even = hemisphere.is_none_or(|light| light.is_black());
    let has_ambient = !is_even || lights::ambient(world, frame) > 0.0;
    let surfaces = world.view::<SurfaceColumns<'_>>();
    let mut shapes = world.query::<(&Source, &Shape, &MaterialBound, &mut Visibility)>();
    let shapes = shapes.iter().filter(|(.., visibility)| visibility.is_surface);
    for (source, shape, bound, visibility) in shapes {
        let surface = SurfaceComponents::of(&surfaces, source.0);
        let faces = visibility.faces.unwrap_or(Faces::lit(shape));
        let mirrors = bound.0.kr > 0.0 && frame.settings.bounces > 0 && faces.any();
        visibility.shows =
            Shows::of(&surface, &bound.0, visibility, mirrors, (has_ambient, hemisphere));
        let occlusion = surface.maps.occlusion.as_ref().and_then(|map| map.texture.as_ref());
        let is_seen = visibility.is_in_view();
        let is_shown = visibility.shows.occlusion && is_seen;
        if let Some(texture) = occlusion.filter(|_| is_shown) {
            let is_one = images.is_one(texture, None, (surface.place, OCCLUSION_MAP))?;
            visibility.shows.occlusion = !is_one;
        }
        visibility.is_trilinear =
            visibility.shows.is_trilinear(&surface, visibility.is_transparent, |texture| {
                let own = texture.look_up.filter;
                let filter = if is_seen { images.filter(texture) } else { own };
                filter == Filter::Trilinear
            });
    }
    Ok(())
}

impl Shows {
    /// The visible properties of a surface, whose weights are at most those of `bound`, and that `mirrors` or not.
    fn of(
        surface: &SurfaceComponents<'_>,
        bound: &Material,
        &Visibility { is_lit, is_transparent, .. }: &Visibility,
        mirrors: bool,
        (has_ambient, hemisphere): (bool, Option<Hemisphere>),
    ) -> Self {
        let SurfaceComponents { material, transparency, texture, maps, .. } = surface;
        let wears = texture.is_some();
        let Maps { metal, occlusion, normal, .. } = maps;
        let varied = metal.as_ref().filter(|map| !map.is_constant());
        let is_colored = wears || bound.color != Vec3::ZERO;
        let color = material.map_or(DVec3::ONE, |m| m.specular_color);
        let is_tinted = metal.as_ref().map_or(color != DVec3::ONE, |map| map.metallic > 0.0);
        let is_unlit = surface.is_unlit();
        let is_tinted_through = transparency.is_some_and(|found| found.tinted && found.kt > 0.0);
        let has_ambient = has_ambient && bound.ambient > 0.0;
        let by_normal = hemisphere.is_some_and(|light| !light.is_black());
        // Base colour is visible in ambient light, for any kd, and where it reflects light; it also
        // tints what metals mirror and what is refracted.
        let color = has_ambient
            || is_lit && bound.kd > 0.0
            || mirrors && varied.is_some()
            || is_unlit
            || is_tinted_through;
        Self {
            color,
            texture: wears && color,
            emission: bound.emission != Vec3::ZERO || is_unlit && is_colored,
            metal: varied.is_some() && (is_lit || mirrors || has_ambient),
            occlusion: occlusion.as_ref().is_some_and(Map::has_effect)
                && has_ambient
                // Rays find what is in the way.
                && !hemisphere.is_some_and(|light| light.traced)
                && is_colored,
            tint: is_tinted && (is_lit && bound.ks > 0.0 || mirrors),
            normal: normal.as_ref().is_some_and(Map::has_effect)
                && (is_lit || mirrors || by_normal && is_colored || is_transparent),
        }
    }

    /// The properties after a change of each, with the step that looks it up.
    pub(super) fn map(self, change: impl Fn(Step, bool) -> bool) -> Self {
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

    /// Whether any visible texture of such a surface `is_trilinear`.
    fn is_trilinear(
        self,
        surface: &SurfaceComponents<'_>,
        is_transparent: bool,
        mut is_trilinear: impl FnMut(&TextureRef) -> bool,
    ) -> bool {
        let shows = |key: &str| match key {
            EMISSION_MAP => self.emission,
            METAL_MAP => self.metal,
            OCCLUSION_MAP => self.occlusion,
            OPACITY_MAP => is_transparent,
            _ => self.normal,
        };
        let mut maps = surface.maps.all().filter(|(key, _)| shows(key));
        self.texture && surface.texture.is_some_and(&mut is_trilinear)
            || maps.any(|(_, map)| map.texture.as_ref().is_some_and(&mut is_trilinear))
    }
}
