//! Every primitive, one after the other: the reference that the tree is checked against.

use super::geometry::{Geometry, PreparedRay};
use super::{Hit, TestCounts};
use crate::kernels::precision::Arithmetic;

/// The closest hit of all.
pub fn closest<P: Arithmetic>(
    geometry: &Geometry,
    ray: &PreparedRay,
    tests: &mut TestCounts,
) -> Hit {
    let mut best = Hit::MISS;
    for number in 0..geometry.len() as u32 {
        if let Some(t) = geometry.hit::<P>(number, ray, tests)
            && t < best.t
            && geometry.can_be_hit(number)
        {
            best = Hit { t, primitive: number };
        }
    }
    best
}

/// Whether anything but a light's shape is hit.
pub fn occluded<P: Arithmetic>(
    geometry: &Geometry,
    ray: &PreparedRay,
    tests: &mut TestCounts,
) -> bool {
    (0..geometry.len() as u32).any(|number| {
        geometry.hit::<P>(number, ray, tests).is_some()
            && !geometry.is_light(number)
            && geometry.can_be_hit(number)
    })
}
