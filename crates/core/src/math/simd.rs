//! SIMD levels, and the few lane operations that `fearless_simd` lacks.
//!
//! Kernels are generic over [`Lanes`] and compiled once for each level; the processor or the user
//! selects the level at run time. Every level finds the same answers: lanes add, multiply, divide and
//! compare like single values, and only numbers with a bound are found by fused operations.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, f64x8, mask32x8, u32x8};
use serde::Serialize;

use super::real::Single;

wavecrest_base::choices! {
    /// A set of vector instructions.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Level {
        /// What every x86-64 processor has, for those without AVX2.
        Sse2 = "sse2",
        /// x86-64-v3.
        Avx2 = "avx2",
        /// AVX-512 as of Ice Lake and Zen 4.
        Avx512 = "avx512",
        /// What every AArch64 processor has.
        Neon = "neon",
        /// Another instruction set of this crate's target, or none.
        Other = "other",
    }
}

impl Level {
    /// The best level of this processor.
    pub fn best() -> Self {
        Self::available().pop().unwrap_or(Self::Other)
    }

    /// All levels of this processor, the best last.
    pub fn available() -> Vec<Self> {
        Self::ALL.into_iter().filter(|level| level.token().is_some()).collect()
    }

    /// The proof that this processor has the level, or `None` if it has not.
    pub fn token(self) -> Option<fearless_simd::Level> {
        let best = fearless_simd::Level::new();
        match self {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sse2 => best.as_sse2().map(fearless_simd::Level::Sse2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx2 => best.as_avx2().map(fearless_simd::Level::Avx2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx512 => best.as_avx512().map(fearless_simd::Level::Avx512),
            #[cfg(target_arch = "aarch64")]
            Self::Neon => best.as_neon().map(fearless_simd::Level::Neon),
            #[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
            Self::Other => Some(best),
            _ => None,
        }
    }
}

/// Evaluates an expression with the instructions of a level; in it `$simd` is the proof that the
/// processor has them. It is compiled once for each level, so it is best a call of one function. Mark
/// that and every function on its hot path `#[inline(always)]`: code is compiled with the instructions
/// of the function that it is inlined into.
#[macro_export]
macro_rules! at_level {
    ($level:expr, $simd:ident => $value:expr) => {
        match $level {
            #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), not(fuzzing)))]
            // In a function of its own: without other instructions than the caller's it would be inlined there, and its
            // many registers be saved for every level.
            ::fearless_simd::Level::Sse2($simd) => $crate::math::simd::outlined(
                $simd,
                #[inline(always)]
                || $value,
            ),
            #[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64",)))]
            ::fearless_simd::Level::Fallback($simd) => $crate::at_level!(@ $simd, $value),
            #[allow(unreachable_patterns, reason = "which levels there are depends on the target")]
            level => $crate::at_wide_level!(level, $simd => $value),
        }
    };
    (@ $simd:ident, $value:expr) => {
        ::fearless_simd::Simd::vectorize(
            $simd,
            #[inline(always)]
            || $value,
        )
    };
}

/// As [`at_level`](crate::at_level), only for wide levels ([`is_wide`](crate::math::simd::is_wide)): those with vectors
/// of eight numbers, and the one level of other targets.
#[macro_export]
macro_rules! at_wide_level {
    ($level:expr, $simd:ident => $value:expr) => {
        match $crate::math::simd::compiled($level) {
            #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), not(fuzzing)))]
            ::fearless_simd::Level::Avx512($simd) => $crate::at_level!(@ $simd, $value),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            ::fearless_simd::Level::Avx2($simd) => $crate::at_level!(@ $simd, $value),
            #[cfg(target_arch = "aarch64")]
            ::fearless_simd::Level::Neon($simd) => $crate::at_level!(@ $simd, $value),
            #[allow(unreachable_patterns, reason = "which levels there are depends on the target")]
            _ => unreachable!("the kernel is not compiled for this level"),
        }
    };
}

/// The level whose code runs at this one. Fuzzers use one level: with sanitizers, each level takes longer
/// to compile than all levels without.
#[inline(always)]
pub fn compiled(level: fearless_simd::Level) -> fearless_simd::Level {
    #[cfg(all(fuzzing, target_arch = "x86_64"))]
    if let Some(avx2) = fearless_simd::Level::new().as_avx2() {
        return fearless_simd::Level::Avx2(avx2);
    }
    level
}

/// Whether [`at_wide_level`] has code for the level.
#[inline]
#[allow(unreachable_patterns, reason = "which levels there are depends on the target")]
pub fn is_wide(level: fearless_simd::Level) -> bool {
    match level {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        fearless_simd::Level::Avx512(_) | fearless_simd::Level::Avx2(_) => true,
        #[cfg(target_arch = "aarch64")]
        fearless_simd::Level::Neon(_) => true,
        _ => false,
    }
}

/// Work over numbers of any width, compiled for eight lanes at each wide level ([`is_wide`]) and
/// for single values.
pub trait AnyWidth {
    /// The result.
    type Output;

    /// Runs the work. `#[inline(always)]`, as for [`at_level`].
    fn run<F: Single>(self, token: F::Token) -> Self::Output;
}

/// Runs `work` with the instructions of `level`: eight numbers at a time on wide levels, one on
/// others.
#[inline]
pub fn dispatch_any_width<T: AnyWidth>(level: fearless_simd::Level, work: T) -> T::Output {
    if is_wide(level) {
        at_wide_level!(level, simd => work.run::<f32x8<_>>(simd))
    } else {
        work.run::<f32>(())
    }
}

/// Runs `work` in a separate function with the instructions of `simd`, so that code with several
/// callers exists once.
#[inline(never)]
pub fn outlined<S: Lanes, R>(simd: S, work: impl FnOnce() -> R) -> R {
    simd.vectorize(work)
}

/// The number of lanes of a kernel, whatever the width of a register.
pub const LANES: usize = 8;

/// Operations of a level other than arithmetic.
pub trait Lanes: Simd {
    /// Lane i of the result is lane `indices[i]` of `values`; indices below 8.
    #[inline(always)]
    fn permute(self, values: f32x8<Self>, indices: u32x8<Self>) -> f32x8<Self> {
        // Each index becomes those of its four bytes: i -> 4 i, 4 i + 1, 4 i + 2, 4 i + 3.
        let bytes = indices * u32x8::splat(self, 0x0404_0404) + u32x8::splat(self, 0x0302_0100);
        values.swizzle_dyn(bytes.to_bytes())
    }

    /// Eight numbers in double precision.
    #[inline(always)]
    fn widen(self, values: f32x8<Self>) -> f64x8<Self> {
        let (low, high) = SimdWiden::widen(values);
        low.combine(high)
    }

    /// Eight numbers, rounded to single precision.
    #[inline(always)]
    fn narrow(self, values: f64x8<Self>) -> f32x8<Self> {
        let (low, high) = values.split();
        low.narrow(high)
    }

    /// Stack entries ([`entry`]) of the lanes in `mask`, which come first, and zeros.
    #[inline(always)]
    fn entries(
        self,
        near: f32x8<Self>,
        children: u32x8<Self>,
        mask: mask32x8<Self>,
    ) -> [u64; LANES] {
        let (near, children) = (near.to_bits().compress(mask), children.compress(mask));
        let (low, high) = (children.zip_low(near), children.zip_high(near));
        bytemuck::cast([<[u32; LANES]>::from(low), <[u32; LANES]>::from(high)])
    }

    /// Writes the first `count` of the `entries` ([`entry`]), behind which all are zero, to `sorted`: the nearest
    /// last. What is written behind them is unspecified.
    ///
    /// Without a branch for up to two, so that the processor works on several nodes at any time; more are rare.
    #[inline(always)]
    fn far_to_near(self, entries: &[u64; LANES], count: usize, sorted: &mut [u64; LANES]) {
        let [one, other, ..] = *entries;
        (sorted[0], sorted[1]) = (one.max(other), one.min(other));
        if count > 2 {
            insert_others(entries, 2..count, sorted);
        }
    }
}

/// Adds these `others` of the `entries` to those before, which are `sorted`. In a function of its own, which leaves
/// the registers to the usual case.
#[cold]
#[inline(never)]
fn insert_others(entries: &[u64; LANES], others: Range<usize>, sorted: &mut [u64; LANES]) {
    for mut place in others {
        let new = entries[place];
        while place > 0 && sorted[place - 1] < new {
            sorted[place] = sorted[place - 1];
            place -= 1;
        }
        sorted[place] = new;
    }
}

/// The numbers of the bits that are 1, of the first `COUNT`, in rising order.
#[inline(always)]
pub fn set_bits<const COUNT: usize>(bits: impl Into<u64>) -> impl Iterator<Item = usize> {
    let mut bits = bits.into();
    std::iter::from_fn(
        #[inline(always)]
        move || {
            let number = bits.trailing_zeros() as usize;
            bits &= bits.wrapping_sub(1);
            (number < COUNT).then_some(number)
        },
    )
}

/// A stack entry: a child in the low bits and its entry distance in the high bits, so that entries
/// compare as their distances do if these are not negative.
#[inline(always)]
pub fn entry(near: f32, child: u32) -> u64 {
    u64::from(near.to_bits()) << 32 | u64::from(child)
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod x86;

#[cfg(target_arch = "aarch64")]
impl Lanes for fearless_simd::Neon {}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64",)))]
impl Lanes for fearless_simd::Fallback {}

#[cfg(test)]
mod tests;
