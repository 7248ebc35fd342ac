//! SIMD levels and the few operations on lanes that `fearless_simd` does not name.
//!
//! Kernels are generic over [`Lanes`] and compiled once for each level; which one runs is decided
//! at run time, by the processor or by the user. Every level computes the same numbers: lanes add,
//! multiply, divide and compare as single values do, and nothing fuses.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, f32x16, mask32x8, u32x8};
use serde::Serialize;

/// A set of vector instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// What every x86-64 processor has.
    Sse2,
    /// x86-64-v2.
    Sse42,
    /// x86-64-v3.
    Avx2,
    /// AVX-512 as of Ice Lake and Zen 4.
    Avx512,
    /// What every AArch64 processor has.
    Neon,
    /// Another instruction set of this crate's target, or none.
    Other,
}

impl Level {
    /// The best that this processor has.
    pub fn best() -> Self {
        Self::name_of(fearless_simd::Level::new())
    }

    /// All that this processor has, the best last.
    pub fn available() -> Vec<Self> {
        let all = [Self::Sse2, Self::Sse42, Self::Avx2, Self::Avx512, Self::Neon, Self::Other];
        all.into_iter().filter(|level| level.token().is_some()).collect()
    }

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sse2 => "sse2",
            Self::Sse42 => "sse42",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
            Self::Other => "other",
        }
    }

    #[allow(unreachable_patterns, reason = "which levels there are depends on the target")]
    fn name_of(level: fearless_simd::Level) -> Self {
        match level {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            fearless_simd::Level::Sse2(_) => Self::Sse2,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            fearless_simd::Level::Sse4_2(_) => Self::Sse42,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            fearless_simd::Level::Avx2(_) => Self::Avx2,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            fearless_simd::Level::Avx512(_) => Self::Avx512,
            #[cfg(target_arch = "aarch64")]
            fearless_simd::Level::Neon(_) => Self::Neon,
            _ => Self::Other,
        }
    }

    /// The proof that this processor has the level, or `None` where it has not.
    pub fn token(self) -> Option<fearless_simd::Level> {
        let best = fearless_simd::Level::new();
        match self {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sse2 => best.as_sse2().map(fearless_simd::Level::Sse2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sse42 => best.as_sse4_2().map(fearless_simd::Level::Sse4_2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx2 => best.as_avx2().map(fearless_simd::Level::Avx2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx512 => best.as_avx512().map(fearless_simd::Level::Avx512),
            other => (Self::name_of(best) == other).then_some(best),
        }
    }
}

/// Work that is compiled once for each level.
pub trait Kernel {
    /// What it returns.
    type Output;

    /// Does the work. `#[inline(always)]`, as is all that it calls in its hot part: code takes
    /// over the instructions of the function that it is inlined into.
    fn run<S: Lanes>(self, simd: S) -> Self::Output;
}

/// Runs `kernel` with the instructions of `level`.
#[inline]
#[allow(unreachable_patterns, reason = "which levels there are depends on the target")]
pub fn dispatch<K: Kernel>(level: fearless_simd::Level, kernel: K) -> K::Output {
    #[inline(always)]
    fn run<S: Lanes, K: Kernel>(simd: S, kernel: K) -> K::Output {
        simd.vectorize(
            #[inline(always)]
            || kernel.run(simd),
        )
    }
    match level {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        fearless_simd::Level::Avx512(simd) => run(simd, kernel),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        fearless_simd::Level::Avx2(simd) => run(simd, kernel),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        fearless_simd::Level::Sse4_2(simd) => run(simd, kernel),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        fearless_simd::Level::Sse2(simd) => run(simd, kernel),
        #[cfg(target_arch = "aarch64")]
        fearless_simd::Level::Neon(simd) => run(simd, kernel),
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        fearless_simd::Level::WasmSimd128(simd) => run(simd, kernel),
        #[cfg(not(any(
            target_arch = "x86",
            target_arch = "x86_64",
            target_arch = "aarch64",
            all(target_arch = "wasm32", target_feature = "simd128"),
        )))]
        fearless_simd::Level::Fallback(simd) => run(simd, kernel),
        _ => unreachable!("the target has no other level"),
    }
}

/// Number of lanes that kernels work with, whatever the width of a register.
pub const LANES: usize = 8;

