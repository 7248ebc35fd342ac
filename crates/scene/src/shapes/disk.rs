//! Disks.

use glam::DVec3;

use super::transform::keeps_round;
use crate::format::{Declaration, Kind, Range, component, declared};
use crate::systems::placement::{Circle, ShapeInstance};
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Quadric;
use wavecrest_core::kernels::disk;
use wavecrest_core::kernels::texture::PlanarMap;
use wavecrest_core::prepared::UvMap;

pub(super) const KIND: Kind =
    Kind::entity("disk", "a disk", "A round, flat surface.", &[Declaration::of::<Disk>()]);

component! {
    /// A disk.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Disk {
        /// The centre.
        pub center: DVec3 = "center": Point, Required;
        /// Points to the front. A texture fills the square around the disk; seen from the front, its
        /// top is towards +y, or towards -z on a disk that faces up or down.
        pub normal: DVec3 = "normal": Direction("[0, 1, 0]"), Required;
        /// The radius.
        pub radius: f64 = "radius": Number(Range::POSITIVE), Required;
    }
}

declared!(Disk, |_: &mut Self, object| keeps_round(object, "a disk"));

impl Disk {
    /// The disk in world space.
    ///
    /// # Errors
    /// If it is too large, too small, or too far away for single precision.
    pub(crate) fn in_world(&self, instance: &ShapeInstance) -> Result<(Quadric, UvMap)> {
        let Circle { center, radius, turn } = instance.circle("disk", self.center, self.radius)?;
        let normal = (turn * self.normal).normalize();
        let disk = disk::Disk { center, normal: normal.as_vec3(), radius };
        let [u, v] = disk::Disk::axes(self.normal).map(|axis| (turn * axis).as_vec3() * radius);
        let map = PlanarMap::new(center - u - v, 2.0 * u, 2.0 * v);
        Ok((Quadric::Disk(disk), UvMap::Planar(map)))
    }
}
