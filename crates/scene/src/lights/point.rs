//! Point lights.

use glam::DVec3;

use super::warn_of_strength;
use crate::camera::Falloff;
use crate::format::{Declaration, Kind, Range, component, declared};

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

declared!(PointLight, |light: &mut Self, object| {
    warn_of_strength(object, light.intensity, light.color);
    Ok(())
});
