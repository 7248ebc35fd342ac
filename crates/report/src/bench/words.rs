//! Parts of sentences shared by text and page.

use super::measure::{Difference, Pixel};
use super::report::SceneBench;
use crate::plot::number::figure;

/// The difference of the tracers in words.
pub fn verdict(difference: &Difference) -> String {
    match difference {
        Difference::Pixel { tracer, x, y, expected, found } => format!(
            "THE IMAGES DIFFER: in a {tracer:?} run, first at column {x}, row {y}:\n  {}; \
             the first Wavefront run has\n  {}",
            pixel(found),
            pixel(expected)
        ),
        Difference::Work { tracer, count, expected, found } => format!(
            "THE WORK DIFFERS: a {tracer:?} run counts {found} {count}, the first Wavefront run {expected}; the \
             images are equal"
        ),
    }
}

/// The contents of the scene.
pub(super) fn contents(report: &SceneBench) -> String {
    let kinds = [
        (report.triangles, "triangle"),
        (report.quads, "quad"),
        (report.spheres, "sphere"),
        (report.lights, "light"),
    ];
    let present = kinds.iter().filter(|(count, _)| *count > 0);
    let words: Vec<_> = present.map(|(count, name)| plural(*count, name)).collect();
    if words.is_empty() { "nothing".to_owned() } else { words.join(", ") }
}

/// The time of the scene's preparation.
pub(super) fn prepared(report: &SceneBench) -> String {
    let (time, preset) = (&report.time, report.preset.name());
    format!("loaded in {:.3} s, BVH ({preset}) built in {:.3} s", time.load, time.build)
}

/// The peak memory, if known.
pub(super) fn peak(report: &SceneBench) -> Option<String> {
    let peak = report.memory.peak? as f64 / 1e6;
    Some(format!("{peak:.1} MB, whole process so far"))
}

/// A number of rays, if any.
pub(super) fn average(rays: Option<f64>) -> String {
    rays.map_or_else(|| "-".to_owned(), |rays| format!("{rays:.1}"))
}

fn pixel(pixel: &Pixel) -> String {
    let ([r, g, b], bits) = (pixel.values, pixel.bits.join(" "));
    format!("{r:?} {g:?} {b:?} (bits {bits})")
}

/// A number of rays, with grouped digits.
pub(super) fn count(rays: u64) -> String {
    figure(rays as f64)
}

/// A number of pairs of runs.
pub(super) fn pairs_of_runs(count: usize) -> String {
    format!("{} of runs", plural(count, "pair"))
}

/// A number with a noun.
pub(super) fn plural(count: usize, name: &str) -> String {
    if count == 1 { format!("1 {name}") } else { format!("{} {name}s", figure(count as f64)) }
}