/// What the kernels need of a level besides arithmetic.
pub trait Lanes: Simd {
    /// Lane i of the result is lane `indices[i]` of `values`; indices below 8.
    #[inline(always)]
    fn permute(self, values: f32x8<Self>, indices: u32x8<Self>) -> f32x8<Self> {
        // Each index becomes those of its four bytes: i -> 4 i, 4 i + 1, 4 i + 2, 4 i + 3.
        let bytes = indices * u32x8::splat(self, 0x0404_0404) + u32x8::splat(self, 0x0302_0100);
        values.swizzle_dyn(bytes.to_bytes())
    }

    /// Writes the children of `mask` as stack entries ([`entry`]), the nearest last, and returns
    /// that. What is written beyond them, or returned where there is none, has no meaning.
    // The last is returned since reading it back from where a whole vector was just written would
    // have to wait for that.
    #[inline(always)]
    fn far_to_near(
        self,
        near: f32x8<Self>,
        children: u32x8<Self>,
        mask: mask32x8<Self>,
        entries: &mut [u64; LANES],
    ) -> u64 {
        let (near, children) = (<[f32; LANES]>::from(near), <[u32; LANES]>::from(children));
        let mut bits = mask.to_bitmask();
        let (mut count, mut nearest) = (0, u64::MAX);
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize & (LANES - 1);
            bits &= bits - 1;
            let new = entry(near[lane], children[lane]);
            let mut place = count;
            while place > 0 && entries[place - 1] < new {
                entries[place] = entries[place - 1];
                place -= 1;
            }
            entries[place] = new;
            nearest = nearest.min(new);
            count += 1;
        }
        nearest
    }

    /// Where the first sixteen bits of `mask` are, or all if it has fewer.
    #[inline(always)]
    fn positions(self, mask: u64) -> [u32; 16] {
        let (mut positions, mut rest) = ([0; 16], mask);
        for position in &mut positions {
            *position = rest.trailing_zeros() % 64;
            rest &= rest.wrapping_sub(1);
        }
        positions
    }

    /// Lane i of the result is `column[positions[i]]`; positions below 64.
    #[inline(always)]
    fn pick(self, column: &[[f32; 16]; 4], positions: [u32; 16]) -> f32x16<Self> {
        let mut picked = [0.0; 16];
        for (picked, position) in picked.iter_mut().zip(positions) {
            *picked = column.as_flattened()[position as usize % 64];
        }
        picked.simd_into(self)
    }

    /// As [`Lanes::far_to_near`], in any order.
    #[inline(always)]
    fn compress(
        self,
        near: f32x8<Self>,
        children: u32x8<Self>,
        mask: mask32x8<Self>,
        entries: &mut [u64; LANES],
    ) -> u64 {
        let (near, children) = (<[f32; LANES]>::from(near), <[u32; LANES]>::from(children));
        let mut bits = mask.to_bitmask();
        let (mut count, mut last) = (0, 0);
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize & (LANES - 1);
            bits &= bits - 1;
            last = entry(near[lane], children[lane]);
            entries[count & (LANES - 1)] = last;
            count += 1;
        }
        last
    }
}

