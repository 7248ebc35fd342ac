//! Draws a [`Chart`]: title, legend, axes, guides, series.

use super::drawing::{At, Drawing, Frame, Mark, Shape};
use super::field::Field;
use super::legend::{self, Sample};
use super::marker::{marker, stroke};
use super::number::{exact, figure, quantity};
use super::paint::Paint;
use super::{Axis, Chart, Course, Draw, Point, Scale, Series, guides};

/// Distance between rows of names.
const ROW: f64 = 30.0;

/// Half the length of the cap of a whisker, and the width of its lines.
const CAP: f64 = 3.5;
const WHISKER: f64 = 1.4;

/// Draws the chart.
pub(super) fn draw(chart: &Chart, frame: Frame) -> Drawing {
    let mut drawing = Drawing::new(&chart.title, frame);
    legend::draw(&mut drawing, entries(chart));
    let mut field = field(chart);
    let height = match &chart.x.scale {
        Scale::Names(names) => ROW * names.len().max(1) as f64,
        _ if frame.width < 500.0 => 230.0,
        _ => 330.0,
    };
    field.draw(&mut drawing, height, guides::room(chart, field.turned));
    guides::draw(&mut drawing, chart, &field);
    for index in 0..chart.series.len() {
        draw_series(&mut drawing, chart, index, &field);
    }
    drawing
}

/// The series in the legend: those with a name.
fn entries(chart: &Chart) -> impl Iterator<Item = (usize, &str, Sample)> {
    let named = chart.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty());
    named.map(|(index, series)| {
        let sample = match series.draw {
            Draw::Points => Sample::Marker,
            Draw::Line => Sample::Line,
        };
        (index, series.name.as_str(), sample)
    })
}

/// The axes, with room for everything visible.
fn field(chart: &Chart) -> Field<'_> {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let ys = points().flat_map(|point| [Some(point.y), point.low, point.high]).flatten();
    let guides = chart.guides.iter().filter_map(|guide| match guide.course {
        Course::AtY(y) => Some(y),
        Course::Power { .. } => None,
    });
    Field::new(&chart.x, points().map(|point| point.x), &chart.y, ys.chain(guides))
}

fn draw_series(drawing: &mut Drawing, chart: &Chart, index: usize, field: &Field<'_>) {
    let series = &chart.series[index];
    let places: Vec<Option<At>> = series.points.iter().map(|p| field.at(p.x, p.y)).collect();
    for run in runs(&places).filter(|run| series.draw == Draw::Line && run.len() > 1) {
        stroke(drawing, run, index);
    }
    for (point, at) in series.points.iter().zip(&places) {
        let &Some(at) = at else { continue };
        drawing.shapes.push(Shape::Begin(mark(chart, series, point, at)));
        whisker(drawing, point, at, field, index);
        marker(drawing, at, index);
        drawing.shapes.push(Shape::End);
    }
}

/// The runs of points joined by a line: points without a position separate them.
fn runs(places: &[Option<At>]) -> impl Iterator<Item = Vec<At>> {
    places.split(Option::is_none).map(|run| run.iter().flatten().copied().collect())
}

/// A line between the ends of a point's interval, if it has one, with a cap at each.
fn whisker(drawing: &mut Drawing, point: &Point, at: At, field: &Field<'_>, index: usize) {
    if point.low.is_none() && point.high.is_none() {
        return;
    }
    let end = |y: Option<f64>| y.and_then(|y| field.y.pixel_of_end(y));
    let ends = [point.low, point.high].map(|y| end(y).map_or(at, |y| field.with_y(at, y)));
    let [dx, dy] = if field.turned { [0.0, CAP] } else { [CAP, 0.0] };
    let cap = |[x, y]: At| vec![[x - dx, y - dy], [x + dx, y + dy]];
    for points in [ends.to_vec(), cap(ends[0]), cap(ends[1])] {
        drawing.line(points, Paint::Series(index), WHISKER);
    }
}

/// The mark of a point.
fn mark(chart: &Chart, series: &Series, point: &Point, at: At) -> Mark {
    let x = format!("{}: {}", chart.x.label, name_or_value(&chart.x, point.x));
    let mut y = format!("{}: {}", chart.y.label, quantity(point.y, &chart.y.unit));
    match (point.low, point.high) {
        (Some(low), Some(high)) => y += &format!(" ({} to {})", figure(low), figure(high)),
        (Some(low), None) => y += &format!(" (from {})", figure(low)),
        (None, Some(high)) => y += &format!(" (to {})", figure(high)),
        (None, None) => {}
    }
    let names = [series.name.as_str(), point.label.as_str()].into_iter().filter(|n| !n.is_empty());
    let lines: Vec<&str> = names.chain([x.as_str(), y.as_str()]).collect();
    let figures =
        [("x", Some(point.x)), ("y", Some(point.y)), ("low", point.low), ("high", point.high)];
    let known = figures.into_iter().filter_map(|(name, value)| Some((name, exact(value?))));
    Mark { title: lines.join("\n"), figures: known.collect(), near: Some(at) }
}

/// A value of `x` in words.
pub(super) fn name_or_value(axis: &Axis, value: f64) -> String {
    match &axis.scale {
        Scale::Names(names) => names.get(value as usize).cloned().unwrap_or_default(),
        _ => quantity(value, &axis.unit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_where_a_point_has_no_place() {
        let places = [Some([0.0, 0.0]), Some([1.0, 0.0]), None, Some([2.0, 1.0])];
        let found: Vec<_> = runs(&places).collect();
        assert_eq!(found, [vec![[0.0, 0.0], [1.0, 0.0]], vec![[2.0, 1.0]]]);
    }
}
