//! The page proves itself: do intervals hold the truth as often as they say, and do errors come out as asked for?

use crate::accuracy::Findings;
use crate::accuracy::findings::SceneFindings;
use crate::accuracy::fit::CONFIDENCE;
use crate::accuracy::setting::{Target, series_of};
use crate::accuracy::store::SpreadRecord;
use crate::page::{Block, Cell, Section, Table};
use crate::plot::number::figure;
use crate::plot::{Axis, Chart, Course, Guide, Point, Scale, Series};

/// Both charts; `None` where neither was measured.
pub(super) fn section(findings: &Findings) -> Option<Section> {
    let spread: Vec<&SpreadRecord> = findings.scenes.iter().flat_map(|s| &s.spread).collect();
    let mut blocks = Vec::new();
    if !spread.is_empty() {
        blocks.push(Block::Chart(coverage(&spread)));
    }
    if findings.scenes.iter().any(|scene| !scene.calibration.is_empty()) {
        blocks.push(Block::Chart(calibration(findings)));
    }
    (!blocks.is_empty()).then(|| Section::new("How far to trust it", blocks))
}

fn name(record: &SpreadRecord) -> String {
    let series = series_of(&record.key);
    let whole = if record.target == Target::Pixel { ", whole pixels" } else { "" };
    format!("{}: {series}{whole}", record.scene)
}

/// How many of the intervals of values hold the reference.
fn coverage(spread: &[&SpreadRecord]) -> Chart {
    let point = |(row, s): (usize, &&SpreadRecord)| {
        let share = s.covered as f64 / s.intervals.max(1) as f64;
        let label =
            format!("{} of {} intervals", figure(s.covered as f64), figure(s.intervals as f64));
        Point::new(row as f64, share).labelled(label)
    };
    Chart {
        title: "Intervals that hold the reference".to_owned(),
        x: Axis::new("", "", Scale::Names(spread.iter().map(|s| name(s)).collect())),
        y: Axis::new("share", "", Scale::Linear),
        series: vec![Series::of("", spread.iter().enumerate().map(point).collect())],
        guides: vec![Guide::at("as it should be", CONFIDENCE)],
        caption: "Every value of a picture has an interval, from some renders of its own; the reference is made by \
                  others. Values that are the same in all renders are not counted. Where few renders of many meet an \
                  edge, the interval is not of a normal distribution."
            .to_owned(),
    }
}

/// Errors asked for, and errors made.
fn calibration(findings: &Findings) -> Chart {
    let series = |scene: &SceneFindings| {
        let point = |c: &crate::accuracy::store::CalibrationRecord| {
            Point::new(c.asked, c.made).labelled(format!("{} expected", figure(c.expected)))
        };
        Series::of(&scene.scene.scene, scene.calibration.iter().map(point).collect())
    };
    let line = |name: &str, through| Guide {
        name: name.to_owned(),
        course: Course::Power { slope: 1.0, through },
    };
    Chart {
        title: "Errors asked for, and made".to_owned(),
        x: Axis::new("error asked for", "", Scale::Log),
        y: Axis::new("error made", "", Scale::Log),
        series: findings.scenes.iter().map(series).collect(),
        guides: vec![line("as asked", [1.0, 1.0])],
        caption: "What `--target-error` chooses from its pilot, against the reference, which the pilot does not know. \
                  Below the line is less error than was asked for. A render whose error is found to be too large is \
                  repeated with more samples; here it is not."
            .to_owned(),
    }
}

/// Bias and variance of samplers, apart.
pub(super) fn spread(scene: &SceneFindings) -> Vec<Block> {
    let row = |s: &SpreadRecord| {
        let share = 100.0 * s.covered as f64 / s.intervals.max(1) as f64;
        vec![
            Cell::text(s.key.clone()),
            Cell::number(s.variance, figure(s.variance)),
            Cell::number(s.bias, figure(s.bias)),
            Cell::number(s.expected, figure(s.expected)),
            Cell::number(share, format!("{share:.1}")),
        ]
    };
    if scene.spread.is_empty() {
        return Vec::new();
    }
    let caption = "Variance of a value in one render, a mean over all; the bias, a root mean square of what the mean \
                   of the renders is off by less what chance explains, which is beside it; and how many of a hundred \
                   intervals hold the reference";
    let header = "setting|>variance|>bias|>by chance|>held, %";
    let rows = scene.spread.iter().map(row).collect();
    vec![Block::Table(Table::new(caption, header, rows))]
}
