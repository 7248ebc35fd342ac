//! Ticks of an axis at round numbers.
//!
//! A linear axis has steps of 1, 2 or 5 times a power of ten. A logarithmic axis has the powers of
//! ten, with their multiples as minor ticks, or steps within a decade if it spans fewer than two of
//! them. Positions on a logarithmic axis are exponents of ten, from `libm`: the same on every
//! machine.

use super::number::{minus, power_of_ten, trimmed};

/// A labelled tick.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    /// Its position: a value, or its decimal logarithm on a logarithmic axis.
    pub at: f64,
    /// Its label.
    pub label: String,
}

/// The ticks of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Ticks {
    /// Ticks with labels.
    pub major: Vec<Tick>,
    /// Ticks between them.
    pub minor: Vec<f64>,
}

impl Ticks {
    /// The positions of all major or all minor ticks.
    pub(super) fn positions(&self, major: bool) -> Vec<f64> {
        if major { self.major.iter().map(|tick| tick.at).collect() } else { self.minor.clone() }
    }
}

/// Smallest number of labels: an axis with one number has no scale.
const FEWEST_LABELS: usize = 2;

/// Plain labels have exponents of ten from here ...
const PLAIN_FROM: i32 = -3;
/// ... to here; if a label is outside this range, all are written as powers.
const PLAIN_TO: i32 = 4;

/// At most `most` labels from `low` to `high`, in this order; three if two are impossible.
pub(super) fn linear(low: f64, high: f64, most: usize) -> Ticks {
    let half_span = high / 2.0 - low / 2.0;
    if half_span <= 0.0 || !half_span.is_finite() {
        return Ticks::default();
    }
    let most = most.max(FEWEST_LABELS);
    // From steps that are too small to the first that is not: there are three in a decade.
    let start = libm::floor(libm::log10(half_span / most as f64)) as i32;
    let steps = (start..start + 4).flat_map(|exponent| [1, 2, 5].map(|digit| (digit, exponent)));
    let mut major = Vec::new();
    for (digit, exponent) in steps {
        let ticks = multiples(low, high, digit, exponent);
        if ticks.len() >= FEWEST_LABELS {
            major = ticks;
        }
        if (1..=most).contains(&major.len()) {
            break;
        }
    }
    Ticks { major, minor: Vec::new() }
}

/// The multiples of `digit` times ten to the `exponent` from `low` to `high`.
fn multiples(low: f64, high: f64, digit: i64, exponent: i32) -> Vec<Tick> {
    let step = times_ten_to(digit, exponent);
    let (first, last) = (libm::ceil(low / step), libm::floor(high / step));
    // Numbers so far from 0 that steps between them are rounded away have no ticks.
    let is_exact = step > 0.0 && first.abs() < 1e15 && last.abs() < 1e15;
    if !is_exact || last - first >= 100.0 {
        return Vec::new();
    }
    let multiples = (first as i64..=last as i64).map(|n| n * digit);
    multiples.map(|n| Tick { at: times_ten_to(n, exponent), label: decimal(n, exponent) }).collect()
}

/// `n` times ten to the `exponent`, rounded once: 3 times 0.1 is 0.3.
fn times_ten_to(n: i64, exponent: i32) -> f64 {
    format!("{n}e{exponent}").parse().unwrap_or(0.0)
}

/// `n` times ten to the `exponent` as a label.
fn decimal(n: i64, exponent: i32) -> String {
    if n == 0 {
        return "0".to_owned();
    }
    let digits = n.unsigned_abs().to_string();
    let leading = digits.len() as i32 - 1 + exponent;
    if (PLAIN_FROM - 1..=PLAIN_TO + 1).contains(&leading) {
        let decimals = (-exponent).max(0) as usize;
        return minus(&format!("{:.decimals$}", times_ten_to(n, exponent)));
    }
    let (first, rest) = digits.split_at(1);
    let mantissa = format!("{first}.{rest}");
    let sign = if n < 0 { "−" } else { "" };
    match trimmed(&mantissa) {
        "1" => format!("{sign}{}", power_of_ten(leading)),
        mantissa => format!("{sign}{mantissa}×{}", power_of_ten(leading)),
    }
}

