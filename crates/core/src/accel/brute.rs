//! Brute force over all primitives: the reference for the tree.

use super::Hit;
use super::query::Query;
use crate::counters::TestCounts;
use crate::geometry::Geometry;
use crate::kernels::precision::Arithmetic;
use crate::math::ray::Ray;

/// The hit for query `Q` on primitives with these numbers.
pub(super) fn hit<Q: Query, P: Arithmetic>(
    geometry: &Geometry,
    numbers: std::ops::Range<u32>,
    ray: &Ray,
    tests: &mut TestCounts,
) -> Hit {
    let mut best = Hit::MISS;
    for primitive in numbers {
        if let Some(t) = geometry.hit::<P>(primitive, ray, tests)
            && let hit = (Hit { t, primitive })
            && geometry.order(ray, hit, best).is_lt()
            && !(Q::ANY && geometry.is_passed(primitive))
        {
            best = hit;
            if Q::ANY {
                break;
            }
        }
    }
    best
}
