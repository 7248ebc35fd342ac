//! A [`Chart`] on a picture: title, legend, axes, guides, series, notes, from back to front.

use plotters::chart::{ChartBuilder, ChartContext, LabelAreaPosition};
use plotters::coord::cartesian::Cartesian2d;
use plotters::style::{Color, TextStyle};

use super::font;
use super::frame::{Frame, LABEL, NOTE, letter, pixels, style};
use super::legend::{Entry, Legend};
use super::marks;
use super::paint::Paint;
use super::picture::{Drawn, Picture, Sheet};
use super::place::Place;
use super::{Axis, Chart, Course, Draw, Scale};

/// What plotters draws series on.
pub(super) type Field<'a, 'c> = ChartContext<'a, Picture, Cartesian2d<Place<'c>, Place<'c>>>;

/// Rows of names are so far apart, in pixels.
const ROW: f64 = 30.0;

/// Marks down an axis are at least so far apart, in pixels.
const APART_DOWN: f64 = 36.0;

/// Labels along an axis are at least so far apart, in pixels.
const APART_ALONG: f64 = 18.0;

/// From a label to its axis, in pixels.
pub(super) const GAP: f64 = 8.0;

/// The height of an axis' heading, in pixels.
pub(super) const HEADING: f64 = LABEL * 1.6;

/// The largest part of the width that names may take.
const MOST_FOR_NAMES: f64 = 0.4;

/// The axes of a chart as they are drawn.
pub(super) struct Axes<'c> {
    /// From left to right.
    pub along: Place<'c>,
    /// From bottom to top, or names downward.
    pub down: Place<'c>,
    /// Whether `x` is the axis of names, down the left.
    pub turned: bool,
}

impl Axes<'_> {
    /// The positions of a point of the chart, along and down; `None` where an axis has no place.
    pub(super) fn place(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        let (along, down) = if self.turned { (y, x) } else { (x, y) };
        Some((self.along.position(along)?, self.down.position(down)?))
    }

    /// The axis of `y`.
    pub(super) fn of_y(&self) -> &Place<'_> {
        if self.turned { &self.along } else { &self.down }
    }

    /// The same point with another position in `y`.
    pub(super) fn with_y(&self, (along, down): (f64, f64), y: f64) -> (f64, f64) {
        if self.turned { (y, down) } else { (along, y) }
    }
}

/// Draws the chart.
pub(super) fn draw(chart: &Chart, frame: Frame) -> Drawn<Picture> {
    let turned = matches!(chart.x.scale, Scale::Names(_));
    let axes = axes(chart, turned);
    let (along, down) = if turned { (&chart.y, &chart.x) } else { (&chart.x, &chart.y) };
    let legend = Legend::new(&entries(chart), frame.width);
    let notes = if frame.whole { frame.notes(&chart.notes()) } else { Vec::new() };
    let field_height = match &chart.x.scale {
        Scale::Names(names) => ROW * names.len().max(1) as f64,
        _ => frame.field_height(),
    };
    let names = marks::GuideNames::of(chart, turned);
    let head = frame.title_height() + legend.height() + heading_height(down) + names.above;
    let foot = LABEL + 2.0 * GAP + heading_height(along) + NOTE * 1.5 * notes.len() as f64;
    let (picture, root) = frame.sheet(head + field_height + foot)?;
    frame.title(&root, &chart.title)?;
    legend.draw(&root, frame.title_height())?;
    let bottom = head + field_height + LABEL + 2.0 * GAP;
    let layout = Layout { head, field_height, foot, bottom, names };
    draw_field(chart, axes, &frame, &root, &layout, [along, down])?;
    frame.write_notes(&root, &notes, bottom + heading_height(along))?;
    Ok(picture.take())
}

/// Heights in pixels.
struct Layout {
    head: f64,
    field_height: f64,
    foot: f64,
    /// Where the heading of the axis along begins.
    bottom: f64,
    /// Room for the names of guides.
    names: marks::GuideNames,
}