/// What waits on a stack: a child, and above it where the ray enters it, so that whole entries
/// compare as their distances do where these are not negative.
#[inline(always)]
pub fn entry(near: f32, child: u32) -> u64 {
    u64::from(near.to_bits()) << 32 | u64::from(child)
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod x86 {
    use super::{LANES, Lanes};
    use fearless_simd::prelude::*;
    use fearless_simd::{
        Avx2, Avx512, Sse2, Sse4_2, f32x8, f32x16, mask32x8, u32x8, u32x16, u64x8,
    };
    #[cfg(target_arch = "x86")]
    use std::arch::x86::*;
    #[cfg(target_arch = "x86_64")]
    use std::arch::x86_64::*;

    impl Lanes for Sse2 {}

    impl Lanes for Sse4_2 {}

    fearless_simd::kernel!(
        #[inline(always)]
        fn permute_avx2(level: Avx2, values: f32x8<Avx2>, indices: u32x8<Avx2>) -> f32x8<Avx2> {
            _mm256_permutevar8x32_ps(values.into(), indices.into()).simd_into(level)
        }
    );

    impl Lanes for Avx2 {
        #[inline(always)]
        fn permute(self, values: f32x8<Self>, indices: u32x8<Self>) -> f32x8<Self> {
            permute_avx2(self, values, indices)
        }
    }

    fearless_simd::kernel!(
        #[inline(always)]
        fn permute_avx512(
            level: Avx512,
            values: f32x8<Avx512>,
            indices: u32x8<Avx512>,
        ) -> f32x8<Avx512> {
            _mm256_permutevar8x32_ps(values.into(), indices.into()).simd_into(level)
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        fn entries_avx512(_level: Avx512, near: f32x8<Avx512>, children: u32x8<Avx512>) -> __m512i {
            let near: __m256 = near.into();
            let high = _mm512_slli_epi64::<32>(_mm512_cvtepu32_epi64(_mm256_castps_si256(near)));
            _mm512_or_si512(high, _mm512_cvtepu32_epi64(children.into()))
        }
    );

    fearless_simd::kernel!(
        /// Bitonic sort (Batcher 1968), the largest first, so that lanes out of the mask, which
        /// are zero, come last.
        #[inline(always)]
        fn sort_avx512(level: Avx512, entries: __m512i, mask: u8) -> u64x8<Avx512> {
            let v = _mm512_maskz_mov_epi64(mask, entries);
            // In each step lane i meets lane i ^ x, and the lower lane keeps the larger entry.
            let p = _mm512_shuffle_epi32::<0x4E>(v);
            let v = _mm512_mask_max_epu64(_mm512_min_epu64(v, p), 0b0101_0101, v, p);
            let p = _mm512_permutex_epi64::<0x1B>(v);
            let v = _mm512_mask_max_epu64(_mm512_min_epu64(v, p), 0b0011_0011, v, p);
            let p = _mm512_shuffle_epi32::<0x4E>(v);
            let v = _mm512_mask_max_epu64(_mm512_min_epu64(v, p), 0b0101_0101, v, p);
            let p = _mm512_permutexvar_epi64(_mm512_set_epi64(0, 1, 2, 3, 4, 5, 6, 7), v);
            let v = _mm512_mask_max_epu64(_mm512_min_epu64(v, p), 0b0000_1111, v, p);
            let p = _mm512_permutex_epi64::<0x4E>(v);
            let v = _mm512_mask_max_epu64(_mm512_min_epu64(v, p), 0b0011_0011, v, p);
            let p = _mm512_shuffle_epi32::<0x4E>(v);
            let v = _mm512_mask_max_epu64(_mm512_min_epu64(v, p), 0b0101_0101, v, p);
            v.simd_into(level)
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        fn compress_avx512(level: Avx512, entries: __m512i, mask: u8) -> u64x8<Avx512> {
            _mm512_maskz_compress_epi64(mask, entries).simd_into(level)
        }
    );

    fearless_simd::kernel!(
        /// The last of as many entries as `mask` has bits.
        #[inline(always)]
        fn last_avx512(_level: Avx512, entries: u64x8<Avx512>, mask: u8) -> u64 {
            let last = _mm512_set1_epi64(i64::from(mask.count_ones()) - 1);
            let entries = _mm512_permutexvar_epi64(last, entries.into());
            _mm_cvtsi128_si64(_mm512_castsi512_si128(entries)) as u64
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        fn positions_avx512(level: Avx512, mask: u64) -> u32x16<Avx512> {
            let all = _mm512_set_epi64(
                0x3F3E_3D3C_3B3A_3938,
                0x3736_3534_3332_3130,
                0x2F2E_2D2C_2B2A_2928,
                0x2726_2524_2322_2120,
                0x1F1E_1D1C_1B1A_1918,
                0x1716_1514_1312_1110,
                0x0F0E_0D0C_0B0A_0908,
                0x0706_0504_0302_0100,
            );
            let positions = _mm512_maskz_compress_epi8(mask, all);
            _mm512_cvtepu8_epi32(_mm512_castsi512_si128(positions)).simd_into(level)
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        fn pick_avx512(
            level: Avx512,
            a: f32x16<Avx512>,
            b: f32x16<Avx512>,
            c: f32x16<Avx512>,
            d: f32x16<Avx512>,
            positions: u32x16<Avx512>,
        ) -> f32x16<Avx512> {
            let positions = positions.into();
            let low = _mm512_permutex2var_ps(a.into(), positions, b.into());
            let high = _mm512_permutex2var_ps(c.into(), positions, d.into());
            let is_high = _mm512_test_epi32_mask(positions, _mm512_set1_epi32(32));
            _mm512_mask_blend_ps(is_high, low, high).simd_into(level)
        }
    );

    impl Lanes for Avx512 {
        #[inline(always)]
        fn positions(self, mask: u64) -> [u32; 16] {
            positions_avx512(self, mask).into()
        }

        #[inline(always)]
        fn pick(self, column: &[[f32; 16]; 4], positions: [u32; 16]) -> f32x16<Self> {
            let [a, b, c, d] = *column;
            let (a, b) = (a.simd_into(self), b.simd_into(self));
            let (c, d) = (c.simd_into(self), d.simd_into(self));
            pick_avx512(self, a, b, c, d, positions.simd_into(self))
        }

        #[inline(always)]
        fn permute(self, values: f32x8<Self>, indices: u32x8<Self>) -> f32x8<Self> {
            permute_avx512(self, values, indices)
        }

        #[inline(always)]
        fn far_to_near(
            self,
            near: f32x8<Self>,
            children: u32x8<Self>,
            mask: mask32x8<Self>,
            entries: &mut [u64; LANES],
        ) -> u64 {
            let all = entries_avx512(self, near, children);
            let mask = mask.to_bitmask() as u8;
            let sorted = sort_avx512(self, all, mask);
            *entries = sorted.into();
            last_avx512(self, sorted, mask)
        }

        #[inline(always)]
        fn compress(
            self,
            near: f32x8<Self>,
            children: u32x8<Self>,
            mask: mask32x8<Self>,
            entries: &mut [u64; LANES],
        ) -> u64 {
            let all = entries_avx512(self, near, children);
            let mask = mask.to_bitmask() as u8;
            let compressed = compress_avx512(self, all, mask);
            *entries = compressed.into();
            last_avx512(self, compressed, mask)
        }
    }
}

#[cfg(target_arch = "aarch64")]
impl Lanes for fearless_simd::Neon {}

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
impl Lanes for fearless_simd::WasmSimd128 {}

#[cfg(not(any(
    target_arch = "x86",
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "wasm32", target_feature = "simd128"),
)))]
impl Lanes for fearless_simd::Fallback {}

