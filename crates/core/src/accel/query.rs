//! The queries: closest hit and any hit.

use super::Hit;
use crate::counters::{KernelCounts, Kernels};

/// A query for a ray.
pub(super) trait Query {
    type Answer: Copy;

    /// Whether any hit suffices.
    const ANY: bool;

    /// The answer for a finished ray; a ray that cannot be traced has missed.
    fn answer(best: Hit) -> Self::Answer;

    /// A hit with this answer.
    fn hit(answer: Self::Answer) -> Hit;

    /// The hit to continue with after `answer`; `None` if the answer is final.
    #[inline(always)]
    fn go_on(answer: Self::Answer) -> Option<Hit> {
        Some(Self::hit(answer)).filter(|hit| !Self::ANY || hit.is_miss())
    }

    /// The counters for its rays.
    fn counts(kernels: &mut Kernels) -> &mut KernelCounts;
}

/// The primitive that is hit first.
pub(super) struct Closest;

impl Query for Closest {
    type Answer = Hit;
    const ANY: bool = false;

    #[inline(always)]
    fn answer(best: Hit) -> Hit {
        best
    }

    #[inline(always)]
    fn hit(answer: Hit) -> Hit {
        answer
    }

    #[inline(always)]
    fn counts(kernels: &mut Kernels) -> &mut KernelCounts {
        &mut kernels.closest
    }
}

/// Whether anything except a light's shape is hit.
pub(super) struct Occluded;

impl Query for Occluded {
    type Answer = bool;
    const ANY: bool = true;

    #[inline(always)]
    fn answer(best: Hit) -> bool {
        !best.is_miss()
    }

    #[inline(always)]
    fn hit(answer: bool) -> Hit {
        if answer { ANY_HIT } else { Hit::MISS }
    }

    #[inline(always)]
    fn counts(kernels: &mut Kernels) -> &mut KernelCounts {
        &mut kernels.shadow
    }
}

/// The placeholder hit if any hit suffices.
pub(super) const ANY_HIT: Hit = Hit { t: 0.0, primitive: 0 };