/// At most `most` labels from ten to the `low` to ten to the `high`.
pub(super) fn logarithmic(low: f64, high: f64, most: usize) -> Ticks {
    if !(low < high && (high - low).is_finite()) {
        return Ticks::default();
    }
    let most = most.max(FEWEST_LABELS);
    let (first, last) = (libm::ceil(low) as i32, libm::floor(high) as i32);
    let decades = (last - first + 1).max(0) as usize;
    if decades >= FEWEST_LABELS {
        return powers(low, high, first..=last, decades.div_ceil(most) as i32);
    }
    for digits in [&[1, 2, 3, 4, 5, 6, 7, 8, 9][..], &[1, 2, 5], &[1, 3], &[1, 5]] {
        let major = within_decades(low, high, digits);
        if (FEWEST_LABELS..=most).contains(&major.len()) {
            let minor = within_decades(low, high, &[1, 2, 3, 4, 5, 6, 7, 8, 9]);
            return Ticks { major, minor: minor.into_iter().map(|tick| tick.at).collect() };
        }
    }
    // Too narrow for whole digits: round numbers as on a linear axis.
    let mut ticks = linear(libm::exp10(low), libm::exp10(high), most);
    ticks.major.iter_mut().for_each(|tick| tick.at = libm::log10(tick.at));
    ticks
}

/// Every `step`th power of ten, with minor ticks in between.
fn powers(low: f64, high: f64, range: std::ops::RangeInclusive<i32>, step: i32) -> Ticks {
    let is_plain = PLAIN_FROM <= *range.start() && *range.end() <= PLAIN_TO;
    let name = |k| if is_plain { decimal(1, k) } else { power_of_ten(k) };
    let (major, others): (Vec<i32>, Vec<i32>) = range.partition(|k| k.rem_euclid(step) == 0);
    let between = within_decades(low, high, &[2, 3, 4, 5, 6, 7, 8, 9]).into_iter();
    let minor = match step {
        1 => between.map(|tick| tick.at).collect(),
        _ => others.into_iter().map(f64::from).collect(),
    };
    let tick = |k: i32| Tick { at: f64::from(k), label: name(k) };
    Ticks { major: major.into_iter().map(tick).collect(), minor }
}

