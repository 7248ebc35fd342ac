//! The queries: closest hit, any hit, and everything that a ray crosses.

use super::{Best, Hit};
use crate::counters::{KernelCounts, Kernels};
use crate::geometry::Surfaces;

/// A query for a ray.
pub(super) trait Query: Default {
    type Answer: Copy;

    /// Whether any hit suffices.
    const ANY: bool = false;

    /// Whether everything that a ray crosses is asked for: then there is no closest hit.
    const ALL: bool = false;

    /// Whether triangles that the filter leaves open are taken as crossed, between unknown t.
    const TAKES_OPEN: bool = false;

    /// Whether the closest hit is asked for: then a hit ends the search beyond.
    const NEAREST: bool = !Self::ANY && !Self::ALL;

    /// The surfaces that count, if not all.
    const SURFACES: Option<Surfaces> = None;

    /// The answer for a finished ray; a ray that cannot be traced has missed.
    fn answer(best: Hit) -> Self::Answer;

    /// A hit with this answer.
    fn hit(answer: Self::Answer) -> Hit;

    /// The hit to continue with after `answer`; `None` if the answer is final.
    #[inline(always)]
    fn go_on(answer: Self::Answer) -> Option<Hit> {
        Some(Self::hit(answer)).filter(|hit| !Self::ANY || hit.is_miss())
    }

    /// Takes a point at which the ray with that number crosses a surface.
    #[inline(always)]
    fn cross(&mut self, _ray: usize, _at: Best) {}

    /// The counters for its rays.
    fn counts(kernels: &mut Kernels) -> &mut KernelCounts;
}

/// The primitive that is hit first.
#[derive(Default)]
pub(super) struct Closest;

impl Query for Closest {
    type Answer = Hit;

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

/// Whether anything opaque is hit.
#[derive(Default)]
pub(super) struct Occluded;

impl Query for Occluded {
    type Answer = bool;
    const ANY: bool = true;
    const SURFACES: Option<Surfaces> = Some(Surfaces::Opaque);

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
