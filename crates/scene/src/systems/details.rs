//! Details: properties of shapes other than colour.

use std::collections::HashMap;

use super::census::Shows;
use super::geometry::ShapeOutput;
use super::textures::{Images, has_alpha};
use crate::components::{
    Channels, Material, MetalMap, StrengthMap, SurfaceComponents, TextureRef, Transparency,
};
use crate::surface::{EMISSION_MAP, METAL_MAP, NORMAL_MAP, OCCLUSION_MAP, OPACITY_MAP};
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{Detail, Metal, NormalMap, Occlusion, UvMap};

/// Assigns details to shapes; shapes with equal ones share a detail. Invisible properties are left
/// out, unless the schedule requires them.
pub(crate) fn run(
    surfaces: &[SurfaceComponents<'_>],
    schedule: Schedule,
    shows: &[Shows],
    transparent: &[bool],
    images: &mut Images,
    shapes: &mut [ShapeOutput],
) -> Vec<Detail> {
    let mut details = Vec::new();
    // As text, numbers are as good as their bits.
    let mut known: HashMap<String, u32> = HashMap::new();
    let is_needed = |step, is_shown| {
        let is_for_mirrors = step == Step::Tints && schedule.has_mirrors();
        (is_shown || schedule.is_unconditional(step)) && (schedule.runs(step) || is_for_mirrors)
    };
    let shown = shows.iter().zip(transparent);
    for ((output, surface), (shows, transparent)) in shapes.iter_mut().zip(surfaces).zip(shown) {
        // The texture of its colour is no detail.
        let shows = Shows { texture: false, ..shows.map(is_needed) };
        let has_detail = *transparent || shows != Shows::default();
        let Some(material) = surface.material.filter(|_| has_detail) else { continue };
        let mut detail = detail(material, surface, shows, images, output.uv_map);
        if *transparent {
            let own = surface.transparency.unwrap_or(&Transparency::OPAQUE);
            let place = (surface.place, OPACITY_MAP);
            let map = surface.maps.opacity.as_ref();
            detail.transparency = Some(own.in_single_precision());
            detail.opacity = map.map(|map| images.texture(map, place, output.uv_map));
        }
        let next = || {
            details.push(detail.clone());
            details.len() as u32 - 1
        };
        output.shape.detail = Some(*known.entry(format!("{detail:?}")).or_insert_with(next));
    }
    details
}

/// Whether light may go through a surface, as far as the headers of images tell.
pub(crate) fn is_transparent(surface: &SurfaceComponents<'_>) -> bool {
    let may_vary =
        |map: &TextureRef| map.channels == Channels::Color || has_alpha(&map.look_up.source);
    surface.transparency.is_some_and(Transparency::has_effect)
        || surface.maps.opacity.as_ref().is_some_and(may_vary)
}

/// The visible part of a shape's detail.
fn detail(
    material: &Material,
    SurfaceComponents { maps, place, .. }: &SurfaceComponents<'_>,
    shows: Shows,
    images: &mut Images,
    map: UvMap,
) -> Detail {
    let mut texture = |of, key| images.texture(of, (place, key), map);
    let mut detail = Detail::default();
    if shows.emission {
        detail.emission = material.emission.as_vec3();
        detail.emission_texture = maps.emission.as_ref().map(|map| texture(map, EMISSION_MAP));
    }
    if shows.tint {
        detail.tint = material.specular_color.as_vec3();
    }
    if let Some(MetalMap { texture: map, metallic, roughness }) =
        maps.metal.as_ref().filter(|_| shows.metal)
    {
        let (metallic, roughness) = (*metallic as f32, *roughness as f32);
        detail.metal = Some(Metal { texture: texture(map, METAL_MAP), metallic, roughness });
    }
    if let Some(StrengthMap { texture: map, strength }) =
        maps.occlusion.as_ref().filter(|_| shows.occlusion)
    {
        let strength = *strength as f32;
        detail.occlusion = Some(Occlusion { texture: texture(map, OCCLUSION_MAP), strength });
    }
    if let Some(StrengthMap { texture: map, strength }) =
        maps.normal.as_ref().filter(|_| shows.normal)
    {
        let strength = *strength as f32;
        detail.normal = Some(NormalMap { texture: texture(map, NORMAL_MAP), strength });
    }
    detail
}
