//! Brute force over all primitives: the reference for the tree.

use super::geometry::{Geometry, PreparedRay};
use super::near::Exactly;
use super::query::Query;
use super::{Hit, TestCounts};
use crate::kernels::precision::Arithmetic;

/// The hit for query `Q`.
pub(super) fn hit<Q: Query, P: Arithmetic>(
    geometry: &Geometry,
    ray: &PreparedRay,
    tests: &mut TestCounts,
) -> Hit {
    let (mut best, exactly) = (Hit::MISS, Exactly::default());
    for number in 0..geometry.len() as u32 {
        if let Some(t) = geometry
            .hit::<P>(number, ray, tests, |t| geometry.has_surface(number, ray, t, &exactly))
            && let hit = (Hit { t, primitive: number })
            && geometry.comes_first::<P>(&hit, &best, || ray.ray)
            && !(Q::ANY && geometry.is_light(number))
            && geometry.can_be_hit(number)
        {
            best = hit;
            if Q::ANY {
                break;
            }
        }
    }
    best
}
