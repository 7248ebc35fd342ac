//! Disks.

use glam::DVec3;

use super::transform::keeps_round;
use crate::format::{Declaration, Kind, Range, component, declared};

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
