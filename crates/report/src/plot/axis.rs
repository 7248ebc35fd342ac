//! The axes of a chart, each with its range of values, its pixels, and ticks at round numbers; and the field between them,
//! with grid and labels.
//!
//! A linear axis has steps of 1, 2 or 5 times a power of ten. A logarithmic axis has the powers of
//! ten, with their multiples as minor ticks, or steps within a decade if it spans fewer than two of
//! them. Positions on a logarithmic axis are exponents of ten, from `libm`: the same on every
//! machine.

use super::font;
use super::number::figure;
use super::svg::{At, BELOW, BESIDE, Drawing, LABEL, Paint};
use super::{ChartAxis, Scale};

/// Margin beyond the outermost values, as a share of their span.
const MARGIN: f64 = 0.04;

/// Linear values that span less than this share of their size are shown as if they spanned more:
/// numbers of four digits could not tell closer ticks apart.
const NARROWEST_SPAN: f64 = 0.01;

/// Linear values up to this size are shown as 0: smaller numbers have fewer digits.
const SHOWN_AS_ZERO: f64 = 1e-300;

/// Positions on a logarithmic axis that span less than this are shown within a decade.
const NARROWEST_DECADES: f64 = 0.02;

/// Smallest number of labels: an axis with one number has no scale.
const FEWEST_LABELS: usize = 2;

pub(super) struct Tick {
    /// Its position: a value, or its decimal logarithm on a logarithmic axis.
    pub at: f64,
    /// Its label; empty for a minor tick.
    pub label: String,
}

/// Maps values to positions, and positions to pixels. A position is the value, its decimal
/// logarithm on a logarithmic axis, or the row of its name, counted downward.
pub(super) struct Mapping<'a> {
    pub axis: &'a ChartAxis,
    low: f64,
    high: f64,
    pub ticks: Vec<Tick>,
    /// The pixels of the two ends.
    pub pixels: [f64; 2],
}

impl<'a> Mapping<'a> {
    /// A range for all of `values` that can be shown.
    pub(super) fn new(axis: &'a ChartAxis, values: impl Iterator<Item = f64>) -> Self {
        let scale = &axis.scale;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for position in values.filter_map(|value| position(scale, value)) {
            (low, high) = (low.min(position), high.max(position));
        }
        let (low, high) = match scale {
            Scale::Names(names) => (0.5 - names.len().max(1) as f64, 0.5),
            _ if low > high => (0.0, 1.0),
            Scale::Log => {
                let span = high - low;
                let margin = if span < NARROWEST_DECADES { 0.5 } else { span * MARGIN };
                (low - margin, high + margin)
            }
            Scale::Linear => linear_range(low, high),
        };
        Self { axis, low, high, ticks: Vec::new(), pixels: [0.0; 2] }
    }

    /// The pixel of a value; `None` if the axis cannot show it.
    pub(super) fn pixel(&self, value: f64) -> Option<f64> {
        Some(self.pixel_of(position(&self.axis.scale, value)?))
    }

    /// The pixel of an end of an interval: the end of the axis if it is infinite or cannot be
    /// shown.
    pub(super) fn pixel_of_end(&self, value: f64) -> f64 {
        match value {
            f64::INFINITY => self.pixels[1],
            _ => self.pixel(value).unwrap_or(self.pixels[0]),
        }
    }

    pub(super) fn pixel_of(&self, position: f64) -> f64 {
        // Halved, as the span of the largest numbers would overflow.
        let share = (position / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0);
        let [from, to] = self.pixels;
        from + (to - from) * share
    }

    /// The ticks with labels.
    pub(super) fn labelled(&self) -> impl Iterator<Item = &Tick> {
        self.ticks.iter().filter(|tick| !tick.label.is_empty())
    }

    /// Chooses ticks with at most `most` labels, of at least two; three if two are impossible.
    fn mark(&mut self, most: usize) {
        self.ticks = match &self.axis.scale {
            Scale::Log => logarithmic(self.low, self.high, most),
            Scale::Linear => linear(self.low, self.high, most),
            Scale::Names(names) => {
                let tick =
                    |(n, name): (usize, &String)| Tick { at: -(n as f64), label: name.clone() };
                names.iter().enumerate().map(tick).collect()
            }
        };
    }
}

/// The position of a value on this scale, if any.
fn position(scale: &Scale, value: f64) -> Option<f64> {
    match scale {
        Scale::Log => (value > 0.0 && value.is_finite()).then(|| libm::log10(value)),
        Scale::Linear => value.is_finite().then_some(value),
        Scale::Names(names) => {
            (0..names.len()).contains(&(value as usize)).then_some(-value).filter(|_| value >= 0.0)
        }
    }
}

