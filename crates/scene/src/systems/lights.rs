//! Lights: emitters with sampling data, in the order of the file.

mod emitters;

use hecs::{Entity, World};

use super::frame::Frame;
use super::reach::Illuminates;
use super::visibility::Source;
use crate::components::Order;
use crate::query::json_path;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::camera;
use wavecrest_core::kernels::light::Light;
use wavecrest_core::plan::schedule::{Schedule, Step};

pub(super) use emitters::ShapeEmitter;

/// Spawns an entity for each light, in the order of the file, moved like its shapes.
pub(crate) fn run(world: &mut World, frame: &Frame, geometry: &Geometry) -> Result<()> {
    let mut found = emitters::points(world, frame);
    found.extend(emitters::directional(world, frame, geometry));
    found.extend(emitters::areas(world, frame)?);
    found.extend(emitters::skies(world, geometry));
    // Ambient light comes after the lights of the file, whose random numbers it leaves as they are.
    let order = |entity| world.get::<&Order>(entity).map_or(Order(u32::MAX), |order| *order);
    found.sort_by_cached_key(|(entity, _)| order(*entity));
    let all = found.into_iter();
    world.spawn_batch(all.map(|(entity, light)| (Source(entity), light, Illuminates::default())));
    Ok(())
}

/// Factor on the diffuse colour for the ambient part of all lights together, including lights without power.
pub(crate) fn ambient(world: &World, frame: &Frame) -> f32 {
    frame.settings.ambient as f32 * world.query::<(&Source, &Light)>().iter().count() as f32
}

/// Moves the lights to simulate out of the world, each with its own dimensions: those that reach a surface in
/// view, or all if the schedule skips none. With them comes the [`ambient`] part of all.
///
/// A light that reaches nothing draws its numbers, if any, after all others, so that its presence
/// changes none of theirs. Visibility changes no numbers: the noise stays the same when the camera
/// turns.
pub(crate) fn kept(
    world: &mut World,
    frame: &Frame,
    schedule: Schedule,
) -> Result<(Vec<Light>, f32)> {
    let ambient = ambient(world, frame);
    if !schedule.has_shadows() {
        return Ok((Vec::new(), ambient));
    }
    let mut dimension = camera::DIMENSION + 1;
    for turn in [true, false] {
        let mut lights = world.query::<(&Source, &mut Light, &Illuminates)>();
        for (source, light, _) in lights.iter().filter(|(.., found)| found.anywhere == turn) {
            light.dimension = dimension;
            let drawn = if light.is_sampled() { light.samples() } else { 0 };
            dimension = dimension
                .checked_add(drawn)
                .ok_or_else(|| too_many_samples(world, source.0, frame))?;
        }
    }
    let all = schedule.is_unconditional(Step::Shadow);
    let lights = world.query_mut::<(Entity, &Light, &Illuminates)>().into_iter();
    let kept = lights.filter(|(.., found)| found.in_view || all);
    let kept: Vec<Entity> = kept.map(|(entity, ..)| entity).collect();
    let kept = kept.into_iter().filter_map(|entity| world.remove_one::<Light>(entity).ok());
    Ok((kept.collect(), ambient))
}

/// The error that samples exceed 32-bit numbers: each has its own random numbers.
fn too_many_samples(world: &World, entity: Entity, frame: &Frame) -> Error {
    Error::new(ErrorKind::Limit, "the lights have too many samples in all")
        .in_file(&frame.settings.file)
        .at(format!("{}.samples", json_path(world, entity)))
        .remedy(format!("at most {} are allowed", u32::MAX - 1))
}
