//! Eight numbers at a time.

use fearless_simd::ExtractToken;
use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f64x8, mask32x8, mask32x16, mask64x8, u32x8};

use super::{MANTISSA, Mask, ROOT, Real, Single};
use crate::math::simd::{LANES, Lanes, outlined};

macro_rules! mask {
    ($mask:ident, $lanes:literal) => {
        impl<S: Lanes> Mask for $mask<S> {
            #[inline(always)]
            fn bits(self) -> u32 {
                // Bits beyond the lanes are unspecified.
                self.to_bitmask() as u32 & (u32::MAX >> (32 - $lanes))
            }
        }
    };
}

mask!(mask32x8, 8);
mask!(mask64x8, 8);
mask!(mask32x16, 16);

macro_rules! lanes {
    ($float:ident, $element:ty, $mask:ident) => {
        impl<S: Lanes> Real for $float<S> {
            type Element = $element;
            type Mask = $mask<S>;
            const LANES: usize = LANES;

            #[inline(always)]
            fn same(self, value: $element) -> Self {
                <Self as SimdBase<S>>::splat(ExtractToken::token(&self), value)
            }

            #[inline(always)]
            fn same_rounded(self, value: f64) -> Self {
                self.same(value as $element)
            }

            #[inline(always)]
            fn lane(self, i: usize) -> $element {
                self[i]
            }

            #[inline(always)]
            fn set_lane(&mut self, i: usize, value: $element) {
                self[i] = value;
            }

            as_elsewhere! {
                abs() -> Self = SimdBase::abs;
                sqrt() -> Self = SimdFloat::sqrt;
                floor() -> Self = SimdFloat::floor;
                copysign(sign) -> Self = SimdFloat::copysign;
                min(other) -> Self = <Self as SimdBase<S>>::min;
                max(other) -> Self = <Self as SimdBase<S>>::max;
                lt(other) -> $mask<S> = SimdBase::simd_lt;
                le(other) -> $mask<S> = SimdBase::simd_le;
                eq(other) -> $mask<S> = SimdBase::simd_eq;
            }

            #[inline(always)]
            fn select(mask: $mask<S>, a: Self, b: Self) -> Self {
                mask.select(a, b)
            }
        }
    };
}

lanes!(f32x8, f32, mask32x8);
lanes!(f64x8, f64, mask64x8);

impl<S: Lanes> Single for f32x8<S> {
    type Double = f64x8<S>;
    type Token = S;
    type Row = [f32; LANES];
    type Integers = [u32; LANES];

    #[inline(always)]
    fn token(self) -> S {
        ExtractToken::token(&self)
    }

    #[inline(always)]
    fn splat(simd: S, value: f32) -> Self {
        <Self as SimdBase<S>>::splat(simd, value)
    }

    #[inline(always)]
    fn from_slice(simd: S, values: &[f32]) -> Self {
        <Self as SimdBase<S>>::from_slice(simd, &values[..LANES])
    }

    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        self.store_slice(&mut values[..LANES]);
    }

    #[inline(always)]
    fn pack(self, mask: mask32x8<S>, values: &mut [f32]) {
        self.compress(mask).store_slice(&mut values[..LANES]);
    }

    #[inline(always)]
    fn pack_integers(simd: S, words: &[u32], mask: mask32x8<S>, values: &mut [u32]) {
        let words: u32x8<S> = <u32x8<S> as SimdBase<S>>::from_slice(simd, &words[..LANES]);
        words.compress(mask).store_slice(&mut values[..LANES]);
    }

    #[inline(always)]
    fn mask(simd: S, bits: u32) -> mask32x8<S> {
        mask32x8::from_bitmask(simd, u64::from(bits))
    }

    #[inline(always)]
    fn widen(self) -> f64x8<S> {
        Lanes::widen(ExtractToken::token(&self), self)
    }

    #[inline(always)]
    fn narrow(wide: f64x8<S>) -> Self {
        Lanes::narrow(ExtractToken::token(&wide), wide)
    }

    #[inline(always)]
    fn outlined<R>(simd: S, work: impl FnOnce() -> R) -> R {
        outlined(simd, work)
    }

    #[inline(always)]
    fn integers(self) -> [u32; LANES] {
        SimdFloat::to_int::<u32x8<S>>(self).into()
    }

    #[inline(always)]
    fn byte(simd: S, words: &[u32; LANES], bit: u32) -> Self {
        let words: u32x8<S> = <u32x8<S> as SimdBase<S>>::from_slice(simd, words);
        SimdInt::to_float(words >> bit & 0xFF)
    }

    #[inline(always)]
    fn parts(self) -> (Self, Self) {
        let above = self.bitcast::<u32x8<S>>() - ROOT;
        (SimdInt::to_float(above >> 23), ((above & MANTISSA) + ROOT).bitcast())
    }

    #[inline(always)]
    fn round_away(self, shift: Self) -> Self {
        const SIGN: u32 = 1 << 31;
        let simd = ExtractToken::token(&self);
        let bits: u32x8<S> = self.bitcast();
        let sign = shift.bitcast::<u32x8<S>>() & SIGN;
        // If number and shift have the same sign, the adjacent float away from zero has the next
        // bit pattern.
        let outward = ((bits ^ sign) & SIGN).simd_eq(u32x8::splat(simd, 0));
        let next = outward.select(bits + 1, bits - 1);
        let from_zero = sign | 1;
        let next = self.simd_eq(0.0).select(from_zero, next);
        let moves = shift.simd_ne(0.0) & SimdBase::abs(self).simd_lt(f32::INFINITY);
        moves.select(next, bits).bitcast()
    }
}
