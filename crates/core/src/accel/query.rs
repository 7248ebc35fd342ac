//! What can be asked of rays.

use fearless_simd::prelude::*;
use fearless_simd::{f32x4, u32x4};

use super::geometry::PreparedRay;
use super::single::{no_hit, or_miss};
use super::{BLOCK_EDGE, Hit};
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

    /// Writes the answers for a row of rays that a packet is done with: what each has found, and in
    /// the lowest bits of `done` those for which any hit was enough.
    fn write<S: Lanes>(
        simd: S,
        t: &[f32; BLOCK_EDGE],
        primitive: &[u32; BLOCK_EDGE],
        done: u32,
        answers: &mut [Self::Answer; BLOCK_EDGE],
    );

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
    fn resume(answer: bool, ray: &PreparedRay) -> Option<Hit> {
        if answer { None } else { Some(no_hit(ray)) }
    }
}
