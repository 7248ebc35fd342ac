//! Point lights.

use glam::{DVec3, Vec3};
use hecs::{Entity, World};

use super::{Spot, power, warn_of_strength};
use crate::components::{Falloff, Sampling};
use crate::format::{Declaration, Kind, Range, component, declared};
use crate::systems::frame::Frame;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::light::{Emitter, Light};

pub(super) const KIND: Kind = Kind::entity(
    "pointlight",
    "a point light",
    "A light that shines from a point in all directions.",
    &[Declaration::of::<PointLight>()],
);

component! {
    /// A light at a point.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct PointLight {
        /// Strength; with the default falloff 40 to 100 suits distances of 10 to 20.
        pub intensity: f64 = "intensity": Number(Range::NOT_NEGATIVE), Required;
        /// Position.
        pub position: DVec3 = "position": Point, Required;
        /// The colour of the light.
        pub color: DVec3 = "color": Color, Required;
        /// At distance d: 1/(4 pi d), 1/(4 pi d^2), or 1.
        pub falloff: Falloff = "falloff": word::<Falloff>(), Says("linear");
    }
}

declared!(PointLight, |_: &mut Self, object| {
    warn_of_strength(object);
    Ok(())
});

/// The point lights, of which cones narrow some.
pub(super) fn lights(world: &World, frame: &Frame, _: &Geometry) -> Result<Vec<(Entity, Light)>> {
    let mut lights = world.query::<(Entity, &PointLight, Option<&Spot>)>();
    let lights = lights.iter().map(|(entity, light, spot)| {
        let position = (light.position - frame.origin).as_vec3();
        let emitter = spot.map_or(Emitter::Point(position), |spot| spot.emitter(position));
        let is_dark = spot.is_some_and(|spot| spot.outer_degrees == 0.0);
        let power = if is_dark { Vec3::ZERO } else { power(light.intensity, light.color) };
        (entity, super::light(emitter, power, light.falloff, (Sampling::Random, 1)))
    });
    Ok(lights.collect())
}
