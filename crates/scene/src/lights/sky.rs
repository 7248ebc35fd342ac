//! Ambient light from a sky and the ground, or from the environment.

use glam::DVec3;
use hecs::{Entity, World};

use super::{MOST_SAMPLES, check_samples, diameter};
use crate::components::{Falloff, Sampling};
use crate::corners::unit;
use crate::environment;
use crate::format::{Declaration, Kind, Range, component, declared};
use crate::systems::frame::Frame;
use crate::systems::textures::Images;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::environment::{Environment, EnvironmentColors};
use wavecrest_core::kernels::hemisphere::Hemisphere;
use wavecrest_core::kernels::light::{Distant, Emitter, Light};
use wavecrest_core::plan::{Effect, Plan};
use wavecrest_core::prepared::LazyImage;

/// The object of ambient light.
pub(crate) const SKY: Kind = Kind::entity(
    "",
    "ambient light (or a number)",
    "Ambient light from a sky and the ground, or from the environment, by the direction of the normal.",
    &[Declaration::of::<Sky>()],
);

component! {
    /// Ambient light from a sky and the ground, or from the environment, added once, weighted by the
    /// normal.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Sky {
        /// The light on a surface that faces up; by default that of the environment, from everywhere.
        pub sky: Option<DVec3> = "sky": Color;
        /// The light on a surface that faces down; by default the same.
        pub ground: Option<DVec3> = "ground": Color;
        /// Direction of the sky.
        pub up: DVec3 = "up": Direction("[0, 1, 0]"), Are([0.0, 1.0, 0.0]) => "sky" | "ground";
        /// Directions in which rays look for what is in the way of this light; with jittered
        /// sampling, along each side of the grid. At 0 nothing is in the way.
        pub samples: u32 = "samples": Integer(0, MOST_SAMPLES), Is(0.0);
        /// Distribution of the directions: random, one in each cell of a grid, or Sobol.
        pub sampling: Sampling = "sampling": word::<Sampling>(), Says("sobol") => "samples";
        /// How far rays look; by default to the end of the scene.
        pub distance: Option<f64> = "distance": Number(Range::POSITIVE) => "samples";
    }
}

declared!(Sky, |sky: &mut Self, object| check_samples(object, sky.sampling, sky.samples));

impl Sky {
    /// The light on a surface by its normal. That of an environment without one `color` is found later;
    /// until then it is white, if there is any.
    pub(crate) fn hemisphere(&self, world: &World, color: Option<DVec3>) -> Hemisphere {
        let white = || if environment::is_bright(world) { DVec3::ONE } else { DVec3::ZERO };
        let sky = self.sky.or(color).unwrap_or_else(white);
        // The light of an environment has its own ground.
        let ground = self.ground.filter(|_| self.sky.is_some()).unwrap_or(sky);
        let traced = self.samples > 0;
        Hemisphere::new(sky, ground, unit(self.up), traced)
    }
}

/// Leaves the light on a surface by its normal beside the sky, and its only colour beside an environment.
pub(crate) fn run(world: &mut World, images: &mut Images) {
    let sky = world.query::<(Entity, &Sky)>().iter().next().map(|(entity, sky)| (entity, *sky));
    let is_lit_by_it = sky.is_some_and(|(_, sky)| sky.sky.is_none());
    let color = environment::leave_even_color(world, images, is_lit_by_it);
    if let Some((entity, sky)) = sky {
        let hemisphere = sky.hemisphere(world, color);
        let _ = world.insert_one(entity, hemisphere);
    }
}

/// The light on a surface by its normal. That of an environment without one colour is white.
pub(crate) fn hemisphere(world: &World) -> Option<Hemisphere> {
    world.query::<&Hemisphere>().iter().next().copied()
}

/// The light on a surface by its normal, if the plan has it.
///
/// # Errors
/// If the image of an environment that gives it cannot be decoded.
pub(crate) fn light(
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

/// Ambient light that shadow rays look for.
pub(super) fn lights(
    world: &World,
    _: &Frame,
    geometry: &Geometry,
) -> Result<Vec<(Entity, Light)>> {
    let mut skies = world.query::<(Entity, &Sky)>();
    let lights = skies.iter().filter(|(_, sky)| sky.samples > 0).map(|(entity, sky)| {
        let all = || Distant::reach(diameter(geometry));
        let reach = sky.distance.unwrap_or_else(all) as f32;
        let emitter = Emitter::Around(reach.max(f32::MIN_POSITIVE));
        let power = sky.hemisphere(world, None).channels();
        (entity, super::light(emitter, power, Falloff::None, (sky.sampling, sky.samples)))
    });
    Ok(lights.collect())
}
