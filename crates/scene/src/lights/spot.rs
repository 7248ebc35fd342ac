//! Spot lights: point lights that a cone narrows.

use glam::DVec3;

use super::PointLight;
use crate::format::{Declaration, Kind, Object, Range, component, declared};
use wavecrest_base::error::Result;

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
        object.warn("outer", message, "use an angle above 0, up to 90");
    }
    Ok(())
}
