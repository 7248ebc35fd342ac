//! Spheres.

use glam::{DVec3, Mat3};

use super::transform::keeps_round;
use crate::format::{Declaration, Kind, Range, component, declared};
use crate::systems::placement::{Circle, ShapeInstance};
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Quadric;
use wavecrest_core::prepared::UvMap;

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

impl Sphere {
    /// The sphere in world space.
    ///
    /// # Errors
    /// If it is too large, too small, or too far away for single precision.
    pub(crate) fn in_world(&self, instance: &ShapeInstance) -> Result<(Quadric, UvMap)> {
        let Circle { center, radius, turn } =
            instance.circle("sphere", self.center, self.radius)?;
        let to_own = turn.transpose();
        let map = UvMap::Sphere(Mat3::from_cols(
            to_own.x_axis.as_vec3(),
            to_own.y_axis.as_vec3(),
            to_own.z_axis.as_vec3(),
        ));
        Ok((Quadric::Sphere(center, radius), map))
    }
}