#[cfg(test)]
mod tests {
    use super::*;

    struct All {
        near: [f32; 8],
        mask: u64,
        indices: [u32; 8],
    }

    impl Kernel for All {
        type Output = (Vec<u64>, Vec<u64>, [f32; 8]);

        fn run<S: Lanes>(self, simd: S) -> Self::Output {
            let children = [10, 11, 12, 13, 14, 15, 16, 17].simd_into(simd);
            let (mut sorted, mut compressed) = ([0; LANES], [0; LANES]);
            let mask = mask32x8::from_bitmask(simd, self.mask);
            let near = self.near.simd_into(simd);
            let nearest = simd.far_to_near(near, children, mask, &mut sorted);
            let last = simd.compress(near, children, mask, &mut compressed);
            let count = self.mask.count_ones() as usize;
            if count > 0 {
                assert_eq!([nearest, last], [sorted[count - 1], compressed[count - 1]]);
            }
            let values: [f32; 8] = [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5];
            let permuted = simd.permute(values.simd_into(simd), self.indices.simd_into(simd));
            (sorted[..count].to_vec(), compressed[..count].to_vec(), permuted.into())
        }
    }

    #[test]
    fn every_level_sorts_compresses_and_permutes() {
        for level in Level::available() {
            let token = level.token().expect("it is available");
            for seed in 0..2000_u32 {
                let random = |i: u32| (seed * 8 + i).wrapping_mul(0x9E37_79B1) >> 8;
                let near = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| (random(i) % 1000) as f32 / 8.0);
                let mask = u64::from(random(99) & 255);
                let indices = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| random(i) % 8);
                let mut expected: Vec<u64> = (0..8)
                    .filter(|i| mask >> i & 1 == 1)
                    .map(|i| entry(near[i], 10 + i as u32))
                    .collect();
                let (sorted, compressed, permuted) = dispatch(token, All { near, mask, indices });
                assert_eq!(compressed, expected, "{level:?}");
                expected.sort_unstable_by(|a, b| b.cmp(a));
                assert_eq!(sorted, expected, "{level:?}");
                assert_eq!(permuted, indices.map(|i| i as f32 + 0.5), "{level:?}");
            }
        }
    }
}
