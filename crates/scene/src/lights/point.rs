//! Point lights.

use glam::DVec3;
use hecs::{Entity, World};

use super::{SourceLight, Spot, power, warn_of_strength};
use crate::components::{Falloff, Order, Sampling};
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

/// The point lights that are no spots.
pub(super) fn emitters(world: &World, frame: &Frame, _: &Geometry) -> Result<Vec<SourceLight>> {
    let mut query = world.query::<(Entity, &Order, &PointLight)>().without::<&Spot>();
    let found = query.iter().map(|(entity, &order, light)| {
        let emitter = Emitter::Point((light.position - frame.origin).as_vec3());
        SourceLight { entity, order, light: light.with(emitter) }
    });
    Ok(found.collect())
}

impl PointLight {
    /// The light as this emitter.
    pub(super) fn with(&self, emitter: Emitter) -> Light {
        let power = power(self.intensity, self.color);
        super::light(emitter, power, self.falloff, (Sampling::Random, 1))
    }
}
