//! Textures of colours, and details: properties of shapes other than colour.

use std::collections::HashMap;

use super::census::{Findings, Shows};
use super::geometry::ShapeOutput;
use super::textures::{Images, has_alpha};
use crate::components::{Channels, Map, Material, SurfaceComponents, Transparency};
use crate::surface::{EMISSION_MAP, METAL_MAP, NORMAL_MAP, OCCLUSION_MAP, OPACITY_MAP};
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{Detail, Metal, NormalMap, Occlusion, UvMap};

/// Assigns textures and details to shapes; shapes with equal ones share a detail. Invisible ones are
/// left out, and their images not opened, unless the schedule requires them.
pub(crate) fn run(
    surfaces: &[SurfaceComponents<'_>],
    schedule: Schedule,
    found: &Findings,
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
    let shows: Vec<Shows> = found.shows.iter().map(|shows| shows.map(is_needed)).collect();
    for ((output, surface), shows) in shapes.iter_mut().zip(surfaces).zip(&shows) {
        if let Some(texture) = surface.texture.filter(|_| shows.texture) {
            let place = (surface.place, "texture");
            output.shape.texture = Some(images.texture(texture, place, output.uv_map));
        }
    }
    let shown = shows.into_iter().zip(&found.transparent);
    for ((output, surface), (shows, transparent)) in shapes.iter_mut().zip(surfaces).zip(shown) {
        // The texture of its colour is no detail.
        let shows = Shows { texture: false, ..shows };
        let has_detail = *transparent || shows != Shows::default();
        let Some(material) = surface.material.filter(|_| has_detail) else { continue };
        let mut detail = detail(material, surface, shows, images, output.uv_map);
        if *transparent {
            let own = surface.transparency.unwrap_or(&Transparency::OPAQUE);
            let place = (surface.place, OPACITY_MAP);
            let map = surface.maps.opacity.as_ref();
            detail.transparency = Some(own.in_single_precision());
            detail.opacity = map.map(|map| images.texture(&map.texture, place, output.uv_map));
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
    let may_vary = |map: &Map| {
        map.texture.channels == Channels::Color || has_alpha(&map.texture.look_up.source)
    };
    surface.transparency.is_some_and(Transparency::has_effect)
        || surface.maps.opacity.as_ref().is_some_and(may_vary)
}

/// The visible part of a shape's detail.
fn detail(
    material: &Material,
    SurfaceComponents { maps, place, .. }: &SurfaceComponents<'_>,
    shows: Shows,
    images: &mut Images,
    uv_map: UvMap,
) -> Detail {
    let mut shown = |map: &Option<Map>, is_shown, key| {
        let map = map.as_ref().filter(|_| is_shown)?;
        let factors = [map.metallic, map.roughness, map.strength].map(|factor| factor as f32);
        Some((images.texture(&map.texture, (place, key), uv_map), factors))
    };
    let mut detail = Detail::default();
    if shows.emission {
        detail.emission = material.emission.as_vec3();
        detail.emission_texture = shown(&maps.emission, true, EMISSION_MAP).map(|(map, _)| map);
    }
    if shows.tint {
        detail.tint = material.specular_color.as_vec3();
    }
    detail.metal = shown(&maps.metal, shows.metal, METAL_MAP)
        .map(|(texture, [metallic, roughness, _])| Metal { texture, metallic, roughness });
    detail.occlusion = shown(&maps.occlusion, shows.occlusion, OCCLUSION_MAP)
        .map(|(texture, [.., strength])| Occlusion { texture, strength });
    detail.normal = shown(&maps.normal, shows.normal, NORMAL_MAP)
        .map(|(texture, [.., strength])| NormalMap { texture, strength });
    detail
}