/// The ends of a linear axis for values from `low` to `high`. Nothing is below values that begin at
/// 0.
fn linear_range(low: f64, high: f64) -> (f64, f64) {
    let (half, size) = (high / 2.0 - low / 2.0, low.abs().max(high.abs()));
    let margin = match half {
        _ if size <= SHOWN_AS_ZERO => 1.0,
        _ if half < NARROWEST_SPAN / 2.0 * size => 0.1 * size,
        half => 2.0 * MARGIN * half,
    };
    let low = if low == 0.0 && high > 0.0 { low } else { low - margin };
    (low.max(-f64::MAX), (high + margin).min(f64::MAX))
}

/// The ticks from `low` to `high`, in this order.
fn linear(low: f64, high: f64, most: usize) -> Vec<Tick> {
    // From steps that are too small to the first that is not: there are three in a decade.
    let start = libm::floor(libm::log10((high / 2.0 - low / 2.0) / most as f64)) as i32;
    let steps = (start..start + 4).flat_map(|exponent| [1, 2, 5].map(|digit| (digit, exponent)));
    let mut ticks = Vec::new();
    for (digit, exponent) in steps {
        let step = times_ten_to(digit, exponent);
        let (first, last) = (libm::ceil(low / step) as i64, libm::floor(high / step) as i64);
        if (last - first) < FEWEST_LABELS as i64 - 1 {
            break;
        }
        let multiples = (first..=last).map(|n| times_ten_to(n * digit, exponent));
        ticks = multiples.map(|at| Tick { at, label: figure(at) }).collect();
        if ticks.len() <= most {
            break;
        }
    }
    ticks
}

/// `n` times ten to the `exponent`, rounded once: 3 times 0.1 is 0.3.
fn times_ten_to(n: i64, exponent: i32) -> f64 {
    format!("{n}e{exponent}").parse().unwrap_or(0.0)
}

/// The ticks from ten to the `low` to ten to the `high`.
fn logarithmic(low: f64, high: f64, most: usize) -> Vec<Tick> {
    const DIGITS: [i64; 9] = [1, 2, 3, 4, 5, 6, 7, 8, 9];
    let first = libm::ceil(low) as i32;
    let decades = (libm::floor(high) as i32 - first + 1).max(0) as usize;
    let step = decades.div_ceil(most).max(1) as i32;
    let digits = if step > 1 { &DIGITS[..1] } else { &DIGITS };
    let choices: &[&[i64]] = match decades {
        ..FEWEST_LABELS => &[&DIGITS, &[1, 2, 5], &[1, 3], &[1, 5]],
        _ => &[&[1]],
    };
    let powers = || libm::floor(low) as i32..=libm::floor(high) as i32;
    for labelled in choices {
        let tick = |k: i32, digit: i64| {
            let is_labelled = labelled.contains(&digit) && (k - first) % step == 0;
            let label = if is_labelled { figure(times_ten_to(digit, k)) } else { String::new() };
            Tick { at: f64::from(k) + libm::log10(digit as f64), label }
        };
        let all = powers().flat_map(|k| digits.iter().map(move |digit| (k, *digit)));
        let all = all.map(|(k, digit)| tick(k, digit));
        let ticks: Vec<Tick> = all.filter(|tick| (low..=high).contains(&tick.at)).collect();
        let labels = ticks.iter().filter(|tick| !tick.label.is_empty()).count();
        if (FEWEST_LABELS..=most).contains(&labels) {
            return ticks;
        }
    }
    // Too narrow for whole digits: round numbers as on a linear axis.
    let mut ticks = linear(libm::exp10(low), libm::exp10(high), most);
    ticks.iter_mut().for_each(|tick| tick.at = libm::log10(tick.at));
    ticks
}

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
            drawing.text(&heading, end, ("end", BELOW), LABEL, Paint::MUTED);
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
    for most in (FEWEST_LABELS..=FEWEST_LABELS.max(most as usize)).rev() {
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
        drawing.text(&tick.label, [x, bottom + GAP], ("middle", BELOW), LABEL, Paint::MUTED);
    }
    for tick in down.labelled() {
        let y = down.pixel_of(tick.at);
        drawing.line(&[[left - GAP / 2.0, y], [left, y]], Paint::MUTED, 1.0);
        let (at, align) = match names_above {
            true => ([left + GAP, y - GAP], ("start", 0.0)),
            false => ([left - GAP, y], ("end", BESIDE)),
        };
        drawing.text(&tick.label, at, align, LABEL, Paint::MUTED);
    }
}

#[cfg(test)]
mod tests;
