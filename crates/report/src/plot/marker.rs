//! The markers and lines of series, in the field and in the legend.

use super::drawing::{At, Drawing, Shape};
use super::paint::{COLOURS, Paint};

/// The radius of a round marker; others have a similar area.
const RADIUS: f64 = 4.5;

/// The width of the outline around markers, in the background colour.
const RIM: f64 = 1.4;

/// The width of a line.
const STROKE: f64 = 2.0;

/// The corners of each marker around its centre, x and y alternating; a disk has none.
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

/// Draws the marker of a series. Its outline separates overlapping markers.
pub(super) fn marker(drawing: &mut Drawing, center: At, index: usize) {
    let (rim, inside) = (Paint::Paper, Paint::Series(index));
    // When colours repeat, the markers are shifted by one.
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

/// Draws the line of a series, dashed if its colour is repeated.
pub(super) fn stroke(drawing: &mut Drawing, points: Vec<At>, index: usize) {
    let (paint, dashed) = (Paint::Series(index), (index / COLOURS) % 2 == 1);
    drawing.shapes.push(Shape::Line { points, paint, width: STROKE, dashed });
}
