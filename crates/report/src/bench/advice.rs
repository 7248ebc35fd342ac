//! Problems of a measurement, and their remedies.
//!
//! The kinds of warnings are those of hyperfine (Peter, *hyperfine*, 2018-): runs too short, a slow
//! first run, outliers. Each names the observation and the option that helps.

use super::tracer::{Ratio, TracerBench};
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

/// The warnings about a measurement: about samples that were not finite, the wavefront, the
/// recursive tracer, and their ratio.
pub fn warnings(
    invalid: u64,
    tracers: [Option<&TracerBench>; 2],
    ratio: Option<&Ratio>,
) -> Vec<String> {
    let mut warnings: Vec<Option<String>> = Vec::new();
    if cfg!(debug_assertions) {
        let why = "this is a debug build: build with --release";
        warnings.push(Some(why.to_owned()));
    }
    if invalid > 0 {
        let why = format!("{invalid} samples were not finite: run check on the scene");
        warnings.push(Some(why));
    }
    for (name, tracer) in ["wavefront", "recursive tracer"].into_iter().zip(tracers) {
        let Some(tracer) = tracer else { continue };
        warnings.extend([short(name, tracer), slow_start(name, tracer), wide(name, tracer)]);
    }
    warnings.push(ratio.and_then(few));
    warnings.into_iter().flatten().collect()
}

fn short(name: &str, tracer: &TracerBench) -> Option<String> {
    let median = tracer.seconds.median;
    (median < SHORT).then(|| {
        format!(
            "a run of the {name} takes {:.2} ms, much of it startup: render a larger image with --width and --height",
            median * 1e3
        )
    })
}

fn slow_start(name: &str, tracer: &TracerBench) -> Option<String> {
    let s = &tracer.seconds;
    let first = *s.each.first()?;
    let above = first - s.median;
    (above > SLOW_DEVIATIONS * s.mad && above > SLOW_SHARE * s.median).then(|| {
        format!(
            "the first run of the {name} took {:.2} times the median: \
             warm up for longer with --warmup",
            first / s.median
        )
    })
}

fn wide(name: &str, tracer: &TracerBench) -> Option<String> {
    let spread = tracer.seconds.spread();
    (spread > WIDE).then(|| {
        format!(
            "times of the {name} vary, their quartiles by {:.0} % of the median: close other programs, or run for \
             longer with --min-time",
            100.0 * spread
        )
    })
}

fn few(ratio: &Ratio) -> Option<String> {
    (ratio.pairs < ENOUGH).then(|| {
        let (pairs, percent) = (ratio.pairs, 100.0 * CONFIDENCE);
        let s = if pairs == 1 { "" } else { "s" };
        format!(
            "{pairs} pair{s} of runs cannot give {percent:.0} % confidence: run {ENOUGH} or more with --repeats"
        )
    })
}
