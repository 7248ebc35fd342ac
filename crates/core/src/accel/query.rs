//! What can be asked of rays.

use fearless_simd::prelude::*;
use fearless_simd::{f32x4, u32x4};

use super::geometry::Geometry;
use super::{BLOCK_EDGE, Hit, KernelCounts, Kernels, NO_PRIMITIVE};
use crate::math::ray::Ray;
use crate::math::simd::Lanes;

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

    /// A hit that has this answer.
    fn hit(answer: Self::Answer) -> Hit;

    /// Writes the answers for a row of rays that a packet is done with: what each has found, and in
    /// the lowest bits of `done` those for which any hit was enough.
    fn write<S: Lanes>(
        simd: S,
        t: &[f32; BLOCK_EDGE],
        primitive: &[u32; BLOCK_EDGE],
        done: u32,
        answers: &mut [Self::Answer; BLOCK_EDGE],
    );

    /// The hit to go on with where `answer` has been found so far; `None` if nothing more can come.
    #[inline(always)]
    fn resume(answer: Self::Answer, ray: &Ray) -> Option<Hit> {
        match Self::hit(answer) {
            hit if hit.is_miss() => Some(no_hit(ray)),
            _ if Self::ANY => None,
            hit => Some(hit),
        }
    }

    /// The hit, on what a seal stands for if it is on one and that matters.
    #[inline(always)]
    fn unsealed(geometry: &Geometry, hit: Hit) -> Hit {
        if Self::ANY { hit } else { geometry.unsealed(hit) }
    }

    /// Where its rays are counted.
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

/// The hit that stands for none yet on `ray`.
#[inline(always)]
pub(super) fn no_hit(ray: &Ray) -> Hit {
    Hit { t: ray.t_max, primitive: NO_PRIMITIVE }
}

/// `best`, or a miss if nothing was found.
#[inline(always)]
pub(super) fn or_miss(best: Hit) -> Hit {
    if best.is_miss() { Hit::MISS } else { best }
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
    fn hit(answer: Hit) -> Hit {
        answer
    }

    // In vectors: what is written number by number is not copied well afterwards.
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

/// Stands for a hit where any is as good.
pub(super) const ANY_HIT: Hit = Hit { t: 0.0, primitive: 0 };
