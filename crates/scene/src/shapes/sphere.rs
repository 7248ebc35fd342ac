//! Spheres.

use glam::DVec3;

use super::transform::keeps_round;
use crate::format::{Declaration, Kind, Range, component, declared};

pub(super) const KIND: Kind =
    Kind::entity("sphere", "a sphere", "A sphere.", &[Declaration::of::<Sphere>()]);

component! {
    /// A sphere.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Sphere {
        /// The centre.
        pub center: DVec3 = "center": Point, Required;
        /// The radius.
        pub radius: f64 = "radius": Number(Range::POSITIVE), Required;
    }
}

declared!(Sphere, |_: &mut Self, object| keeps_round(object, "a sphere"));
