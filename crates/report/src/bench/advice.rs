//! Problems of a measurement, and their remedies.
//!
//! The kinds of warnings are those of hyperfine (Peter, *hyperfine*, 2018-): runs too short, a slow
//! first run, outliers. Each names the observation and the option that helps.

use super::compare::{BenchComparison, VariantBench};
use crate::measure::{self, busy};
use crate::plot::number::plural;
use crate::summary::{CONFIDENCE, ENOUGH};

/// A run shorter than this in seconds mostly starts threads and allocates buffers.
const SHORT: f64 = 0.005;
/// Quartiles farther apart than this share of the median are far apart.
const WIDE: f64 = 0.1;
/// A first run is slow if it is above the median by more than this many median absolute deviations,
/// ten standard deviations of a normal distribution ...
const SLOW_DEVIATIONS: f64 = 14.826;
/// ... and by more than this share of the median: if all runs are alike, a small difference is not
/// slow.
const SLOW_SHARE: f64 = 0.1;

/// The warnings about a comparison.
pub(super) fn warnings(found: &BenchComparison) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut warn = |is_so: bool, text: String| warnings.extend(is_so.then_some(text));
    warn(cfg!(debug_assertions), "this is a debug build: build with --release".to_owned());
    let invalid = found.counters.invalid;
    warn(invalid > 0, format!("{invalid} samples were not finite: run check on the scene"));
    let most = |value: fn(&VariantBench) -> f64| {
        found.variants.iter().max_by(|a, b| value(a).total_cmp(&value(b)))
    };
    if let Some(v) = most(|v| -v.seconds.median) {
        let (label, median) = (&v.label, v.seconds.median);
        let what = "much of it startup: render a larger image with --width and --height";
        warn(median < SHORT, format!("a run ({label}) takes {:.2} ms, {what}", median * 1e3));
    }
    let first =
        |v: &VariantBench| v.seconds.each.first().map_or(0.0, |first| first / v.seconds.median);
    if let Some(v) = most(first) {
        let above = (first(v) - 1.0) * v.seconds.median;
        let is_slow = above > SLOW_DEVIATIONS * v.seconds.mad && first(v) > 1.0 + SLOW_SHARE;
        let (label, times) = (&v.label, first(v));
        let what = "warm up for longer with --warmup";
        warn(is_slow, format!("the first run ({label}) took {times:.2} times the median: {what}"));
    }
    if let Some(v) = most(|v| v.seconds.spread()) {
        let (label, spread) = (&v.label, 100.0 * v.seconds.spread());
        let what = "close other programs, or run for longer with --min-time";
        let text =
            format!("times ({label}) vary: half of them are within {spread:.0} % of the median");
        warn(v.seconds.spread() > WIDE, format!("{text}: {what}"));
    }
    let rounds = found.rounds.rounds;
    let percent = 100.0 * CONFIDENCE;
    warn(
        (1..ENOUGH).contains(&rounds),
        format!(
            "{} cannot give {percent:.0} % confidence: run {ENOUGH} or more with --repeats",
            plural(rounds, "round")
        ),
    );
    let used = busy([found.rounds]).filter(|_| found.rounds.busy > 0);
    warnings.extend(used.into_iter().chain(waiting(found)).map(|words| words.to_lowercase()));
    warnings
}

/// That threads waited for processors, or for work.
pub(super) fn waiting(found: &BenchComparison) -> Option<String> {
    let share = |v: &VariantBench| Some(v.processors? / v.variant.threads as f64);
    measure::waiting(found.variants.iter().filter_map(share))
}
