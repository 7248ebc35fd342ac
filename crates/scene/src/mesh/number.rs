//! Decimal numbers in texts, parsed quickly and rounded once.
//!
//! Nearly every number of a mesh file has few digits and no exponent. Its digits are then an
//! integer `m` below 2^53, and the number is `m / 10^k` with a `10^k` that double precision can
//! represent: one division rounds it to double (Clinger's fast path). Rounding that to single
//! precision is the same as rounding the number itself, unless the double lies exactly half way
//! between two singles, where the lost digits would have decided. Those, and all other forms, are
//! left to the standard library, so that the value is always the same.
//!
//! The crate `fast-float2` gives the same bits and was measured slower: by 6 % for OBJ, by 12 % for
//! text PLY.

/// Largest number of digits of an integer that is surely below 2^53.
const DIGITS: usize = 15;

/// The powers of ten up to it, which double precision represents exactly.
const POWERS: [f64; DIGITS + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The bits of a double beyond those of a single, and the highest of them: half of a single's last
/// place.
const BEYOND: u64 = (1 << 29) - 1;
const HALF: u64 = 1 << 28;

/// The number at the start of `text`, and its length. `None` if it has no simple form, which does
/// not mean that it is invalid. The caller checks the following bytes.
#[inline]
pub(super) fn leading(text: &[u8]) -> Option<(f32, usize)> {
    let sign = usize::from(matches!(text, [b'-' | b'+', ..]));
    let (whole, before) = digits(&text[sign..], 0);
    let mut end = sign + before;
    let (mut all, mut after) = (whole, 0);
    if text.get(end) == Some(&b'.') {
        (all, after) = digits(&text[end + 1..], whole);
        end += 1 + after;
    }
    if before + after == 0 || before + after > DIGITS {
        return None;
    }
    let size = all as f64 / POWERS[after];
    // The smallest nonzero value is 1e-15, far above where singles get coarse.
    if size.to_bits() & BEYOND == HALF {
        return None;
    }
    let size = size as f32;
    Some((if text[0] == b'-' { -size } else { size }, end))
}

/// Appends the digits at the start of `text` to `number`, with their count. The number wraps around
/// if there are too many.
#[inline]
fn digits(text: &[u8], mut number: u64) -> (u64, usize) {
    let mut count = 0;
    while let Some(digit) = text.get(count).map(|b| b.wrapping_sub(b'0'))
        && digit < 10
    {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit));
        count += 1;
    }
    (number, count)
}

/// The unsigned integer at the start of `text`, and its length; `None` if it does not have 1 to 9
/// digits.
#[inline]
pub(super) fn leading_whole(text: &[u8]) -> Option<(u32, usize)> {
    let (number, count) = digits(text, 0);
    // So few digits fit.
    (1..=9).contains(&count).then_some((number as u32, count))
}

/// The number in a whole `word`, in any form that the standard library accepts.
pub(super) fn parse(word: &[u8]) -> Option<f32> {
    match leading(word) {
        Some((value, length)) if length == word.len() => Some(value),
        _ => std::str::from_utf8(word).ok()?.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::Dice;

    /// Checks that the fast path gives the bits of the standard library, and returns whether it was
    /// taken.
    fn check(text: &str) -> bool {
        let right: f32 = text.parse().unwrap();
        assert_eq!(parse(text.as_bytes()).unwrap().to_bits(), right.to_bits(), "{text}");
        match leading(text.as_bytes()) {
            Some((value, length)) if length == text.len() => {
                assert_eq!(value.to_bits(), right.to_bits(), "{text}");
                true
            }
            _ => false,
        }
    }

    #[test]
    fn simple_numbers_are_read_quickly() {
        for text in ["0", "-0", "1", "+1.5", "-.5", "2.", "0.1", "123456.789012345", "00.10"] {
            assert!(check(text), "{text}");
        }
        for text in ["1e5", "inf", "nan", "-inf", "1234567890123456", "1.5E-3", "infinity"] {
            assert!(!check(text), "{text}");
        }
        for text in ["", "-", ".", "+.", "x", "--1", "1x", "1.2.3", "0x1", "1_0", "\u{0661}", "1-"]
        {
            assert_eq!(parse(text.as_bytes()), text.parse().ok(), "{text}");
            assert!(text.parse::<f32>().is_err());
        }
        assert_eq!(leading(b"1.5/2"), Some((1.5, 3)));
        assert_eq!(leading_whole(b"12/3"), Some((12, 2)));
        assert_eq!(leading_whole(b"999999999"), Some((999_999_999, 9)));
        assert_eq!((leading_whole(b"1000000000"), leading_whole(b"-1")), (None, None));
    }

    #[test]
    fn every_number_is_rounded_once() {
        let (mut dice, mut quick) = (Dice(1), 0);
        for _ in 0..200_000 {
            let state = dice.bits();
            let bits = state >> 32;
            let value = f32::from_bits(bits as u32);
            let places = (state >> 20) as usize % 12;
            if value.is_finite() && value.abs() < 1e6 {
                quick += usize::from(check(&format!("{value:.places$}")));
            }
            quick += usize::from(check(&format!("{}.{:05}", bits % 1000, bits % 100_000)));
        }
        assert!(quick > 200_000, "{quick}");
    }

    /// Half way between two singles, and beside it, where rounding twice would go wrong.
    #[test]
    fn numbers_half_way_are_left_to_the_standard_library() {
        assert!(!check("16777217") && !check("16777219") && !check("1.000000059604644775390625"));
        for text in ["16777217.0000001", "16777216.9999999", "33554434.0000001", "8388608.5"] {
            check(text);
        }
        for k in 0..5000_u64 {
            // A single plus half its last place, with 15 digits.
            let middle = (f64::from(1.0 + k as f32 / 8192.0) + HALF_OF_LAST) * 4096.0;
            for text in [format!("{middle:.10}"), format!("{middle:.11}"), format!("{middle:.9}")] {
                check(&text);
            }
        }
    }

    /// Half the last place of a single from 1 to 2.
    const HALF_OF_LAST: f64 = f32::EPSILON as f64 / 2.0;
}
