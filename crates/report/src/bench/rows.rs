//! Measures of both tracers side by side, in text and on a page.

use super::report::SceneBench;
use super::tracer::TracerBench;
use crate::plot::number::time_unit;

/// From rays to millions of rays.
const MILLIONS: f64 = 1e-6;

/// One measure of both tracers.
pub(super) struct Row {
    pub name: String,
    /// For the wavefront and for the recursive tracer.
    pub values: [f64; 2],
    pub unit: &'static str,
}

/// Time, rate, tests, and hardware counters if available.
pub(super) fn rows(
    report: &SceneBench,
    wavefront: &TracerBench,
    recursive: &TracerBench,
) -> Vec<Row> {
    let both = |value: fn(&TracerBench) -> f64| [value(wavefront), value(recursive)];
    let medians = both(|t| t.seconds.median);
    let (scale, second) = time_unit(f64::max(medians[0], medians[1]));
    let mut rows = Vec::new();
    let mut row = |name: &str, values: [f64; 2], scale: f64, unit: &'static str| {
        rows.push(Row { name: name.to_owned(), values: values.map(|v| v * scale), unit });
    };
    row("median", medians, scale, second);
    row("fastest", both(|t| t.seconds.min), scale, second);
    row("first quartile", both(|t| t.seconds.first_quartile), scale, second);
    row("third quartile", both(|t| t.seconds.third_quartile), scale, second);
    row("slowest", both(|t| t.seconds.max), scale, second);
    row("median abs. deviation", both(|t| t.seconds.mad), scale, second);
    row("all rays", both(|t| t.mrays_s), 1.0, "Mrays/s");
    row("primary rays", both(|t| t.rays_s.primary), MILLIONS, "Mrays/s");
    if report.rays.secondary > 0 {
        row("secondary rays", both(|t| t.rays_s.secondary), MILLIONS, "Mrays/s");
    }
    if report.rays.shadow > 0 {
        row("shadow rays", both(|t| t.rays_s.shadow), MILLIONS, "Mrays/s");
    }
    row("nodes per ray", both(|t| t.tests_per_ray.nodes), 1.0, "tests");
    row("primitives per ray", both(|t| t.tests_per_ray.primitives), 1.0, "tests");
    let rays = report.rays.all().max(1) as f64;
    let counted = |tracer: &TracerBench| tracer.hardware.map(|counts| counts.each());
    if let (Some(a), Some(b)) = (counted(wavefront), counted(recursive)) {
        for ((name, a), (_, b)) in a.into_iter().zip(b) {
            if let (Some(a), Some(b)) = (a, b) {
                row(&format!("{name} per ray"), [a as f64, b as f64], 1.0 / rays, "");
            }
        }
    }
    rows
}
