//! Parts shared by the page's sections.

use serde_json::{Map, Value};

use crate::bench::report::SceneBench;
use crate::bench::tracer::{Ratio, TracerBench};
use crate::bench::words::pairs_of_runs;
use crate::page::Cell;
use crate::plot::{Axis, Bar, Chart, Guide, Point, Scale, Segment, Series};

/// A scene in which both tracers were timed.
pub(super) struct Both<'a> {
    pub scene: &'a SceneBench,
    pub wavefront: &'a TracerBench,
    pub recursive: &'a TracerBench,
    pub ratio: &'a Ratio,
}

impl<'a> Both<'a> {
    pub(super) fn of(scene: &'a SceneBench) -> Option<Self> {
        let (wavefront, recursive) = (scene.wavefront.as_ref()?, scene.recursive.as_ref()?);
        Some(Self { scene, wavefront, recursive, ratio: scene.ratio.as_ref()? })
    }
}

/// One ratio in a sentence.
pub(super) fn speed(ratio: &Ratio) -> String {
    format!(
        "The wavefront is {:.3} times as fast as the recursive tracer ({}): {}.",
        ratio.interval.median,
        interval(ratio),
        ratio.verdict()
    )
}

/// A median with its interval.
pub(super) fn interval(ratio: &Ratio) -> String {
    let (i, pairs) = (&ratio.interval, pairs_of_runs(ratio.pairs));
    let percent = 100.0 * i.confidence;
    format!("{:.3} to {:.3} with {percent:.1}\u{a0}% confidence, {pairs}", i.low, i.high)
}

/// Ratios of speeds, a row each, and a line at equal speed.
pub(super) fn ratio_chart(title: &str, caption: &str, x: Axis, points: Vec<Point>) -> Chart {
    Chart {
        title: title.to_owned(),
        x,
        y: Axis::new("times as fast", "", Scale::Linear),
        series: vec![Series::of("", points)],
        guides: vec![Guide::at("equally fast", 1.0)],
        caption: caption.to_owned(),
    }
}

pub(super) fn ratio_cell(ratio: &Ratio) -> Cell {
    let i = &ratio.interval;
    Cell::number(i.median, format!("{:.3} ({:.3} to {:.3})", i.median, i.low, i.high))
}

/// The time of each pass.
pub(super) fn bar(name: &str, passes: &Map<String, Value>) -> Bar {
    let segment = |(stage, pass): (&String, &Value)| {
        let seconds = pass["seconds"].as_f64().unwrap_or_default();
        Segment { stage: stage.clone(), seconds }
    };
    Bar { name: name.to_owned(), segments: passes.iter().map(segment).collect() }
}

/// A number of rays, if any.
pub(super) fn average(rays: Option<f64>) -> Cell {
    match rays {
        Some(rays) => Cell::number(rays, format!("{rays:.1}")),
        None => Cell::text("–"),
    }
}
