//! Ambient light by the normal, from a sky and the ground or from the environment.

use glam::DVec3;
use hecs::{Entity, World};

use super::environment;
use super::textures::Images;
use crate::components::Sky;
use crate::corners::unit;
use wavecrest_base::error::Result;
use wavecrest_core::kernels::environment::{Environment, EnvironmentColors};
use wavecrest_core::kernels::hemisphere::Hemisphere;
use wavecrest_core::plan::{Effect, Plan};
use wavecrest_core::prepared::LazyImage;

/// Leaves the light on a surface by its normal beside the sky, and its only colour beside an environment.
pub(super) fn run(world: &mut World, images: &mut Images) {
    let sky = world.query::<(Entity, &Sky)>().iter().next().map(|(entity, sky)| (entity, *sky));
    let is_lit_by_it = sky.is_some_and(|(_, sky)| sky.sky.is_none());
    let color = environment::leave_even_color(world, images, is_lit_by_it);
    if let Some((entity, sky)) = sky {
        let hemisphere = of(&sky, world, color);
        let _ = world.insert_one(entity, hemisphere);
    }
}

/// The light on a surface by its normal. That of an environment without one colour is white.
pub(super) fn hemisphere(world: &World) -> Option<Hemisphere> {
    world.query::<&Hemisphere>().iter().next().copied()
}

/// The light on a surface by its normal, if the plan has it.
///
/// # Errors
/// If the image of an environment that gives it cannot be decoded.
pub(super) fn light(
    world: &World,
    plan: &Plan,
    environment: Option<&Environment>,
    images: &[LazyImage],
) -> Result<Option<Hemisphere>> {
    let light = hemisphere(world).filter(|_| plan.has(Effect::HemisphereLight));
    let is_lit_by_it = world.query::<&Sky>().iter().any(|sky| sky.sky.is_none());
    match (light, environment) {
        (Some(light), Some(around)) if is_lit_by_it => {
            let image = match around.colors {
                EnvironmentColors::Gradient(_) => None,
                EnvironmentColors::Image(number) => Some(images[number as usize].get()?),
            };
            Ok(Some(around.ambient(image, light.traced)))
        }
        (light, _) => Ok(light),
    }
}

/// The light of a sky on a surface by its normal. That of an environment without one `color` is found later;
/// until then it is white, if there is any.
pub(super) fn of(sky: &Sky, world: &World, color: Option<DVec3>) -> Hemisphere {
    let white = || if environment::is_bright(world) { DVec3::ONE } else { DVec3::ZERO };
    let above = sky.sky.or(color).unwrap_or_else(white);
    // The light of an environment has its own ground.
    let below = sky.ground.filter(|_| sky.sky.is_some()).unwrap_or(above);
    Hemisphere::new(above, below, unit(sky.up), sky.samples > 0)
}
