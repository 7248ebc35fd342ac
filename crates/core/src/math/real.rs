//! Numbers of any width: a value, or a value in each lane of a vector.
//!
//! Kernels are written once over these traits, and compiled for a single value (`f32`) as for eight or sixteen at a
//! time. Every width computes the same bits: lanes add, multiply, divide and compare as single values do, and
//! nothing fuses.

mod lanes;

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A truth value, or one in each lane.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// The lanes that are true, a bit each.
    fn bits(self) -> u32;

    /// Whether any is true.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

impl Mask for bool {
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

/// A number, or one in each lane.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// What a lane holds.
    type Element: Copy + Debug + PartialEq;

    /// The answer of a comparison.
    type Mask: Mask;

    /// How many lanes.
    const LANES: usize;

    /// `value` in as many lanes as this has.
    fn same(self, value: Self::Element) -> Self;

    /// The number of one lane.
    fn lane(self, i: usize) -> Self::Element;

    /// Replaces the number of one lane.
    fn set_lane(&mut self, i: usize, value: Self::Element);

    /// The magnitude.
    fn abs(self) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The magnitude of this with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;

    /// The smaller of two, neither a NaN.
    fn min(self, other: Self) -> Self;

    /// The larger of two, neither a NaN.
    fn max(self, other: Self) -> Self;

    /// Where this is less.
    fn lt(self, other: Self) -> Self::Mask;

    /// Where this is less or equal.
    fn le(self, other: Self) -> Self::Mask;

    /// Where both are equal.
    fn eq(self, other: Self) -> Self::Mask;

    /// `a` where `mask` is true, `b` elsewhere.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;

    /// Where this is greater.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// Where this is greater or equal.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }

    /// Where they differ, or one is a NaN.
    #[inline(always)]
    fn ne(self, other: Self) -> Self::Mask {
        !self.eq(other)
    }

    /// Times the same number in each lane.
    #[inline(always)]
    fn times(self, factor: Self::Element) -> Self {
        self * self.same(factor)
    }

    /// Zeros.
    fn zero(self) -> Self;
}

/// Numbers in single precision, which can be loaded, and widened to double precision.
pub trait Single: Real<Element = f32> {
    /// As many numbers in double precision.
    type Double: Real<Element = f64>;

    /// What is needed to make such numbers: a proof that the processor has the instructions.
    type Token: Copy;

    /// As many numbers in memory.
    type Row: Copy + Debug + Default + AsRef<[f32]> + AsMut<[f32]>;

    /// Proof from a number that is there.
    fn token(self) -> Self::Token;

    /// `value` in each lane.
    fn splat(token: Self::Token, value: f32) -> Self;

    /// From memory.
    fn load(token: Self::Token, row: &Self::Row) -> Self;

    /// The first of `values`, which has as many as there are lanes.
    fn from_slice(token: Self::Token, values: &[f32]) -> Self;

    /// Replaces the first of `values`.
    fn store(self, values: &mut [f32]);

    /// Replaces the first of `values` by the lanes of `mask`, one after the other. What follows them has no
    /// meaning.
    fn pack(self, mask: Self::Mask, values: &mut [f32]);

    /// As [`Self::pack`], for whole numbers: the lanes are the first of `words`.
    fn pack_words(token: Self::Token, words: &[u32], mask: Self::Mask, values: &mut [u32]);

    /// The lanes whose bits are set.
    fn mask(token: Self::Token, bits: u32) -> Self::Mask;

    /// Exactly, in double precision.
    fn widen(self) -> Self::Double;

    /// Rounded to single precision.
    fn narrow(wide: Self::Double) -> Self;

    /// Runs `work` in a function of its own with the instructions of the level: what is called from several
    /// places then exists once.
    fn outlined<R>(token: Self::Token, work: impl FnOnce() -> R) -> R;

    /// The neighbour of each number on the side of the shift's sign, or the number itself where there is no
    /// shift or it is infinite.
    fn round_away(self, shift: Self) -> Self;
}

macro_rules! one {
    ($float:ty) => {
        impl Real for $float {
            type Element = Self;
            type Mask = bool;
            const LANES: usize = 1;

            #[inline(always)]
            fn same(self, value: Self) -> Self {
                value
            }

            #[inline(always)]
            fn lane(self, _: usize) -> Self {
                self
            }

            #[inline(always)]
            fn set_lane(&mut self, _: usize, value: Self) {
                *self = value;
            }

            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                <$float>::sqrt(self)
            }

            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                <$float>::copysign(self, sign)
            }

            // One instruction each, unlike the standard library's, which look out for NaNs.
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }

            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }

            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }

            #[inline(always)]
            fn eq(self, other: Self) -> bool {
                self == other
            }

            #[inline(always)]
            fn select(mask: bool, a: Self, b: Self) -> Self {
                if mask { a } else { b }
            }

            #[inline(always)]
            fn zero(self) -> Self {
                0.0
            }
        }
    };
}

one!(f32);
one!(f64);

impl Single for f32 {
    type Double = f64;
    type Token = ();
    type Row = [Self; 1];

    #[inline(always)]
    fn token(self) {}

    #[inline(always)]
    fn splat((): (), value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn load((): (), [value]: &[f32; 1]) -> Self {
        *value
    }

    #[inline(always)]
    fn from_slice((): (), values: &[f32]) -> Self {
        values[0]
    }

    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        values[0] = self;
    }

    #[inline(always)]
    fn pack(self, _: bool, values: &mut [f32]) {
        values[0] = self;
    }

    #[inline(always)]
    fn pack_words((): (), words: &[u32], _: bool, values: &mut [u32]) {
        values[0] = words[0];
    }

    #[inline(always)]
    fn mask((): (), bits: u32) -> bool {
        bits & 1 == 1
    }

    #[inline(always)]
    fn widen(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn narrow(wide: f64) -> Self {
        wide as Self
    }

    #[inline(never)]
    fn outlined<R>((): (), work: impl FnOnce() -> R) -> R {
        work()
    }

    #[inline(always)]
    fn round_away(self, shift: Self) -> Self {
        if !self.is_finite() || shift == 0.0 || shift.is_nan() {
            self
        } else if shift > 0.0 {
            self.next_up()
        } else {
            self.next_down()
        }
    }
}
