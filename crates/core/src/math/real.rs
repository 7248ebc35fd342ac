//! Numbers of any width: one value, or a value in each lane of a vector.
//!
//! Kernels are written once over these traits and compiled for single values (`f32`) and for eight
//! lanes. Every width computes the same bits: lanes add, multiply, divide and compare like single
//! values, and no operation is fused.

use bytemuck::Zeroable;
use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Methods that are functions elsewhere.
macro_rules! as_elsewhere {
    ($($name:ident($($other:ident)?) -> $output:ty = $function:expr;)+) => {$(
        #[inline(always)]
        fn $name(self $(, $other: Self)?) -> $output {
            $function(self $(, $other)?)
        }
    )+};
}

// Below the macro, which it uses.
mod lanes;

/// A truth value, or one in each lane.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// The true lanes as bits.
    fn bits(self) -> u32;

    /// Whether any lane is true.
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
    /// The value of a lane.
    type Element: Copy + Debug + Default + PartialEq;

    /// The result of a comparison.
    type Mask: Mask;

    /// The number of lanes.
    const LANES: usize;

    /// `value` in each lane of a number of this type.
    fn same(self, value: Self::Element) -> Self;

    /// As [`Self::same`], of a number that is rounded to this precision.
    fn same_rounded(self, value: f64) -> Self;

    /// The number in lane `i`.
    fn lane(self, i: usize) -> Self::Element;

    /// Replaces the number in lane `i`.
    fn set_lane(&mut self, i: usize, value: Self::Element);

    /// The magnitude.
    fn abs(self) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The largest whole number that is not above.
    fn floor(self) -> Self;

    /// The magnitude of `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;

    /// The smaller of two numbers, neither of them NaN.
    fn min(self, other: Self) -> Self;

    /// The larger of two numbers, neither of them NaN.
    fn max(self, other: Self) -> Self;

    /// The lanes in which `self` is less than `other`.
    fn lt(self, other: Self) -> Self::Mask;

    /// The lanes in which `self` is less than or equal to `other`.
    fn le(self, other: Self) -> Self::Mask;

    /// The lanes in which both are equal.
    fn eq(self, other: Self) -> Self::Mask;

    /// `a` in the lanes of `mask`, `b` in the others.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;

    /// The lanes in which `self` is greater than `other`.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// The lanes in which `self` is greater than or equal to `other`.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }

    /// The lanes in which the two differ or one is a NaN.
    #[inline(always)]
    fn ne(self, other: Self) -> Self::Mask {
        !self.eq(other)
    }

    /// The product with the same number in each lane.
    #[inline(always)]
    fn times(self, factor: Self::Element) -> Self {
        self * self.same(factor)
    }

    /// Zeros.
    #[inline(always)]
    fn zero(self) -> Self {
        self.same(Self::Element::default())
    }
}

/// Single-precision numbers, which can be loaded and widened to double precision.
pub trait Single: Real<Element = f32> {
    /// The same number of lanes in double precision.
    type Double: Real<Element = f64>;

    /// A proof that the processor has the instructions for this type.
    type Token: Copy;

    /// The same number of lanes in memory.
    type Row: Copy + Debug + Default + Zeroable + AsRef<[f32]> + AsMut<[f32]>;

    /// The same number of integers in memory.
    type Integers: Copy + Debug + Default + AsRef<[u32]> + AsMut<[u32]>;

    /// The proof, from an existing number.
    fn token(self) -> Self::Token;

    /// `value` in each lane.
    fn splat(token: Self::Token, value: f32) -> Self;

    /// Loads a row from memory.
    #[inline(always)]
    fn load(token: Self::Token, row: &Self::Row) -> Self {
        Self::from_slice(token, row.as_ref())
    }

    /// Loads the first [`Real::LANES`] of `values`.
    fn from_slice(token: Self::Token, values: &[f32]) -> Self;

    /// The `number` of each lane.
    #[inline(always)]
    fn lanes(token: Self::Token, number: impl Fn(usize) -> f32) -> Self {
        let mut row = Self::Row::default();
        for (lane, value) in row.as_mut().iter_mut().enumerate() {
            *value = number(lane);
        }
        Self::load(token, &row)
    }

    /// Stores to the first of `values`.
    fn store(self, values: &mut [f32]);

    /// Stores the lanes of `mask` contiguously to the start of `values`. The values after them are
    /// unspecified.
    fn pack(self, mask: Self::Mask, values: &mut [f32]);

    /// As [`Self::pack`], for integers: the lanes are the first of `words`.
    fn pack_integers(token: Self::Token, words: &[u32], mask: Self::Mask, values: &mut [u32]);

    /// The mask with the set bits of `bits`.
    fn mask(token: Self::Token, bits: u32) -> Self::Mask;

    /// Converts to double precision, exactly.
    fn widen(self) -> Self::Double;

    /// Rounds to single precision.
    fn narrow(wide: Self::Double) -> Self;

    /// Runs `work` in a separate function with the instructions of the level, so that code with
    /// several callers exists once.
    fn outlined<R>(token: Self::Token, work: impl FnOnce() -> R) -> R;

    /// Whole numbers from 0 to 2^24 as integers.
    fn integers(self) -> Self::Integers;

    /// The byte of each word from this bit on.
    fn byte(token: Self::Token, words: &Self::Integers, bit: u32) -> Self;

    /// For normal numbers m 2^k of at least 1, with m from the root of 1/2 to that of 2: k and m.
    fn parts(self) -> (Self, Self);

    /// The adjacent float of each number in the direction of the shift's sign, or the number itself
    /// if the shift is zero or the number is infinite.
    fn round_away(self, shift: Self) -> Self;
}

/// The bits of the root of 1/2, and those of the mantissa.
const ROOT: u32 = std::f32::consts::FRAC_1_SQRT_2.to_bits();
const MANTISSA: u32 = (1 << 23) - 1;

/// `of` each of two values. Unlike `map`, it is always inlined, and so are closures marked as such: code
/// for lanes has no other way to their instructions.
#[inline(always)]
pub fn both<A, B>([a, b]: [A; 2], of: impl Fn(A) -> B) -> [B; 2] {
    [of(a), of(b)]
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
            fn same_rounded(self, value: f64) -> Self {
                value as Self
            }

            #[inline(always)]
            fn lane(self, _: usize) -> Self {
                self
            }

            #[inline(always)]
            fn set_lane(&mut self, _: usize, value: Self) {
                *self = value;
            }

            as_elsewhere! {
                abs() -> Self = <$float>::abs;
                sqrt() -> Self = <$float>::sqrt;
                floor() -> Self = <$float>::floor;
                copysign(sign) -> Self = <$float>::copysign;
            }

            // One instruction each; the standard library's functions handle NaNs too.
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
        }
    };
}

one!(f32);
one!(f64);

impl Single for f32 {
    type Double = f64;
    type Token = ();
    type Row = [Self; 1];
    type Integers = [u32; 1];

    #[inline(always)]
    fn token(self) {}

    #[inline(always)]
    fn splat((): (), value: f32) -> Self {
        value
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
    fn pack_integers((): (), words: &[u32], _: bool, values: &mut [u32]) {
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
    fn integers(self) -> [u32; 1] {
        [self as u32]
    }

    #[inline(always)]
    fn byte((): (), [word]: &[u32; 1], bit: u32) -> Self {
        (word >> bit & 0xFF) as Self
    }

    #[inline(always)]
    fn parts(self) -> (Self, Self) {
        let above = self.to_bits().wrapping_sub(ROOT);
        ((above >> 23) as Self, Self::from_bits((above & MANTISSA) + ROOT))
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
