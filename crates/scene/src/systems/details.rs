//! Details: properties of shapes other than colour.

use std::collections::HashMap;

use super::census::Shows;
use super::geometry::ShapeOutput;
use super::textures::Images;
use crate::components::{Material, MetalMap, StrengthMap, SurfaceComponents, Transparency};
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{Detail, Metal, NormalMap, Occlusion, UvMap};

/// Assigns details to shapes; shapes with equal ones share a detail. Invisible properties are left
/// out, unless the schedule requires them.
pub fn run(
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
    let all = Shows::required(schedule);
    let all_shown = shows.iter().zip(transparent);
    for ((output, surface), (shows, transparent)) in shapes.iter_mut().zip(surfaces).zip(all_shown)
    {
        let shows = shows.or(all).within(schedule);
        let has_any = shows.any_detail() || *transparent;
        let Some(material) = surface.material.filter(|_| has_any) else { continue };
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
        detail.emission_texture = maps.emission.as_ref().map(|map| texture(map, "emissionmap"));
    }
    if shows.tint {
        detail.tint = material.specular_color.as_vec3();
    }
    if let Some(MetalMap { texture: map, metallic, roughness }) =
        maps.metal.as_ref().filter(|_| shows.metal)
    {
        let (metallic, roughness) = (*metallic as f32, *roughness as f32);
        detail.metal = Some(Metal { texture: texture(map, "metalmap"), metallic, roughness });
    }
    if let Some(StrengthMap { texture: map, strength }) =
        maps.occlusion.as_ref().filter(|_| shows.occlusion)
    {
        let strength = *strength as f32;
        detail.occlusion = Some(Occlusion { texture: texture(map, "occlusionmap"), strength });
    }
    if let Some(StrengthMap { texture: map, strength }) =
        maps.normal.as_ref().filter(|_| shows.normal)
    {
        let strength = *strength as f32;
        detail.normal = Some(NormalMap { texture: texture(map, "normalmap"), strength });
    }
    detail
}

impl Shows {
    /// The look-ups required for any shape.
    fn required(schedule: Schedule) -> Self {
        let maps = schedule.is_unconditional(Step::Maps);
        Self {
            texture: schedule.is_unconditional(Step::Texels),
            emission: schedule.is_unconditional(Step::Emission),
            metal: maps,
            occlusion: maps,
            tint: schedule.is_unconditional(Step::Tints),
            normal: schedule.is_unconditional(Step::NormalMaps),
        }
    }

    /// The part of it that is looked up.
    fn within(self, schedule: Schedule) -> Self {
        let maps = schedule.runs(Step::Maps);
        Self {
            texture: self.texture && schedule.runs(Step::Texels),
            emission: self.emission && schedule.runs(Step::Emission),
            metal: self.metal && maps,
            occlusion: self.occlusion && maps,
            tint: self.tint && (schedule.runs(Step::Tints) || schedule.has_mirrors()),
            normal: self.normal && schedule.runs(Step::NormalMaps),
        }
    }

    fn or(self, other: Self) -> Self {
        Self {
            texture: self.texture | other.texture,
            emission: self.emission | other.emission,
            metal: self.metal | other.metal,
            occlusion: self.occlusion | other.occlusion,
            tint: self.tint | other.tint,
            normal: self.normal | other.normal,
        }
    }

    fn any_detail(self) -> bool {
        self.emission || self.metal || self.occlusion || self.tint || self.normal
    }
}
