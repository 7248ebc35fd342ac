//! Decimal numbers in texts.
//!
//! The crate `fast-float2` reads them as the standard library does, to the last bit, without a copy of the
//! word and without knowing where it ends.

/// The number that `text` begins with, and its length, where a blank or the end of the text follows.
#[inline]
pub(super) fn leading<F: fast_float2::FastFloat>(
    text: &[u8],
    is_blank: impl Fn(u8) -> bool,
) -> Option<(F, usize)> {
    let (value, length) = fast_float2::parse_partial(text).ok()?;
    text.get(length).is_none_or(|&byte| is_blank(byte)).then_some((value, length))
}

/// The whole number without a sign that `text` begins with, and its length; `None` where there is
/// none of at most 9 digits.
#[inline]
pub(super) fn leading_whole(text: &[u8]) -> Option<(u32, usize)> {
    let digit = |byte: &u8| Some(byte.wrapping_sub(b'0')).filter(|digit| *digit < 10);
    let (mut number, mut count) = (0_u32, 0);
    while let Some(digit) = text.get(count).and_then(digit) {
        number = number.wrapping_mul(10).wrapping_add(digit.into());
        count += 1;
    }
    // So few digits fit.
    (1..=9).contains(&count).then_some((number, count))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that a number has the bits that the standard library gives it.
    fn check(text: &str) {
        let right: f32 = text.parse().unwrap();
        let (value, length) = leading::<f32>(text.as_bytes(), |_| false).expect(text);
        assert_eq!((value.to_bits(), length), (right.to_bits(), text.len()), "{text}");
    }

    #[test]
    fn numbers_are_read_as_the_standard_library_does() {
        for text in ["0", "-0", "1", "+1.5", "-.5", "2.", "0.1", "123456.789012345", "00.10"] {
            check(text);
        }
        for text in ["1e5", "inf", "-inf", "1234567890123456", "1.5E-3", "infinity", "1e-50"] {
            check(text);
        }
        assert!(leading::<f32>(b"nan", |_| false).unwrap().0.is_nan());
        for text in ["", "-", ".", "+.", "x", "--1", "1x", "1.2.3", "0x1", "1_0", "\u{0661}", "1-"]
        {
            assert!(leading::<f32>(text.as_bytes(), |_| false).is_none(), "{text}");
            assert!(text.parse::<f32>().is_err());
        }
        assert_eq!(leading(b"1.5/2", |byte| byte == b'/'), Some((1.5, 3)));
        assert_eq!(leading_whole(b"12/3"), Some((12, 2)));
        assert_eq!(leading_whole(b"999999999"), Some((999_999_999, 9)));
        assert_eq!((leading_whole(b"1000000000"), leading_whole(b"-1")), (None, None));
    }

    #[test]
    fn every_number_is_rounded_once() {
        let mut state = 1_u64;
        for _ in 0..200_000 {
            state =
                state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
            let bits = state >> 32;
            let value = f32::from_bits(bits as u32);
            let places = (state >> 20) as usize % 12;
            if value.is_finite() {
                check(&format!("{value:.places$}"));
                check(&format!("{value:e}"));
            }
            check(&format!("{}.{:05}", bits % 1000, bits % 100_000));
        }
    }

    /// Half way between two singles, and beside it, where rounding twice would go wrong.
    #[test]
    fn numbers_half_way_are_rounded_once() {
        for text in ["16777217", "16777219", "1.000000059604644775390625", "8388608.5"] {
            check(text);
        }
        for text in ["16777217.0000001", "16777216.9999999", "33554434.0000001"] {
            check(text);
        }
        for k in 0..5000_u64 {
            // A single plus half its last place, with the digits that 15 places hold.
            let middle = (f64::from(1.0 + k as f32 / 8192.0) + HALF_OF_LAST) * 4096.0;
            for text in [format!("{middle:.10}"), format!("{middle:.11}"), format!("{middle:.9}")] {
                check(&text);
            }
        }
    }

    /// Half the last place of a single from 1 to 2.
    const HALF_OF_LAST: f64 = f32::EPSILON as f64 / 2.0;
}
