//! Directional lights.

use glam::DVec3;
use hecs::{Entity, World};

use super::{MOST_SAMPLES, check_samples, diameter, power, warn_of_strength};
use crate::components::{Falloff, Material, Sampling};
use crate::corners::unit;
use crate::format::{Declaration, Kind, Range, component, declared};
use crate::systems::camera::resolution;
use crate::systems::frame::Frame;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::light::{Distant, Emitter, Light};
use wavecrest_core::kernels::shade::HALF_LEVEL;

pub(super) const KIND: Kind = Kind::entity(
    "directionallight",
    "a directional light",
    "A light infinitely far away, equally strong everywhere.",
    &[Declaration::of::<DirectionalLight>()],
);

component! {
    /// A light infinitely far away.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct DirectionalLight {
        /// Strength, the same everywhere.
        pub intensity: f64 = "intensity": Number(Range::NOT_NEGATIVE), Required;
        /// The colour of the light.
        pub color: DVec3 = "color": Color, Required;
        /// Direction in which the light shines.
        pub direction: DVec3 = "direction": Direction("[0, -1, 0]"), Required;
        /// Diameter of the light in the sky, in degrees: 0.53 for the sun. It softens shadows; at 0
        /// rays are parallel.
        pub angle_degrees: f64 = "angle": Number(Range::new(0.0, 180.0)), Is(0.0);
        /// Distribution of the directions to the light: random, one in each cell of a grid, or
        /// Sobol.
        pub sampling: Sampling = "sampling": word::<Sampling>(), Says("sobol") => "angle";
        /// Directions to the light, which share its strength; with jittered sampling, along each side of the grid.
        pub samples: u32 = "samples": Integer(1, MOST_SAMPLES), Is(1.0) => "angle";
    }
}

declared!(DirectionalLight, |light: &mut Self, object| {
    warn_of_strength(object);
    check_samples(object, light.sampling, light.samples)
});

/// Whether the size of the light changes less than half of one of 255 levels, expected over places of a
/// shadow's edge in a pixel: in penumbrae, which are at most as wide as the light is seen from the farthest
/// thing in their way, and on surfaces, by whose highlight it changes most.
fn is_parallel(
    light: &DirectionalLight,
    diameter: f64,
    resolution: impl FnOnce() -> (f64, f64),
) -> bool {
    let strength = (light.intensity * light.color.max_element()).max(1.0);
    let changes = 2.0 * libm::sin((light.angle_degrees / 2.0).to_radians()) * strength;
    let least = f64::from(HALF_LEVEL);
    // The slope of a highlight cos^e is at most sqrt(e).
    let is_small = changes * Material::SHARPEST.sqrt() < least;
    is_small && changes * diameter < least * resolution().0
}

/// The directional lights.
pub(super) fn lights(
    world: &World,
    frame: &Frame,
    geometry: &Geometry,
) -> Result<Vec<(Entity, Light)>> {
    let mut found = Vec::new();
    let mut size = None;
    for (entity, light) in world.query::<(Entity, &DirectionalLight)>().iter() {
        // A pass over every position, only if there is such a light.
        let size = *size.get_or_insert_with(|| diameter(geometry));
        let is_parallel = is_parallel(light, size, || resolution(&frame.cameras, geometry));
        let angle = if is_parallel { 0.0 } else { light.angle_degrees };
        let distant = Distant::new(-unit(light.direction), angle, size);
        // Parallel rays need only one sample.
        let samples = if distant.is_parallel() { 1 } else { light.samples };
        let power = power(light.intensity, light.color);
        let points = (light.sampling, samples);
        found.push((entity, super::light(Emitter::Distant(distant), power, Falloff::None, points)));
    }
    Ok(found)
}
