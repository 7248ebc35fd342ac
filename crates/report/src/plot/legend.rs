//! The legend: names of series beside their markers, in as many rows as needed.

use super::drawing::{BESIDE, Drawing, LABEL, Shape, Text};
use super::font;
use super::marker::{marker, stroke};
use super::paint::Paint;

/// The height of a row.
const ROW: f64 = 22.0;
/// Distance from the sample to the name.
const GAP: f64 = 7.0;
/// Distance between entries.
const BETWEEN: f64 = 22.0;
/// The width of a sample with a line, and without.
const WITH_LINE: f64 = 24.0;
const WITHOUT_LINE: f64 = 12.0;
/// Space below the last row.
const BELOW: f64 = 6.0;

/// The sample beside a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sample {
    /// The marker of a series.
    Marker,
    /// Its marker on its line.
    Line,
    /// The colour of a stage of bars.
    Square,
}

/// Draws the names and samples of series or stages, with their indices.
pub(super) fn draw<'a>(
    drawing: &mut Drawing,
    entries: impl Iterator<Item = (usize, &'a str, Sample)>,
) {
    let (mut x, mut y, width) = (0.0, drawing.height + ROW / 2.0, drawing.frame.width);
    let mut entries = entries.peekable();
    if entries.peek().is_none() {
        return;
    }
    for (index, name, sample) in entries {
        let wide = if sample == Sample::Line { WITH_LINE } else { WITHOUT_LINE } + GAP;
        let name = font::shortened(name, LABEL, width - wide);
        let end = x + wide + font::width(&name, LABEL);
        if x > 0.0 && end > width {
            (x, y) = (0.0, y + ROW);
        }
        draw_sample(drawing, [x, x + wide - GAP, y], index, sample);
        drawing.text(Text::new(&name, [x + wide, y], [0.0, BESIDE], LABEL).in_ink());
        x += wide + font::width(&name, LABEL) + BETWEEN;
    }
    drawing.height = y + ROW / 2.0 + BELOW;
}

fn draw_sample(drawing: &mut Drawing, [left, right, y]: [f64; 3], index: usize, sample: Sample) {
    if sample == Sample::Square {
        let (top, bottom) = (y - WITHOUT_LINE / 2.0, y + WITHOUT_LINE / 2.0);
        let points = vec![[left, top], [right, top], [right, bottom], [left, bottom]];
        drawing.shapes.push(Shape::Area { points, paint: Paint::Series(index) });
        return;
    }
    if sample == Sample::Line {
        stroke(drawing, vec![[left, y], [right, y]], index);
    }
    marker(drawing, [(left + right) / 2.0, y], index);
}
