//! How a series is drawn: its marker and its line, on the field and in the legend.

use super::drawing::{At, Drawing, Shape};
use super::paint::{COLOURS, Paint};

/// The radius of a round marker; others cover about as much.
const RADIUS: f64 = 4.5;

/// The width of a rim of paper around markers.
const RIM: f64 = 1.4;

/// The width of a line.
const STROKE: f64 = 2.0;

/// Corners of each marker about its middle, x and y in turn; a disk has none.
const MARKERS: [&[f64]; COLOURS] = [
    &[],
    &[-4.0, -4.0, 4.0, -4.0, 4.0, 4.0, -4.0, 4.0],
    &[0.0, -5.3, 5.0, 3.5, -5.0, 3.5],
    &[0.0, -5.6, 5.6, 0.0, 0.0, 5.6, -5.6, 0.0],
    &[0.0, 5.3, 5.0, -3.5, -5.0, -3.5],
    &[
        -1.7, -5.2, 1.7, -5.2, 1.7, -1.7, 5.2, -1.7, 5.2, 1.7, 1.7, 1.7, 1.7, 5.2, -1.7, 5.2, -1.7,
        1.7, -5.2, 1.7, -5.2, -1.7, -1.7, -1.7,
    ],
    &[-4.5, -4.5, 4.5, -4.5, -4.5, 4.5, 4.5, 4.5],
];

/// Draws the marker of a series. A rim of paper keeps markers apart that overlap.
pub(super) fn marker(drawing: &mut Drawing, center: At, index: usize) {
    let (rim, inside) = (Paint::Paper, Paint::Series(index));
    // Where the colours begin again, the markers are already one further.
    let corners = MARKERS[(index + index / COLOURS) % COLOURS];
    if corners.is_empty() {
        let disk = |radius, paint| Shape::Disk { center, radius, paint };
        drawing.shapes.extend([disk(RADIUS + RIM / 2.0, rim), disk(RADIUS - RIM / 2.0, inside)]);
        return;
    }
    let corner = |corner: &[f64]| [center[0] + corner[0], center[1] + corner[1]];
    let points: Vec<At> = corners.chunks(2).map(corner).collect();
    drawing.line(points.iter().chain(points.first()).copied().collect(), rim, 2.0 * RIM);
    drawing.shapes.push(Shape::Area { points, paint: inside });
}

/// Draws the line of a series, dashed where its colour is another's too.
pub(super) fn stroke(drawing: &mut Drawing, points: Vec<At>, index: usize) {
    let (paint, dashed) = (Paint::Series(index), (index / COLOURS) % 2 == 1);
    drawing.shapes.push(Shape::Line { points, paint, width: STROKE, dashed });
}
