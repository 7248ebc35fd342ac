//! Validation: whether intervals contain the truth as often as stated, and whether requested errors
//! are met.

use crate::accuracy::Findings;
use crate::accuracy::findings::SceneFindings;
use crate::accuracy::fit::CONFIDENCE;
use crate::accuracy::setting::{series_of, words_of};
use crate::accuracy::store::SpreadRecord;
use crate::page::{Block, Cell, Section, Table};
use crate::plot::number::figure;
use crate::plot::{Axis, Chart, Course, Guide, Point, Scale, Series};

/// Both charts; `None` if neither was measured.
pub(super) fn section(findings: &Findings) -> Option<Section> {
    let spread: Vec<&SpreadRecord> = findings.scenes.iter().flat_map(|s| &s.spread).collect();
    let mut blocks = Vec::new();
    if !spread.is_empty() {
        blocks.push(Block::Chart(coverage(&spread)));
    }
    if findings.scenes.iter().any(|scene| !scene.calibration.is_empty()) {
        blocks.push(Block::Chart(calibration(findings)));
    }
    (!blocks.is_empty()).then(|| Section::new("Validation", blocks))
}

fn name(record: &SpreadRecord) -> String {
    format!("{}: {}", record.scene, words_of(&series_of(&record.key), record.target))
}

/// The share of the intervals of values that contain the reference.
fn coverage(spread: &[&SpreadRecord]) -> Chart {
    let point = |(row, s): (usize, &&SpreadRecord)| {
        let share = s.covered as f64 / s.intervals.max(1) as f64;
        let label =
            format!("{} of {} intervals", figure(s.covered as f64), figure(s.intervals as f64));
        Point::new(row as f64, share).labelled(label)
    };
    Chart {
        title: "Coverage: intervals that contain the reference".to_owned(),
        x: Axis::new("", "", Scale::Names(spread.iter().map(|s| name(s)).collect())),
        y: Axis::new("share", "", Scale::Linear),
        series: vec![Series::of("", spread.iter().enumerate().map(point).collect())],
        guides: vec![Guide::at("nominal", CONFIDENCE)],
        caption: "For each value of a pixel, some renders give a 95 per cent interval, and other renders the \
                  reference. Values that are the same in all renders are left out. Where only a few of many renders \
                  meet an edge, errors are not normally distributed, and the coverage is not the nominal one."
            .to_owned(),
    }
}

/// Requested errors against actual errors.
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
        title: "Calibration: requested and actual error".to_owned(),
        x: Axis::new("error asked for", "", Scale::Log),
        y: Axis::new("error made", "", Scale::Log),
        series: findings.scenes.iter().map(series).collect(),
        guides: vec![line("equal", [1.0, 1.0])],
        caption: "`--target-error` chooses samples by a short pilot render; the actual error is against the \
                  reference, which the pilot does not use. Points below the line have a smaller error than requested. \
                  `render` repeats an image that is too noisy with more samples; this chart shows the first attempt."
            .to_owned(),
    }
}

/// Bias and variance of samplers, separately.
pub(super) fn spread(scene: &SceneFindings) -> Vec<Block> {
    let row = |s: &SpreadRecord| {
        let share = 100.0 * s.covered as f64 / s.intervals.max(1) as f64;
        vec![
            Cell::text(words_of(&s.key, s.target)),
            Cell::number(s.variance, figure(s.variance)),
            Cell::number(s.bias, figure(s.bias)),
            Cell::number(s.expected, figure(s.expected)),
            Cell::number(share, format!("{share:.1}")),
        ]
    };
    if scene.spread.is_empty() {
        return Vec::new();
    }
    let caption = "Variance of one render, the mean over all pixels; bias, the RMS error of the mean of all renders, \
                   beyond the error that noise explains (next column); and coverage, the share of intervals that \
                   contain the reference";
    let header = "setting|>variance|>bias|>noise|>coverage, %";
    let rows = scene.spread.iter().map(row).collect();
    vec![Block::Table(Table::new(caption, header, rows))]
}
