//! Sines and cosines of any width, for angles up to a turn.
//!
//! The method and the constants are those of FreeBSD's msun (Sun Microsystems, 1993; in single
//! precision by Ian Lance Taylor and Bruce Evans), which many libraries share: the nearest multiple of
//! a quarter turn is taken away in double precision, and what is left goes into two polynomials. The
//! operations are those of `libm::sincosf`, in the same order or with both signs turned, so the results
//! are the same.

use super::real::{Real, Single};

/// The largest numbers that are nearest to 0, 1, 2 and 3 quarter turns.
const LAST: [f32; 4] = [
    f32::from_bits(0x3f49_0fda),
    f32::from_bits(0x4016_cbe3),
    f32::from_bits(0x407b_53d1),
    f32::from_bits(0x40af_eddf),
];

/// sin x = x + x^3 (S0 + S1 x^2 + S2 x^4 + S3 x^6) with an error below 2^-37 for x up to an eighth of
/// a turn; near -1/6, 1/120, -1/5040 and 1/362880.
const SINE: [f64; 4] = [
    f64::from_bits(0xbfc5_5555_54cb_ac77),
    f64::from_bits(0x3f81_1110_896e_fbb2),
    f64::from_bits(0xbf2a_00f9_e2ca_e774),
    f64::from_bits(0x3ec6_cd87_8c3b_46a7),
];

/// cos x = 1 + C0 x^2 + C1 x^4 + C2 x^6 + C3 x^8 with an error below 2^-34; near -1/2, 1/24, -1/720 and
/// 1/40320.
const COSINE: [f64; 4] = [
    f64::from_bits(0xbfdf_ffff_fd0c_5e81),
    f64::from_bits(0x3fa5_5553_e105_3a42),
    f64::from_bits(0xbf56_c087_e80f_1e27),
    f64::from_bits(0x3ef9_9342_e0ee_5069),
];

/// The sine and the cosine of angles in radians from 0 to 9/8 of a turn.
#[inline(always)]
pub fn sin_cos<F: Single>(angle: F) -> (F, F) {
    let (zero, one) = (angle.zero(), angle.same(1.0));
    let [first, second, third, fourth] = LAST;
    let past = |last: f32| angle.gt(angle.same(last));
    // A mask for each: `map` would pass them through memory.
    let (first, second, third, fourth) = (past(first), past(second), past(third), past(fourth));
    let step = |mask: F::Mask| F::select(mask, one, zero);
    let quarters = step(first) + step(second) + step(third) + step(fourth);
    let left = angle.widen() - quarters.widen().times(std::f64::consts::FRAC_PI_2);
    let (sine, cosine) = near_zero::<F>(left);
    let is_odd = (first & !second) | (third & !fourth);
    let (x, y) = (F::select(is_odd, sine, cosine), F::select(is_odd, cosine, sine));
    (F::select(second & !fourth, -y, y), F::select(first & !third, -x, x))
}

/// The sine and the cosine of angles up to an eighth of a turn.
#[inline(always)]
fn near_zero<F: Single>(x: F::Double) -> (F, F) {
    let (z, one) = (x * x, x.same(1.0));
    let w = z * z;
    let [a, b, c, d] = SINE;
    let cube = z * x;
    let sine = (x + cube * (x.same(a) + z.times(b))) + cube * w * (x.same(c) + z.times(d));
    let [a, b, c, d] = COSINE;
    let cosine = ((one + z.times(a)) + w.times(b)) + (w * z) * (x.same(c) + z.times(d));
    (F::narrow(sine), F::narrow(cosine))
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;
    use crate::math::random::{Stream, unit_interval};

    /// Every fraction of a turn that streams give, and as many of those of cells.
    #[test]
    fn the_bits_are_those_of_libm() {
        for word in 0..1 << 24 {
            let turn = unit_interval(word << 8);
            assert_same(TAU * turn);
            let [a, b, ..] = Stream { seed: 1, pixel: word, sample: 0, bounce: 0 }.uniform(0);
            assert_same(TAU * (a * b));
        }
        for last in LAST {
            [last, last.next_up()].into_iter().for_each(assert_same);
        }
    }

    fn assert_same(angle: f32) {
        let bits = |(sine, cosine): (f32, f32)| [sine.to_bits(), cosine.to_bits()];
        assert_eq!(bits(sin_cos(angle)), bits(libm::sincosf(angle)), "{angle}");
    }
}