fn draw_field(
    chart: &Chart,
    mut axes: Axes<'_>,
    frame: &Frame,
    root: &Sheet,
    layout: &Layout,
    [along, down]: [&Axis; 2],
) -> Drawn {
    let left = mark_down(&mut axes.down, layout.field_height, frame.width);
    let beside = layout.names.beside;
    let right = mark_along(&mut axes.along, frame.width - left - beside - GAP).max(beside);
    if heading_height(down) > 0.0 {
        let top = layout.head - layout.names.above - heading_height(down);
        letter(root, &down.heading(), (0.0, top), &heading())?;
    }
    let start = (frame.width - right - font::width(&along.heading(), LABEL)).max(0.0);
    if heading_height(along) > 0.0 {
        letter(root, &along.heading(), (start, layout.bottom), &heading())?;
    }
    let mut field = ChartBuilder::on(root)
        .margin_top(pixels(layout.head))
        .margin_bottom(pixels(layout.foot - LABEL - 2.0 * GAP))
        .margin_right(pixels(right))
        .set_label_area_size(LabelAreaPosition::Left, pixels(left))
        .set_label_area_size(LabelAreaPosition::Bottom, pixels(LABEL + 2.0 * GAP))
        .build_cartesian_2d(axes.along.clone(), axes.down.clone())?;
    draw_axes(&mut field, axes.turned)?;
    marks::guides(chart, &axes, &field)?;
    chart
        .series
        .iter()
        .enumerate()
        .try_for_each(|(index, series)| marks::series(chart, index, series, &axes, &field))
}

/// How labels and headings of axes are written.
fn heading() -> TextStyle<'static> {
    style(LABEL, Paint::Muted)
}

/// Grid, marks and labels; rows of names have no grid.
pub(super) fn draw_axes(field: &mut Field<'_, '_>, turned: bool) -> Drawn {
    let line = |paint: Paint, width: u32| paint.color().stroke_width(width);
    let mut mesh = field.configure_mesh();
    mesh.bold_line_style(line(Paint::Grid, 8))
        .light_line_style(line(Paint::Faint, 8))
        .axis_style(line(Paint::Muted, 10))
        .set_all_tick_mark_size(pixels(GAP / 2.0))
        .label_style(heading());
    if turned {
        // A row needs no line: its name leads to it.
        mesh.disable_y_mesh();
    }
    mesh.draw()
}

/// The room for an axis' heading. Names speak for themselves.
fn heading_height(axis: &Axis) -> f64 {
    let has_names = matches!(axis.scale, Scale::Names(_));
    if axis.heading().is_empty() || has_names { 0.0 } else { HEADING }
}

/// The axes with room for all that is to be seen.
fn axes(chart: &Chart, turned: bool) -> Axes<'_> {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let line = |of: fn(&Course) -> Option<f64>| {
        chart.guides.iter().filter_map(move |guide| of(&guide.course))
    };
    let at_x = line(|course| if let Course::AtX(x) = course { Some(*x) } else { None });
    let at_y = line(|course| if let Course::AtY(y) = course { Some(*y) } else { None });
    let x = Place::new(&chart.x, points().map(|point| point.x).chain(at_x));
    let ys = points().flat_map(|point| [Some(point.y), point.low, point.high]).flatten();
    let y = Place::new(&chart.y, ys.chain(at_y));
    let (along, down) = if turned { (y, x) } else { (x, y) };
    Axes { along, down, turned }
}

/// Marks the axis on the left, and tells how wide its labels are.
pub(super) fn mark_down(place: &mut Place<'_>, height: f64, width: f64) -> f64 {
    place.mark((height / APART_DOWN) as usize);
    let most = MOST_FOR_NAMES * width;
    place.labels().for_each(|label| *label = font::shortened(label, LABEL, most));
    let widest = place.labels().map(|label| font::width(label, LABEL)).fold(0.0, f64::max);
    widest + 2.0 * GAP
}

/// Marks the axis at the bottom so that labels stay apart, and tells how far the last may stand out.
pub(super) fn mark_along(place: &mut Place<'_>, width: f64) -> f64 {
    let widest =
        |place: &mut Place<'_>| place.labels().map(|l| font::width(l, LABEL)).fold(0.0, f64::max);
    for most in (2..=(width / 40.0) as usize).rev() {
        place.mark(most);
        let room = width / place.labels().count().max(1) as f64;
        if widest(place) + APART_ALONG <= room {
            break;
        }
    }
    (widest(place) / 2.0).max(GAP)
}

/// The series in the legend: those with a name.
fn entries(chart: &Chart) -> Vec<Entry<'_>> {
    let named = chart.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty());
    named
        .map(|(index, series)| Entry {
            name: &series.name,
            index,
            marker: series.draw != Draw::Band,
            line: series.draw != Draw::Points,
            block: false,
        })
        .collect()
}
