//! The legend, and the markers of series in it and in the field.

use super::font;
use super::svg::{At, BESIDE, Drawing, LABEL, Paint};
use super::{Draw, Series};

/// The radius of a round marker; others have a similar area.
const RADIUS: f64 = 4.5;

/// The width of the outline around markers, in the background colour.
const RIM: f64 = 1.4;

/// The width of a line.
pub(super) const STROKE: f64 = 2.0;

/// The height of a row of the legend.
const ROW: f64 = 22.0;
/// The width of a sample.
const SAMPLE: f64 = 22.0;
/// Distance from the sample to the name.
const GAP: f64 = 7.0;
/// Distance between entries.
const BETWEEN: f64 = 22.0;
/// Space below the last row.
const BELOW: f64 = 6.0;

/// The corners of each marker around its centre; a disk has none. No chart has more series.
const MARKERS: [&[At]; 4] = [
    &[],
    &[[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]],
    &[[0.0, -5.3], [5.0, 3.5], [-5.0, 3.5]],
    &[[0.0, -5.6], [5.6, 0.0], [0.0, 5.6], [-5.6, 0.0]],
];

/// Draws the marker of a series. Its outline separates overlapping markers.
pub(super) fn marker(drawing: &mut Drawing, center: At, index: usize) {
    let (rim, inside) = (Paint::PAPER, Paint::series(index));
    let corners = MARKERS[index % MARKERS.len()];
    if corners.is_empty() {
        drawing.disk(center, RADIUS + RIM / 2.0, rim);
        drawing.disk(center, RADIUS - RIM / 2.0, inside);
        return;
    }
    let corner = |[x, y]: &At| [center[0] + x, center[1] + y];
    let mut points: Vec<At> = corners.iter().map(corner).collect();
    points.extend(points.first().copied());
    drawing.line(&points, rim, 2.0 * RIM);
    drawing.area(&points, inside);
}

/// Draws the names of series beside their samples, in as many rows as needed.
pub(super) fn legend(drawing: &mut Drawing, series: &[Series]) {
    let (mut x, mut y, width) = (0.0, drawing.height + ROW / 2.0, drawing.width);
    for (index, Series { name, draw, .. }) in series.iter().enumerate() {
        if name.is_empty() {
            continue;
        }
        let name = font::shortened(name, LABEL, width - SAMPLE - GAP);
        let wide = SAMPLE + GAP + font::width(&name, LABEL);
        if x > 0.0 && x + wide > width {
            (x, y) = (0.0, y + ROW);
        }
        if *draw == Draw::Line {
            drawing.line(&[[x, y], [x + SAMPLE, y]], Paint::series(index), STROKE);
        }
        marker(drawing, [x + SAMPLE / 2.0, y], index);
        drawing.text(&name, [x + SAMPLE + GAP, y], ("start", BESIDE), LABEL, Paint::INK);
        x += wide + BETWEEN;
    }
    if x > 0.0 {
        drawing.height = y + ROW / 2.0 + BELOW;
    }
}
