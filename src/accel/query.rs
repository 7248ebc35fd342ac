//! What can be asked of rays.

use super::Hit;
use super::geometry::PreparedRay;
use super::single::{no_hit, or_miss};

/// A question about a ray.
pub(super) trait Query {
    /// The answer.
    type Answer: Copy;

    /// Whether one hit is as good as any.
    const ANY: bool;

    /// The answer for a ray that cannot be traced.
    const NONE: Self::Answer;

    /// The answer, once the ray is done.
    fn answer(best: Hit) -> Self::Answer;

    /// The hit to go on with where a packet has answered so far; `None` if that is the answer.
    fn resume(answer: Self::Answer, ray: &PreparedRay) -> Option<Hit>;
}

/// Which primitive is hit first.
pub(super) struct Closest;

impl Query for Closest {
    type Answer = Hit;
    const ANY: bool = false;
    const NONE: Hit = Hit::MISS;

    #[inline(always)]
    fn answer(best: Hit) -> Hit {
        or_miss(best)
    }

    #[inline(always)]
    fn resume(answer: Hit, ray: &PreparedRay) -> Option<Hit> {
        Some(if answer.is_miss() { no_hit(ray) } else { answer })
    }
}

/// Whether anything but a light's shape is hit.
pub(super) struct Occluded;

impl Query for Occluded {
    type Answer = bool;
    const ANY: bool = true;
    const NONE: bool = false;

    #[inline(always)]
    fn answer(best: Hit) -> bool {
        !best.is_miss()
    }

    #[inline(always)]
    fn resume(answer: bool, ray: &PreparedRay) -> Option<Hit> {
        if answer { None } else { Some(no_hit(ray)) }
    }
}
