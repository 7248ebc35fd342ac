//! Details: what shapes show besides their colour, for those that show anything.

use std::collections::HashMap;

use glam::Vec3;
use hecs::World;

use super::geometry::ShapeOutput;
use crate::components::Material;
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::Detail;

/// Notes in each shape which detail it shows: shapes that show the same share it. What is not `needed` has none,
/// unless the schedule requires it.
pub fn run(
    world: &World,
    schedule: Schedule,
    needed: &[bool],
    shapes: &mut [ShapeOutput],
) -> Vec<Detail> {
    let mut details = Vec::new();
    if !schedule.runs(Step::Emission) {
        return details;
    }
    let all = schedule.is_needless(Step::Emission);
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    for (output, _) in shapes.iter_mut().zip(needed).filter(|(_, needed)| **needed || all) {
        if output.shape.emission.is_some() {
            continue;
        }
        let emission = emission(world, output);
        let next = || {
            details.push(Detail { emission });
            details.len() as u32 - 1
        };
        let bits = emission.to_array().map(f32::to_bits);
        output.shape.detail = Some(*known.entry(bits).or_insert_with(next));
    }
    details
}

/// The light of the material itself.
pub(super) fn emission(world: &World, output: &ShapeOutput) -> Vec3 {
    let material = world.get::<&Material>(output.entity);
    material.map_or(Vec3::ZERO, |material| material.emission.as_vec3())
}
