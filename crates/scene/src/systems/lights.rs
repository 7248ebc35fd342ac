//! Lights: emitters with sampling data, in the order of the file.

use hecs::{Entity, World};

use super::census::Findings;
use crate::components::Settings;
use crate::lights::{Found, SYSTEMS, Surroundings};
use crate::query::json_path;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::camera;
use wavecrest_core::kernels::light::Light;
use wavecrest_core::plan::schedule::{Schedule, Step};

/// The lights of the world in the order of the file, moved like its shapes.
pub(crate) fn run(world: &World, scene: &Surroundings<'_>) -> Result<Vec<Found>> {
    let mut found: Vec<Found> = Vec::new();
    for system in SYSTEMS {
        found.extend(system(world, scene)?);
    }
    found.sort_by_key(|found| found.order);
    Ok(found)
}

/// The lights to simulate, each with its own dimensions: those that reach a surface in view
/// (`shown`), or all if the schedule skips none.
///
/// A light that reaches nothing draws its numbers, if any, after all others, so that its presence
/// changes none of theirs. Visibility changes no numbers: the noise stays the same when the camera
/// turns.
pub(crate) fn keep(
    world: &World,
    settings: &Settings,
    schedule: Schedule,
    mut found: Vec<Found>,
    Findings { shown, reached, .. }: &Findings,
) -> Result<Vec<Light>> {
    if !schedule.has_shadows() {
        return Ok(Vec::new());
    }
    let all = schedule.is_unconditional(Step::Shadow);
    let mut dimension = camera::DIMENSION + 1;
    for turn in [true, false] {
        let of_turn = found.iter_mut().zip(reached).filter(|(_, reached)| **reached == turn);
        for (Found { entity, light, .. }, _) in of_turn {
            light.dimension = dimension;
            let drawn = if light.is_sampled() { light.samples() } else { 0 };
            dimension = dimension
                .checked_add(drawn)
                .ok_or_else(|| too_many_samples(world, *entity, settings))?;
        }
    }
    let kept = found.into_iter().zip(shown).filter(|(_, shown)| **shown || all);
    Ok(kept.map(|(found, _)| found.light).collect())
}

/// The error that samples exceed 32-bit numbers: each has its own random numbers.
fn too_many_samples(world: &World, entity: Entity, settings: &Settings) -> Error {
    Error::new(ErrorKind::Limit, "the lights have too many samples in all")
        .in_file(&settings.file)
        .at(format!("{}.samples", json_path(world, entity)))
        .remedy(format!("at most {} are allowed", u32::MAX - 1))
}
