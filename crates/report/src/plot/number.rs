//! Numbers for readers: a few digits, powers of ten in superscript; and exact numbers for CSV.

use wavecrest_base::words;

/// The digits of a number.
const DIGITS: usize = 4;

/// Numbers of at least this size are written as a power of ten.
const LARGEST_PLAIN: f64 = 1e6;

/// The smallest exponent of ten that is written without one: 0.001.
const SMALLEST_PLAIN: i32 = -3;

/// A number in four digits, such as "0.0123", "1 234 567" or "6.02×10²³".
///
/// Integers below 10^15 are written in full, as they are counts.
pub fn figure(value: f64) -> String {
    if !value.is_finite() {
        return "not finite".to_owned();
    }
    let rounded = format!("{value:.*e}", DIGITS - 1);
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or_default();
    let is_count = value.fract() == 0.0 && value.abs() < 1e15;
    let text = if is_count {
        grouped(&format!("{value:.0}"))
    } else if value.abs() >= LARGEST_PLAIN || exponent < SMALLEST_PLAIN {
        let power = power_of_ten(exponent);
        match trimmed(mantissa) {
            "1" => power,
            mantissa => format!("{mantissa}×{power}"),
        }
    } else {
        let decimals = (DIGITS as i32 - 1 - exponent).max(0) as usize;
        grouped(trimmed(&format!("{value:.decimals$}")))
    };
    text.replace('-', "−")
}

/// A number with its unit, if any.
pub fn quantity(value: f64, unit: &str) -> String {
    let space = if unit.is_empty() || unit == "%" { "" } else { "\u{202f}" };
    format!("{}{space}{unit}", figure(value))
}

/// A number with a noun.
pub fn plural(count: usize, name: &str) -> String {
    if count == 1 { format!("1 {name}") } else { format!("{} {name}s", figure(count as f64)) }
}

/// A time in a suitable unit, such as "12.3 ms".
pub fn seconds(seconds: f64) -> String {
    let (scale, unit) = time_unit(seconds.abs());
    quantity(seconds * scale, unit)
}

/// The unit for this number of seconds, and its factor.
pub fn time_unit(seconds: f64) -> (f64, &'static str) {
    match seconds {
        0.0 => (1.0, "s"),
        ..1e-3 => (1e6, "µs"),
        ..1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    }
}

/// A number with enough digits to read back to the same bits; empty if it is not finite.
pub fn exact(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    format!("{value:?}").trim_end_matches(".0").to_owned()
}

/// Ten to the power of `exponent`: "10⁻³".
fn power_of_ten(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let superscript = |c: char| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    let digits: String = exponent.to_string().chars().map(superscript).collect();
    format!("10{digits}")
}

/// Without trailing zeros of a fraction.
fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// With a narrow space between groups of three digits, from five digits on.
fn grouped(text: &str) -> String {
    let (whole, fraction) = text.split_at(text.find('.').unwrap_or(text.len()));
    let (sign, digits) = whole.split_at(usize::from(whole.starts_with('-')));
    if digits.len() < 5 {
        return text.to_owned();
    }
    format!("{sign}{}{fraction}", words::grouped(digits, '\u{202f}'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_few_digits() {
        for (value, expected) in [
            (0.0, "0"),
            (1.0, "1"),
            (-2.0, "−2"),
            (0.1 + 0.2, "0.3"),
            (1.23456, "1.235"),
            (999.96, "1000"),
            (0.001, "0.001"),
            (0.000_999_96, "0.001"),
            (0.000_123_4, "1.234×10⁻⁴"),
            (123_456.7, "123\u{202f}457"),
            (1_234_567.0, "1\u{202f}234\u{202f}567"),
            (1_234_567.8, "1.235×10⁶"),
            (1e15, "10¹⁵"),
            (-1e-4, "−1×10⁻⁴"),
            (6.022e23, "6.022×10²³"),
            (-1.5e-300, "−1.5×10⁻³⁰⁰"),
            (f64::MAX, "1.798×10³⁰⁸"),
            (5e-324, "4.941×10⁻³²⁴"),
            (f64::NAN, "not finite"),
            (f64::INFINITY, "not finite"),
        ] {
            assert_eq!(figure(value), expected, "{value:e}");
        }
    }

    #[test]
    fn times_have_units() {
        for (value, expected) in [
            (0.0, "0\u{202f}s"),
            (1.5e-7, "0.15\u{202f}µs"),
            (0.0123, "12.3\u{202f}ms"),
            (61.0, "61\u{202f}s"),
        ] {
            assert_eq!(seconds(value), expected);
        }
        assert_eq!(quantity(12.0, ""), "12");
        assert_eq!(quantity(12.0, "%"), "12%");
    }

    #[test]
    fn nothing_is_lost_in_csv() {
        for value in [0.1, 1.0 / 3.0, 1e300, 5e-324, -0.25, 123_456_789.0, f64::MAX] {
            assert_eq!(exact(value).parse::<f64>().unwrap(), value);
        }
        assert_eq!((exact(2.0), exact(f64::NAN)), ("2".to_owned(), String::new()));
    }
}
