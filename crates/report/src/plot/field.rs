//! The field of a chart between its two axes, with grid, ticks and labels.

use super::axis::{Mapping, Tick};
use super::font;
use super::svg::{At, BELOW, BESIDE, Drawing, LABEL, Paint};
use super::{ChartAxis, Scale};

/// Smallest distance between labels down an axis.
const APART_DOWN: f64 = 36.0;
/// Smallest room of a label along an axis, and smallest distance between labels.
const LEAST_ALONG: f64 = 40.0;
const APART_ALONG: f64 = 14.0;
/// Distance from a label to its axis.
const GAP: f64 = 8.0;
/// The height of an axis' heading.
const HEADING: f64 = LABEL * 1.6;
/// The width of grid lines.
const GRID: f64 = 0.8;
/// The largest share of the width for names.
const LARGEST_PART_FOR_NAMES: f64 = 0.4;

/// The axes of a chart with their positions.
pub(super) struct Field<'c> {
    pub x: Mapping<'c>,
    pub y: Mapping<'c>,
    /// Whether `x` is an axis of names: it then runs down the left, and `y` to the right.
    pub turned: bool,
}

impl Field<'_> {
    /// The position of a point; `None` if an axis cannot show it.
    pub(super) fn at(&self, x: f64, y: f64) -> Option<At> {
        Some(self.oriented(self.x.pixel(x)?, self.y.pixel(y)?))
    }

    /// The same point with another pixel in `y`.
    pub(super) fn with_y(&self, [along, down]: At, y: f64) -> At {
        if self.turned { [y, down] } else { [along, y] }
    }

    /// The pixels of `x` and `y` as a point.
    pub(super) fn oriented(&self, x: f64, y: f64) -> At {
        if self.turned { [y, x] } else { [x, y] }
    }

    /// Draws the field and its axes at the bottom of the drawing, with room above the field and on
    /// its right.
    pub(super) fn draw(&mut self, drawing: &mut Drawing, height: f64, [above, beside]: [f64; 2]) {
        let (width, turned) = (drawing.width, self.turned);
        let [along, down] =
            if turned { [&mut self.y, &mut self.x] } else { [&mut self.x, &mut self.y] };
        if let Some(heading) = heading(down.axis) {
            drawing.words(&heading, LABEL, Paint::MUTED, HEADING);
        }
        let top = drawing.height + above;
        let bottom = top + height;
        let (left, names_above) = mark_down(down, height, width);
        let right = mark_along(along, width - left - beside - GAP).max(beside);
        (along.pixels, down.pixels) = ([left, width - right], [bottom, top]);
        grid(drawing, along, down, turned);
        labels(drawing, along, down, names_above);
        drawing.height = bottom + LABEL + 2.0 * GAP;
        if let Some(heading) = heading(along.axis) {
            let end = [width - right, drawing.height];
            drawing.text(&heading, end, [1.0, BELOW], LABEL, Paint::MUTED);
            drawing.height += HEADING;
        }
    }
}

/// The heading of an axis. Axes of names need none.
fn heading(axis: &ChartAxis) -> Option<String> {
    let has_names = matches!(axis.scale, Scale::Names(_));
    Some(axis.heading()).filter(|heading| !heading.is_empty() && !has_names)
}

/// Marks the axis on the left, and returns the room for its labels, and whether these are names too
/// long for it: then each name is above its row.
fn mark_down(place: &mut Mapping<'_>, height: f64, width: f64) -> (f64, bool) {
    place.pixels = [height, 0.0];
    mark(place, height / APART_DOWN, |_| (LABEL + GAP) / 2.0);
    if widest(place) <= LARGEST_PART_FOR_NAMES * width {
        return (widest(place) + 2.0 * GAP, false);
    }
    for tick in &mut place.ticks {
        tick.label = font::shortened(&tick.label, LABEL, width - 3.0 * GAP);
    }
    (GAP, true)
}

/// Marks the axis at the bottom, and returns how far the last label may extend.
fn mark_along(place: &mut Mapping<'_>, width: f64) -> f64 {
    place.pixels = [0.0, width];
    mark(place, width / LEAST_ALONG, |tick| (font::width(&tick.label, LABEL) + APART_ALONG) / 2.0);
    (widest(place) / 2.0).max(GAP)
}

/// Marks an axis with as many labels as are apart, given half the room of each: logarithmic axes
/// have uneven distances.
fn mark(place: &mut Mapping<'_>, most: f64, half: impl Fn(&Tick) -> f64) {
    for most in (2..=most.max(2.0) as usize).rev() {
        place.mark(most);
        let mut pairs = place.labelled().zip(place.labelled().skip(1));
        let distance = |a: &Tick, b: &Tick| (place.pixel_of(b.at) - place.pixel_of(a.at)).abs();
        if pairs.all(|(a, b)| distance(a, b) >= half(a) + half(b)) {
            break;
        }
    }
}

/// The width of the widest label.
fn widest(place: &Mapping<'_>) -> f64 {
    place.ticks.iter().map(|tick| font::width(&tick.label, LABEL)).fold(0.0, f64::max)
}

/// Grid lines at the ticks, those with labels above others, and the two axes. A row of names needs
/// no line.
fn grid(drawing: &mut Drawing, along: &Mapping<'_>, down: &Mapping<'_>, turned: bool) {
    let ([left, right], [bottom, top]) = (along.pixels, down.pixels);
    for (is_minor, paint) in [(true, Paint::FAINT), (false, Paint::GRID)] {
        let of = |place: &Mapping<'_>| -> Vec<f64> {
            let ticks = place.ticks.iter().filter(|tick| tick.label.is_empty() == is_minor);
            ticks.map(|tick| place.pixel_of(tick.at)).collect()
        };
        of(along).iter().for_each(|x| drawing.line(&[[*x, top], [*x, bottom]], paint, GRID));
        let rows = if turned { Vec::new() } else { of(down) };
        rows.iter().for_each(|y| drawing.line(&[[left, *y], [right, *y]], paint, GRID));
    }
    drawing.line(&[[left, top], [left, bottom], [right, bottom]], Paint::MUTED, 1.0);
}

/// Ticks and labels outside the field.
fn labels(drawing: &mut Drawing, along: &Mapping<'_>, down: &Mapping<'_>, names_above: bool) {
    let (left, bottom) = (along.pixels[0], down.pixels[0]);
    for tick in along.labelled() {
        let x = along.pixel_of(tick.at);
        drawing.line(&[[x, bottom], [x, bottom + GAP / 2.0]], Paint::MUTED, 1.0);
        drawing.text(&tick.label, [x, bottom + GAP], [0.5, BELOW], LABEL, Paint::MUTED);
    }
    for tick in down.labelled() {
        let y = down.pixel_of(tick.at);
        drawing.line(&[[left - GAP / 2.0, y], [left, y]], Paint::MUTED, 1.0);
        let (at, align) = match names_above {
            true => ([left + GAP, y - GAP], [0.0; 2]),
            false => ([left - GAP, y], [1.0, BESIDE]),
        };
        drawing.text(&tick.label, at, align, LABEL, Paint::MUTED);
    }
}
