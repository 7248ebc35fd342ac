//! Operations with their own instructions on x86-64.

use super::{LANES, Lanes, insert_others};
use fearless_simd::prelude::*;
use fearless_simd::{Avx2, Avx512, Sse2, f32x8, f64x8, mask32x8, u32x8, u64x4, u64x8};
#[cfg(target_arch = "x86")]
use std::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

impl Lanes for Sse2 {}

macro_rules! permute {
    ($name:ident, $level:ident) => {
        fearless_simd::kernel!(
            #[inline(always)]
            fn $name(level: $level, values: f32x8<$level>, at: u32x8<$level>) -> f32x8<$level> {
                _mm256_permutevar8x32_ps(values.into(), at.into()).simd_into(level)
            }
        );
    };
}

permute!(permute_avx2, Avx2);
permute!(permute_avx512, Avx512);

impl Lanes for Avx2 {
    #[inline(always)]
    fn permute(self, values: f32x8<Self>, indices: u32x8<Self>) -> f32x8<Self> {
        permute_avx2(self, values, indices)
    }
}

fearless_simd::kernel!(
    #[inline(always)]
    fn widen_avx512(level: Avx512, values: f32x8<Avx512>) -> f64x8<Avx512> {
        _mm512_cvtps_pd(values.into()).simd_into(level)
    }
);

fearless_simd::kernel!(
    #[inline(always)]
    fn narrow_avx512(level: Avx512, values: f64x8<Avx512>) -> f32x8<Avx512> {
        _mm512_cvtpd_ps(values.into()).simd_into(level)
    }
);

fearless_simd::kernel!(
    #[inline(always)]
    fn entries_avx512(
        level: Avx512,
        near: f32x8<Avx512>,
        children: u32x8<Avx512>,
        mask: u8,
    ) -> u64x8<Avx512> {
        let near: __m256 = near.into();
        let high = _mm512_slli_epi64::<32>(_mm512_cvtepu32_epi64(_mm256_castps_si256(near)));
        let all = _mm512_or_si512(high, _mm512_cvtepu32_epi64(children.into()));
        _mm512_maskz_compress_epi64(mask, all).simd_into(level)
    }
);

fearless_simd::kernel!(
    /// Bitonic sort (Batcher 1968), the largest first.
    #[inline(always)]
    fn sort_four_avx512(level: Avx512, entries: u64x4<Avx512>) -> u64x4<Avx512> {
        let v = entries.into();
        let p = _mm256_shuffle_epi32::<0x4E>(v);
        let v = _mm256_mask_max_epu64(_mm256_min_epu64(v, p), 0b0101, v, p);
        let p = _mm256_permute4x64_epi64::<0x1B>(v);
        let v = _mm256_mask_max_epu64(_mm256_min_epu64(v, p), 0b0011, v, p);
        let p = _mm256_shuffle_epi32::<0x4E>(v);
        _mm256_mask_max_epu64(_mm256_min_epu64(v, p), 0b0101, v, p).simd_into(level)
    }
);

impl Lanes for Avx512 {
    #[inline(always)]
    fn widen(self, values: f32x8<Self>) -> f64x8<Self> {
        widen_avx512(self, values)
    }

    #[inline(always)]
    fn narrow(self, values: f64x8<Self>) -> f32x8<Self> {
        narrow_avx512(self, values)
    }

    #[inline(always)]
    fn permute(self, values: f32x8<Self>, indices: u32x8<Self>) -> f32x8<Self> {
        permute_avx512(self, values, indices)
    }

    #[inline(always)]
    fn entries(
        self,
        near: f32x8<Self>,
        children: u32x8<Self>,
        mask: mask32x8<Self>,
    ) -> [u64; LANES] {
        entries_avx512(self, near, children, mask.to_bitmask() as u8).into()
    }

    #[inline(always)]
    fn far_to_near(self, entries: &[u64; LANES], count: usize, sorted: &mut [u64; LANES]) {
        let first = u64x4::from_slice(self, &entries[..4]);
        sort_four_avx512(self, first).store_slice(&mut sorted[..4]);
        if count > 4 {
            insert_others(entries, 4..count, sorted);
        }
    }
}
