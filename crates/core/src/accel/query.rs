//! The queries: closest hit and any hit.

use fearless_simd::prelude::*;
use fearless_simd::{f32x4, u32x4};

use super::geometry::Geometry;
use super::{BLOCK_EDGE, Hit, KernelCounts, Kernels, NO_PRIMITIVE};
use crate::math::ray::Ray;
use crate::math::simd::Lanes;

/// A query for a ray.
pub(super) trait Query {
    /// The answer.
    type Answer: Copy;

    /// Whether any hit suffices.
    const ANY: bool;

    /// The answer for a ray that cannot be traced.
    const NONE: Self::Answer;

    /// The answer for a finished ray.
    fn answer(best: Hit) -> Self::Answer;

    /// A hit with this answer.
    fn hit(answer: Self::Answer) -> Hit;

    /// Writes the answers for a row of finished packet rays: the hit of each, and in the lowest
    /// bits of `done` the rays for which any hit was enough.
    fn write<S: Lanes>(
        simd: S,
        t: &[f32; BLOCK_EDGE],
        primitive: &[u32; BLOCK_EDGE],
        done: u32,
        answers: &mut [Self::Answer; BLOCK_EDGE],
    );

    /// The hit to continue with after `answer`; `None` if the answer is final.
    #[inline(always)]
    fn resume(answer: Self::Answer, ray: &Ray) -> Option<Hit> {
        match Self::hit(answer) {
            hit if hit.is_miss() => Some(no_hit(ray)),
            _ if Self::ANY => None,
            hit => Some(hit),
        }
    }

    /// The hit, moved to the triangle that its seal stands for if that matters.
    #[inline(always)]
    fn unsealed(geometry: &Geometry, hit: Hit) -> Hit {
        if Self::ANY { hit } else { geometry.unsealed(hit) }
    }

    /// The counters for its rays.
    fn counts(kernels: &mut Kernels) -> &mut KernelCounts;

    /// Memory for its answers.
    fn of(answers: &mut Answers) -> &mut Vec<Self::Answer>;
}

/// Memory for answers of any kind.
#[derive(Clone, Debug, Default)]
pub(super) struct Answers {
    hits: Vec<Hit>,
    occluded: Vec<bool>,
}

/// The placeholder hit of `ray` before any hit.
#[inline(always)]
pub(super) fn no_hit(ray: &Ray) -> Hit {
    Hit { t: ray.t_max, primitive: NO_PRIMITIVE }
}

/// `best`, or a miss if nothing was hit.
#[inline(always)]
pub(super) fn or_miss(best: Hit) -> Hit {
    if best.is_miss() { Hit::MISS } else { best }
}

/// The primitive that is hit first.
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
    fn hit(answer: Hit) -> Hit {
        answer
    }

    // In vectors: values just written one by one are slow to copy.
    #[inline(always)]
    fn write<S: Lanes>(
        simd: S,
        t: &[f32; BLOCK_EDGE],
        primitive: &[u32; BLOCK_EDGE],
        _: u32,
        answers: &mut [Hit; BLOCK_EDGE],
    ) {
        let t: f32x4<S> = (*t).simd_into(simd);
        let primitive: u32x4<S> = (*primitive).simd_into(simd);
        let answers: &mut [u32] = bytemuck::cast_slice_mut(answers);
        t.to_bits().zip_low(primitive).store_slice(&mut answers[..4]);
        t.to_bits().zip_high(primitive).store_slice(&mut answers[4..8]);
    }

    #[inline(always)]
    fn counts(kernels: &mut Kernels) -> &mut KernelCounts {
        &mut kernels.closest
    }

    fn of(answers: &mut Answers) -> &mut Vec<Hit> {
        &mut answers.hits
    }
}

/// Whether anything except a light's shape is hit.
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
    fn hit(answer: bool) -> Hit {
        if answer { ANY_HIT } else { Hit::MISS }
    }

    #[inline(always)]
    fn write<S: Lanes>(
        _: S,
        _: &[f32; BLOCK_EDGE],
        _: &[u32; BLOCK_EDGE],
        done: u32,
        answers: &mut [bool; BLOCK_EDGE],
    ) {
        for (i, answer) in answers.iter_mut().enumerate() {
            *answer = done >> i & 1 == 1;
        }
    }

    #[inline(always)]
    fn counts(kernels: &mut Kernels) -> &mut KernelCounts {
        &mut kernels.shadow
    }

    fn of(answers: &mut Answers) -> &mut Vec<bool> {
        &mut answers.occluded
    }
}

/// The placeholder hit if any hit suffices.
pub(super) const ANY_HIT: Hit = Hit { t: 0.0, primitive: 0 };
