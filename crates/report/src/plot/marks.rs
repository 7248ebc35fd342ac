//! Series and guides on the field of a chart.

use std::slice;

use plotters::element::{Drawable, PointCollection, Polygon};
use plotters::style::Color;
use plotters_backend::BackendCoord;

use super::chart::{Axes, Field};
use super::number::{exact, figure, quantity};
use super::paint::{COLOURS, Paint};
use super::picture::{Drawn, Ink, Mark, OnBackend, Picture, Shape};
use super::{Axis, Chart, Draw, Point, Scale, Series};

mod guides;
mod marker;

pub(super) use guides::{GuideNames, can_be_drawn, guides};
pub(super) use marker::{Marker, Stroke};

/// A place on the field: positions along and down.
type At = (f64, f64);

/// How much a band covers.
const BAND: f64 = 0.18;

/// Half the length of the cap of a whisker, in steps.
const CAP: i32 = 35;

/// Draws one series.
pub(super) fn series(
    chart: &Chart,
    index: usize,
    series: &Series,
    axes: &Axes<'_>,
    field: &Field<'_, '_>,
) -> Drawn {
    let places: Vec<Option<At>> = series.points.iter().map(|p| axes.place(p.x, p.y)).collect();
    if series.draw == Draw::Band {
        bands(index, series, axes, &places, field)?;
    }
    let front = if series.draw == Draw::Front { front(&places) } else { Vec::new() };
    match series.draw {
        Draw::Points => {}
        Draw::Line | Draw::Band => runs(&places).try_for_each(|run| line(index, run, field))?,
        Draw::Front => line(index, steps(&front), field)?,
    }
    for (point, place) in series.points.iter().zip(&places) {
        let Some(at) = *place else { continue };
        let hollow = series.draw == Draw::Front && !front.contains(&at);
        let mark = told(chart, series, point);
        let element = Measured {
            places: match series.draw {
                Draw::Band => vec![at],
                _ => [vec![at], whisker(point, at, axes)].concat(),
            },
            marker: Marker { at: (), index, hollow },
            small: series.draw == Draw::Band,
            mark,
        };
        field.plotting_area().draw(&element)?;
    }
    Ok(())
}

/// The runs of points that a line can join: those without a place part them.
fn runs(places: &[Option<At>]) -> impl Iterator<Item = Vec<At>> {
    places.split(Option::is_none).map(|run| run.iter().flatten().copied().collect())
}

fn line(index: usize, points: Vec<At>, field: &Field<'_, '_>) -> Drawn {
    if points.len() < 2 {
        return Ok(());
    }
    field.plotting_area().draw(&Stroke::of(index, points))
}

/// The band of each run of points, where they have intervals.
fn bands(
    index: usize,
    series: &Series,
    axes: &Axes<'_>,
    places: &[Option<At>],
    field: &Field<'_, '_>,
) -> Drawn {
    let both: Vec<_> = series.points.iter().zip(places).collect();
    for run in both.split(|(_, place)| place.is_none()) {
        let ends = |of: fn(&Point) -> Option<f64>| -> Vec<At> {
            let end = |&(point, place): &(&Point, &Option<At>)| {
                let at = (*place)?;
                let y = of(point).and_then(|y| end_of_interval(y, axes));
                Some(y.map_or(at, |y| axes.with_y(at, y)))
            };
            run.iter().filter_map(end).collect()
        };
        let (low, high) = (ends(|point| point.low), ends(|point| point.high));
        let around: Vec<At> = high.into_iter().chain(low.into_iter().rev()).collect();
        if around.len() > 2 {
            let color = Paint::Series(index).color().mix(BAND);
            field.plotting_area().draw(&Polygon::new(around, color))?;
        }
    }
    Ok(())
}

/// The position of an end of an interval in `y`: the lower end of the axis where it has none for it.
fn end_of_interval(y: f64, axes: &Axes<'_>) -> Option<f64> {
    let [low, high] = axes.of_y().ends();
    match y {
        _ if y.is_nan() => None,
        f64::INFINITY => Some(high),
        _ => Some(axes.of_y().position(y).unwrap_or(low)),
    }
}

/// The two ends of a point's whisker, if it has one.
fn whisker(point: &Point, at: At, axes: &Axes<'_>) -> Vec<At> {
    let end = |y: Option<f64>| y.and_then(|y| end_of_interval(y, axes));
    if point.low.is_none() && point.high.is_none() {
        return Vec::new();
    }
    [end(point.low), end(point.high)].map(|y| y.map_or(at, |y| axes.with_y(at, y))).to_vec()
}

/// The points that no other beats in one coordinate without losing in the other, from left to right.
fn front(places: &[Option<At>]) -> Vec<At> {
    let mut sorted: Vec<At> = places.iter().flatten().copied().collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut front: Vec<At> = Vec::new();
    for at in sorted {
        if front.last().is_none_or(|last| at.1 < last.1) {
            front.push(at);
        }
    }
    front
}