/// The multiples of the powers of ten by `digits` from ten to the `low` to ten to the `high`.
fn within_decades(low: f64, high: f64, digits: &[i64]) -> Vec<Tick> {
    let decades = libm::floor(low) as i32..=libm::floor(high) as i32;
    let all = decades.flat_map(|k| {
        digits.iter().map(move |&digit| Tick {
            at: f64::from(k) + libm::log10(digit as f64),
            label: decimal(digit, k),
        })
    });
    all.filter(|tick| (low..=high).contains(&tick.at)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &Ticks) -> String {
        let labels: Vec<_> = ticks.major.iter().map(|tick| tick.label.as_str()).collect();
        labels.join(" ")
    }

    #[test]
    fn linear_axes_have_round_numbers() {
        for (low, high, most, expected) in [
            (0.0, 1.0, 6, "0.0 0.2 0.4 0.6 0.8 1.0"),
            (0.0, 10.0, 6, "0 2 4 6 8 10"),
            (-1.0, 1.0, 5, "−1.0 −0.5 0 0.5 1.0"),
            (0.97, 1.32, 4, "1.0 1.1 1.2 1.3"),
            (0.0, 3e7, 4, "0 10⁷ 2×10⁷ 3×10⁷"),
            (0.0, 2.5e-6, 3, "0 10⁻⁶ 2×10⁻⁶"),
            (0.0, 60_000.0, 4, "0 20000 40000 60000"),
        ] {
            assert_eq!(
                labels(&linear(low, high, most)).replace("0.0 0.2", "0 0.2"),
                expected.replace("0.0 0.2", "0 0.2"),
                "{low} {high}"
            );
        }
        assert_eq!(linear(0.0, 1.0, 6).major[3].at, 0.6, "not 3 times 0.2 rounded");
    }

    #[test]
    fn logarithmic_axes_have_powers_of_ten() {
        let ticks = logarithmic(0.0, 2.0, 6);
        assert_eq!(labels(&ticks), "1 10 100");
        assert_eq!(ticks.minor.len(), 16);
        assert_eq!(ticks.minor[0], libm::log10(2.0));
        assert_eq!(labels(&logarithmic(-3.2, 1.1, 9)), "0.001 0.01 0.1 1 10");
        assert_eq!(labels(&logarithmic(-4.0, -1.0, 9)), "10⁻⁴ 10⁻³ 10⁻² 10⁻¹");
        let many = logarithmic(-300.0, 300.0, 7);
        assert_eq!(labels(&many), "10⁻²⁵⁸ 10⁻¹⁷² 10⁻⁸⁶ 10⁰ 10⁸⁶ 10¹⁷² 10²⁵⁸");
        assert_eq!(labels(&logarithmic(0.1, 0.9, 6)), "2 3 4 5 6 7");
        assert_eq!(labels(&logarithmic(0.1, 1.2, 4)), "2 5 10");
        let narrow = logarithmic(libm::log10(1.02), libm::log10(1.09), 4);
        assert_eq!(labels(&narrow), "1.02 1.04 1.06 1.08");
        assert_eq!(narrow.major[1].at, libm::log10(1.04));
    }

    /// Whatever the ends: marks lie between them, in order, and at most as many as requested.
    #[test]
    fn any_range_has_few_marks_in_order() {
        let ends = [-1e308, -3.3e5, -1.0, -1e-7, 0.0, 4.9e-324, 2.2e-9, 0.1, 1.0, 7.7, 1e15, 1e308];
        for (index, &low) in ends.iter().enumerate() {
            for &high in &ends[index + 1..] {
                for most in [1, 2, 3, 5, 9] {
                    let ticks = linear(low, high, most);
                    check(&ticks, low, high, most.max(3));
                    // From one subnormal number to the next there is no round one.
                    assert!(high < 1e-300 || !ticks.major.is_empty(), "{low:e} {high:e}");
                }
            }
        }
        for (low, high) in [(-323.4, 308.2), (-1.0, 0.0), (0.3, 0.31), (5.0, 5.000_1), (2.9, 7.1)] {
            for most in [1, 2, 4, 8] {
                let ticks = logarithmic(low, high, most);
                check(&ticks, low - 1e-9, high + 1e-9, most.max(2) + 1);
                assert!(!ticks.major.is_empty(), "{low} {high} {most}");
            }
        }
        for nothing in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert_eq!(linear(nothing.0, nothing.1, 5), Ticks::default());
            assert_eq!(logarithmic(nothing.0, nothing.1, 5), Ticks::default());
        }
    }

    #[track_caller]
    fn check(ticks: &Ticks, low: f64, high: f64, most: usize) {
        let at: Vec<_> = ticks.major.iter().map(|tick| tick.at).collect();
        assert!(at.len() <= most, "{low:e} {high:e} {most}: {}", labels(ticks));
        assert!(at.iter().all(|x| (low - 1e-300..=high).contains(x)), "{low:e} {high:e}: {at:?}");
        assert!(at.is_sorted_by(|a, b| a < b), "{low:e} {high:e}: {at:?}");
        let mut names: Vec<_> = ticks.major.iter().map(|tick| &tick.label).collect();
        names.dedup();
        assert_eq!(names.len(), at.len(), "{low:e} {high:e}: {}", labels(ticks));
    }
}
