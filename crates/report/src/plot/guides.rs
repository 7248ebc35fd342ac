//! Guide lines, each with its name in the margin.

use super::drawing::{ABOVE, At, BELOW, BESIDE, Drawing, NOTE, Text};
use super::field::{Field, Room};
use super::font;
use super::paint::Paint;
use super::{Chart, Course, Scale};

/// Distance from the end of a line to its name.
const GAP: f64 = 4.0;

/// Smallest distance between names beside the field.
const APART: f64 = 1.2 * NOTE;

/// The width of a line.
const STROKE: f64 = 1.2;

/// The room for the names of a chart's guides: above the field for vertical lines.
pub(super) fn room(chart: &Chart, turned: bool) -> Room {
    let drawn = chart.guides.iter().filter(|guide| can_be_drawn(chart, guide.course));
    let mut room = Room::default();
    for guide in drawn {
        match guide.course {
            Course::AtY(_) if turned => room.above = 1.5 * NOTE,
            _ => room.beside = room.beside.max(font::width(&guide.name, NOTE) + 2.0 * GAP),
        }
    }
    room
}

/// Draws the guide lines with their names, without overlaps between names or with level lines.
pub(super) fn draw(drawing: &mut Drawing, chart: &Chart, field: &Field<'_>) {
    let right = field.sides()[0][1];
    let drawn = chart.guides.iter().filter_map(|g| Some((&g.name, ends(chart, g.course, field)?)));
    let mut drawn: Vec<(&String, [At; 2])> = drawn.collect();
    drawn.sort_by(|(_, a), (_, b)| a[1][1].total_cmp(&b[1][1]));
    let levels: Vec<f64> =
        drawn.iter().filter(|(_, [a, b])| a[1] == b[1]).map(|(_, ends)| ends[0][1]).collect();
    let mut beside = f64::NEG_INFINITY;
    let mut names = Vec::new();
    for (name, ends) in drawn {
        drawing.line(ends.to_vec(), Paint::Guide, STROKE);
        let (mut at, mut align) = place_of_name(ends, right);
        if at[0] > right {
            // From the middle of one name to that of the next.
            align = [0.0, BESIDE];
            at[1] = at[1].max(beside + APART);
            beside = at[1];
        } else if ends[0][0] != ends[1][0] {
            at = off_levels(at, ends, &levels);
        }
        names.push(Text::new(name, at, align, NOTE).with_rim());
    }
    names.into_iter().for_each(|name| drawing.text(name));
}

/// The position of a name, moved up along its line until no level line crosses it.
fn off_levels([mut x, mut y]: At, [from, to]: [At; 2], levels: &[f64]) -> At {
    let slope = (to[0] - from[0]) / (to[1] - from[1]);
    let is_crossed = |y: f64| levels.iter().any(|level| (level - y + NOTE / 2.0).abs() < APART);
    while is_crossed(y) && y - NOTE > from[1].min(to[1]) {
        (x, y) = (x - slope * NOTE, y - NOTE);
    }
    [x, y]
}

/// Whether the axes of a chart can show a guide.
pub(super) fn can_be_drawn(chart: &Chart, course: Course) -> bool {
    match course {
        Course::Power { slope, through: [x, y] } => {
            let is_place = |value: f64| value > 0.0 && value.is_finite();
            let are_log = chart.x.scale == Scale::Log && chart.y.scale == Scale::Log;
            are_log && slope.is_finite() && is_place(x) && is_place(y)
        }
        Course::AtY(value) => value.is_finite(),
    }
}

/// The visible ends of a guide, from left to right or from bottom to top.
fn ends(chart: &Chart, course: Course, field: &Field<'_>) -> Option<[At; 2]> {
    let [[left, right], [bottom, top]] = field.sides();
    match course {
        _ if !can_be_drawn(chart, course) => None,
        Course::Power { slope, through: [x, y] } => {
            let slope = slope * field.y.pixels_in_unit() / field.x.pixels_in_unit();
            clipped(slope, field.at(x, y)?, [left, right], [bottom, top])
        }
        Course::AtY(y) if field.turned => field.y.pixel(y).map(|x| [[x, bottom], [x, top]]),
        Course::AtY(y) => field.y.pixel(y).map(|y| [[left, y], [right, y]]),
    }
}

/// The line with this slope through a point, clipped to the field.
fn clipped(
    slope: f64,
    [x, y]: At,
    [left, right]: [f64; 2],
    [bottom, top]: [f64; 2],
) -> Option<[At; 2]> {
    let height = |at: f64| y + slope * (at - x);
    let (mut from, mut to) = (left, right);
    if slope != 0.0 {
        let crossings = [bottom, top].map(|end| x + (end - y) / slope);
        from = from.max(crossings[0].min(crossings[1]));
        to = to.min(crossings[0].max(crossings[1]));
    }
    let is_seen =
        from < to && (bottom.min(top)..=bottom.max(top)).contains(&height((from + to) / 2.0));
    is_seen.then(|| [[from, height(from)], [to, height(to)]])
}

/// The position of a name beside the last end of its line, for a [`Text`].
fn place_of_name([from, to]: [At; 2], right: f64) -> (At, [f64; 2]) {
    match to[1] - from[1] {
        _ if from[0] == to[0] => ([to[0], to[1].min(from[1]) - GAP], [0.5, ABOVE]),
        _ if to[0] >= right => ([to[0] + GAP, to[1]], [0.0, BESIDE]),
        // On the outer side: points compared with a rising line tend to be below it.
        ..0.0 => ([to[0] - 2.0 * GAP, to[1] + GAP], [1.0, BELOW]),
        _ => ([to[0] + GAP, to[1] - GAP], [0.0, ABOVE]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guides_end_at_the_field() {
        let found = clipped(-0.5, [1.0, 1.0], [0.0, 4.0], [0.0, 2.0]);
        assert_eq!(found, Some([[0.0, 1.5], [3.0, 0.0]]));
        let found = clipped(0.0, [1.0, 1.0], [0.0, 4.0], [0.0, 2.0]);
        assert_eq!(found, Some([[0.0, 1.0], [4.0, 1.0]]));
        assert_eq!(clipped(0.0, [1.0, 3.0], [0.0, 4.0], [0.0, 2.0]), None);
        assert_eq!(clipped(1.0, [9.0, 1.0], [0.0, 4.0], [0.0, 2.0]), None);
    }
}
