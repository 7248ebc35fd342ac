//! Spheres.

use glam::DVec3;

use super::transform::{is_uniform, transform};
use crate::format::{Cursor, Declaration, Kind, Object, Range, component, declared};
use wavecrest_base::error::{Error, Result};

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

declared!(Sphere, check);

fn check(_: &mut Sphere, object: &Object<'_>) -> Result<()> {
    match object.get("transform") {
        Some(cursor) if !is_uniform(&transform(&cursor)?) => Err(uneven(&cursor)),
        _ => Ok(()),
    }
}

/// The error that the transform at `cursor` would make a sphere an ellipsoid.
pub(super) fn uneven(cursor: &Cursor<'_>) -> Error {
    let error = cursor.error("a sphere can only be scaled uniformly");
    error.remedy("use one scale factor, or a trimesh")
}
