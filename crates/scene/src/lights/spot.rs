//! Spot lights: point lights that a cone narrows.

use glam::{DVec3, Vec3};
use hecs::{Entity, World};

use super::{PointLight, SourceLight};
use crate::components::Order;
use crate::corners::unit;
use crate::format::{Declaration, Kind, Object, Range, component, declared};
use crate::systems::frame::Frame;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::light::{Cone, Emitter};

/// Angles between the direction of a spot and the edge of a cone, in degrees.
const HALF_ANGLE: Range = Range::new(0.0, 90.0);

pub(super) const KIND: Kind = Kind::entity(
    "spotlight",
    "a spot light",
    "A light that shines from a point within a cone.",
    &[Declaration::of::<Spot>(), Declaration::of::<PointLight>()],
);

component! {
    /// Narrows the [`PointLight`] of the same entity to a spot.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Spot {
        /// Direction in which the light shines.
        pub direction: DVec3 = "direction": Direction("[0, -1, 0]"), Required;
        /// Angle from the direction, in degrees, up to which the light has full strength.
        pub inner_degrees: f64 = "inner": Number(HALF_ANGLE), Is(0.0);
        /// Angle from the direction, in degrees, beyond which there is no light: at least the inner
        /// angle.
        pub outer_degrees: f64 = "outer": Number(HALF_ANGLE), Required;
    }
}

declared!(Spot, check);

fn check(spot: &mut Spot, object: &Object<'_>) -> Result<()> {
    let outer = spot.outer_degrees;
    if spot.inner_degrees > outer {
        let cursor = object.need("inner", "a number")?;
        let error = cursor.error(format!("is more than \"outer\", {outer}"));
        return Err(error.remedy("use an \"inner\" angle below \"outer\""));
    }
    if outer == 0.0 {
        let message = "is 0, so of the light only its ambient part is left";
        object.need("outer", "a number")?.warn(message, "use an angle above 0, up to 90");
    }
    Ok(())
}

/// The spots.
pub(super) fn emitters(world: &World, frame: &Frame, _: &Geometry) -> Result<Vec<SourceLight>> {
    let mut query = world.query::<(Entity, &Order, &PointLight, &Spot)>();
    let found = query.iter().map(|(entity, &order, light, spot)| {
        let cone = Cone::new(unit(spot.direction), spot.inner_degrees, spot.outer_degrees);
        let position = (light.position - frame.origin).as_vec3();
        let mut light = light.with(Emitter::Spot(position, cone));
        if spot.outer_degrees == 0.0 {
            light.power = Vec3::ZERO;
        }
        SourceLight { entity, order, light }
    });
    Ok(found.collect())
}