/// The staircase through the points of a front: what is beaten lies above it or on it.
fn steps(front: &[At]) -> Vec<At> {
    let corners = front.windows(2).flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
    corners.chain(front.last().copied()).collect()
}

/// What is told of a point.
fn told(chart: &Chart, series: &Series, point: &Point) -> Mark {
    let mut lines: Vec<String> = Vec::new();
    lines.extend((!series.name.is_empty()).then(|| series.name.clone()));
    lines.extend((!point.label.is_empty()).then(|| point.label.clone()));
    lines.push(format!("{}: {}", chart.x.label, name_or_value(&chart.x, point.x)));
    let mut y = format!("{}: {}", chart.y.label, quantity(point.y, &chart.y.unit));
    match (point.low, point.high) {
        (Some(low), Some(high)) => y += &format!(" ({} to {})", figure(low), figure(high)),
        (Some(low), None) => y += &format!(" (from {})", figure(low)),
        (None, Some(high)) => y += &format!(" (to {})", figure(high)),
        (None, None) => {}
    }
    lines.push(y);
    let figures = [Some(point.x), Some(point.y), point.low, point.high];
    let names = ["x", "y", "low", "high"];
    let known = names.into_iter().zip(figures).filter_map(|(n, v)| Some((n, exact(v?))));
    Mark { told: lines.join("\n"), figures: known.collect(), near: None }
}

/// A value of `x` as it is told.
pub(super) fn name_or_value(axis: &Axis, value: f64) -> String {
    match &axis.scale {
        Scale::Names(names) => names.get(value as usize).cloned().unwrap_or_default(),
        _ => quantity(value, &axis.unit),
    }
}

/// A marker with its whisker, and what is told of it. Its places are the point, then the ends of the
/// whisker, if it has one.
struct Measured {
    places: Vec<At>,
    marker: Marker<()>,
    /// Whether a dot will do.
    small: bool,
    mark: Mark,
}

impl<'a> PointCollection<'a, At> for &'a Measured {
    type Point = &'a At;
    type IntoIter = slice::Iter<'a, At>;

    fn point_iter(self) -> Self::IntoIter {
        self.places.iter()
    }
}

impl Drawable<Picture> for Measured {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        places: I,
        picture: &mut Picture,
        size: (u32, u32),
    ) -> OnBackend {
        let places: Vec<BackendCoord> = places.collect();
        let Some(&at) = places.first() else { return Ok(()) };
        picture.shapes.push(Shape::Begin(Mark { near: Some(at), ..self.mark.clone() }));
        if let &[_, low, high] = &places[..] {
            whisker_lines(picture, self.marker.index, low, high);
        }
        let ink = Ink::full(Paint::Series(self.marker.index));
        match self.small {
            true => picture.shapes.push(Shape::Disk { center: at, radius: 18, ink }),
            false => self.marker.draw([at].into_iter(), picture, size)?,
        }
        picture.shapes.push(Shape::End);
        Ok(())
    }
}

/// A line between the ends, with a cap at each.
fn whisker_lines(picture: &mut Picture, index: usize, low: BackendCoord, high: BackendCoord) {
    let ink = Ink::full(Paint::Series(index));
    let cap = if low.0 == high.0 { (CAP, 0) } else { (0, CAP) };
    let across =
        |at: BackendCoord| vec![(at.0 - cap.0, at.1 - cap.1), (at.0 + cap.0, at.1 + cap.1)];
    for points in [vec![low, high], across(low), across(high)] {
        picture.shapes.push(Shape::Line { points, ink, width: 14, dashed: false });
    }
}

/// Whether lines of this series are dashed, as its colour is another's too.
fn is_dashed(index: usize) -> bool {
    (index / COLOURS) % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_front_has_what_nothing_beats() {
        let places = [(1.0, 5.0), (2.0, 6.0), (2.0, 3.0), (3.0, 3.0), (4.0, 1.0)].map(Some);
        assert_eq!(front(&places), [(1.0, 5.0), (2.0, 3.0), (4.0, 1.0)]);
        let expected = [(1.0, 5.0), (2.0, 5.0), (2.0, 3.0), (4.0, 3.0), (4.0, 1.0)];
        assert_eq!(steps(&front(&places)), expected);
        assert!(front(&[None]).is_empty() && steps(&[]).is_empty());
        assert_eq!(steps(&[(1.0, 2.0)]), [(1.0, 2.0)]);
    }

    #[test]
    fn lines_end_where_a_point_has_no_place() {
        let places = [Some((0.0, 0.0)), Some((1.0, 0.0)), None, Some((2.0, 1.0))];
        let found: Vec<_> = runs(&places).collect();
        assert_eq!(found, [vec![(0.0, 0.0), (1.0, 0.0)], vec![(2.0, 1.0)]]);
    }
}
