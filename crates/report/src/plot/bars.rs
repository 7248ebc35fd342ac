//! Draws [`StackedBars`]: names down the left, bars in segments, their sums at the end.

use super::drawing::{BESIDE, Drawing, Frame, LABEL, Mark, Shape, Text};
use super::field::{Field, Room};
use super::legend::{self, Sample};
use super::number::{exact, figure, seconds, time_unit};
use super::paint::Paint;
use super::{Axis, Bar, Scale, Segment, StackedBars, font};

/// Distance between bars.
const ROW: f64 = 38.0;
/// Half the height of a bar.
const HALF: f64 = 11.0;
/// Width of the gap between segments.
const BETWEEN: f64 = 1.0;
/// Distance from a bar to its sum.
const GAP: f64 = 6.0;

/// Draws the bars.
pub(super) fn draw(bars: &StackedBars, frame: Frame) -> Drawing {
    let mut drawing = Drawing::new(&bars.title, frame);
    let stages = stages(bars);
    let named = stages.iter().enumerate();
    legend::draw(&mut drawing, named.map(|(index, stage)| (index, *stage, Sample::Square)));
    let longest = bars.bars.iter().map(sum).fold(0.0, f64::max);
    let (scale, unit) = time_unit(longest);
    let names = bars.bars.iter().map(|bar| bar.name.clone()).collect();
    let (names, time) =
        (Axis::new("", "", Scale::Names(names)), Axis::new("time", unit, Scale::FromZero));
    let mut field = Field::new(&names, std::iter::empty(), &time, [longest * scale].into_iter());
    let beside = font::width(&format!("  {}", seconds(0.123_45)), LABEL);
    let height = ROW * bars.bars.len().max(1) as f64;
    field.draw(&mut drawing, height, Room { above: 0.0, beside });
    for (row, bar) in bars.bars.iter().enumerate() {
        draw_bar(&mut drawing, bar, &stages, |time| field.at(row as f64, time * scale));
    }
    drawing
}

/// The stages, in the order of their first occurrence.
fn stages(bars: &StackedBars) -> Vec<&str> {
    let mut stages = Vec::new();
    for segment in bars.bars.iter().flat_map(|bar| &bar.segments) {
        if !stages.contains(&segment.stage.as_str()) {
            stages.push(segment.stage.as_str());
        }
    }
    stages
}

/// The sum of the drawn segments, in seconds.
fn sum(bar: &Bar) -> f64 {
    bar.drawn().map(|segment| segment.seconds).sum()
}

/// Draws one bar; `at` converts a time to a position.
fn draw_bar(
    drawing: &mut Drawing,
    bar: &Bar,
    stages: &[&str],
    at: impl Fn(f64) -> Option<[f64; 2]>,
) {
    let mut end = 0.0;
    for segment in bar.drawn() {
        let start = end;
        end += segment.seconds;
        let (Some([from, y]), Some([to, _])) = (at(start), at(end)) else { continue };
        let index = stages.iter().position(|stage| *stage == segment.stage).unwrap_or_default();
        let (top, bottom) = (y - HALF, y + HALF);
        let points = vec![[from, top], [to, top], [to, bottom], [from, bottom]];
        drawing.shapes.push(Shape::Begin(mark(bar, segment)));
        drawing.shapes.push(Shape::Area { points, paint: Paint::Series(index) });
        drawing.line(vec![[to, top], [to, bottom]], Paint::Paper, BETWEEN);
        drawing.shapes.push(Shape::End);
    }
    if let Some([x, y]) = at(end) {
        let sum = Text::new(&seconds(end), [x + GAP, y], [0.0, BESIDE], LABEL);
        drawing.text(sum.in_ink().with_rim());
    }
}

/// The mark of a segment.
fn mark(bar: &Bar, segment: &Segment) -> Mark {
    let share = figure(libm::round(1000.0 * segment.seconds / sum(bar)) / 10.0);
    let time = format!("{}: {}, {share}% of the bar", segment.stage, seconds(segment.seconds));
    let title = if bar.name.is_empty() { time } else { format!("{}\n{time}", bar.name) };
    let figures = vec![("stage", segment.stage.clone()), ("seconds", exact(segment.seconds))];
    Mark { title, figures, near: None }
}
