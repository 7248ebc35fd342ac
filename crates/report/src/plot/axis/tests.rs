//! Round numbers at the ticks, of which there are a few in order.

use super::*;

fn labels(ticks: &[Tick]) -> String {
    let labels = ticks.iter().filter(|tick| !tick.label.is_empty());
    labels.map(|tick| tick.label.as_str()).collect::<Vec<_>>().join(" ")
}

#[test]
fn linear_axes_have_round_numbers() {
    for (low, high, most, expected) in [
        (0.0, 1.0, 6, "0 0.2 0.4 0.6 0.8 1"),
        (0.0, 10.0, 6, "0 2 4 6 8 10"),
        (-1.0, 1.0, 5, "−1 −0.5 0 0.5 1"),
        (0.97, 1.32, 4, "1 1.1 1.2 1.3"),
        (0.0, 2.5e-6, 3, "0 10⁻⁶ 2×10⁻⁶"),
        (0.0, 60_000.0, 4, "0 20\u{202f}000 40\u{202f}000 60\u{202f}000"),
    ] {
        assert_eq!(labels(&linear(low, high, most)), expected, "{low} {high}");
    }
    assert_eq!(linear(0.0, 1.0, 6)[3].at, 0.6, "not 3 times 0.2 rounded");
}

#[test]
fn logarithmic_axes_have_powers_of_ten() {
    let ticks = logarithmic(0.0, 2.0, 6);
    assert_eq!(labels(&ticks), "1 10 100");
    assert_eq!((ticks.len(), ticks[1].at), (19, libm::log10(2.0)));
    assert_eq!(labels(&logarithmic(-3.2, 1.1, 9)), "0.001 0.01 0.1 1 10");
    assert_eq!(labels(&logarithmic(-4.0, -1.0, 9)), "10⁻⁴ 0.001 0.01 0.1");
    let many = labels(&logarithmic(-300.0, -100.0, 7));
    assert_eq!(many, "10⁻³⁰⁰ 10⁻²⁷¹ 10⁻²⁴² 10⁻²¹³ 10⁻¹⁸⁴ 10⁻¹⁵⁵ 10⁻¹²⁶");
    assert_eq!(labels(&logarithmic(0.1, 0.9, 6)), "2 3 4 5 6 7");
    assert_eq!(labels(&logarithmic(0.1, 1.2, 4)), "2 5 10");
    let narrow = logarithmic(libm::log10(1.02), libm::log10(1.09), 4);
    assert_eq!(labels(&narrow), "1.02 1.04 1.06 1.08");
    assert_eq!(narrow[1].at, libm::log10(1.04));
}

/// Whatever the values: labels lie between the ends, in order, distinct, and at most as many as
/// requested.
#[test]
fn any_range_has_few_marks_in_order() {
    let ends = [-1e306, -3.3e5, -1.0, -1e-7, 0.0, 4.9e-299, 2.2e-9, 0.1, 1.0, 7.7, 1e15, 1e306];
    for (index, &low) in ends.iter().enumerate() {
        for &high in &ends[index..] {
            for scale in [Scale::Linear, Scale::Log] {
                for most in [2, 3, 5, 9] {
                    check(&ChartAxis::new("", "", scale.clone()), low, high, most);
                }
            }
        }
    }
    for close in [1.0 + f64::EPSILON, 1.0001, 1.003, 1.01, 1.02] {
        for size in [1.0, 3.7, 99.9, 1e-5] {
            check(&ChartAxis::new("", "", Scale::Linear), size, size * close, 12);
        }
    }
}

#[track_caller]
fn check(axis: &ChartAxis, low: f64, high: f64, most: usize) {
    let mut place = Mapping::new(axis, [low, high].into_iter());
    place.mark(most);
    let at: Vec<f64> = place.labelled().map(|tick| tick.at).collect();
    let what = format!("{axis:?} {low:e} {high:e} {most}: {}", labels(&place.ticks));
    assert!((2..=most.max(3)).contains(&at.len()), "{what}");
    let ends = place.low - 1e-9..=place.high + 1e-9;
    assert!(at.iter().all(|x| ends.contains(x)), "{what}");
    assert!(at.is_sorted_by(|a, b| a < b), "{what}");
    let mut names: Vec<_> = place.labelled().map(|tick| &tick.label).collect();
    names.dedup();
    assert_eq!(names.len(), at.len(), "{what}");
}
