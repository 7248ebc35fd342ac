//! Details: properties of shapes other than colour.

use std::collections::HashMap;

use super::census::Shows;
use super::geometry::ShapeOutput;
use super::textures::Images;
use crate::components::{Material, MetalMap, StrengthMap, SurfaceComponents, Transparency};
use crate::surface::{EMISSION_MAP, METAL_MAP, NORMAL_MAP, OCCLUSION_MAP};
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
            detail.transparency = surface.transparency.and_then(Transparency::single);
        }
        let next = || {
            details.push(detail.clone());
            details.len() as u32 - 1
        };
        output.shape.detail = Some(*known.entry(format!("{detail:?}")).or_insert_with(next));
    }
    details
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
