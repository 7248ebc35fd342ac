//! Lines to compare with, each with its name in the margin.

use std::slice;

use plotters::element::{Drawable, PathElement, PointCollection};
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};
use plotters_backend::BackendCoord;

use super::At;
use crate::plot::chart::{Axes, Field};
use crate::plot::font;
use crate::plot::frame::{NOTE, pixels};
use crate::plot::paint::Paint;
use crate::plot::picture::{Drawn, Ink, OnBackend, Picture};
use crate::plot::{Axis, Chart, Course, Scale};

/// From the end of a line to its name, in pixels.
const GAP: f64 = 4.0;

/// Room that names of guides take in the margins, in pixels.
pub(in crate::plot) struct GuideNames {
    /// On the right of the field, for lines that end there.
    pub beside: f64,
    /// Above the field, for lines that go straight up.
    pub above: f64,
}

impl GuideNames {
    /// The room for the guides of a chart; `turned` as it is.
    pub(in crate::plot) fn of(chart: &Chart, turned: bool) -> Self {
        let drawn = chart.guides.iter().filter(|guide| can_be_drawn(chart, guide.course));
        let (mut beside, mut above) = (0.0_f64, 0.0_f64);
        for guide in drawn {
            let goes_up = match guide.course {
                Course::AtX(_) => !turned,
                Course::AtY(_) => turned,
                Course::Power { .. } => false,
            };
            match goes_up {
                true => above = 1.5 * NOTE,
                false => beside = beside.max(font::width(&guide.name, NOTE) + 2.0 * GAP),
            }
        }
        Self { beside, above }
    }
}

/// Draws the lines to compare with, each with its name.
pub(in crate::plot) fn guides(chart: &Chart, axes: &Axes<'_>, field: &Field<'_, '_>) -> Drawn {
    for guide in &chart.guides {
        if let Some(ends) = course(chart, guide.course, axes) {
            field
                .plotting_area()
                .draw(&PathElement::new(ends.to_vec(), Paint::Guide.color().stroke_width(12)))?;
            let at_right = ends[1].0 >= axes.along.ends()[1];
            field.plotting_area().draw(&GuideName { ends, at_right, name: &guide.name })?;
        }
    }
    Ok(())
}

/// Whether a guide has a place between the axes of a chart.
pub(in crate::plot) fn can_be_drawn(chart: &Chart, course: Course) -> bool {
    match course {
        Course::Power { slope, through: [x, y] } => {
            let is_log = |axis: &Axis| axis.scale == Scale::Log;
            let is_place = |value: f64| value > 0.0 && value.is_finite();
            is_log(&chart.x) && is_log(&chart.y) && slope.is_finite() && is_place(x) && is_place(y)
        }
        Course::AtX(value) | Course::AtY(value) => value.is_finite(),
    }
}

/// The ends of a guide where it is seen, from left to right.
fn course(chart: &Chart, course: Course, axes: &Axes<'_>) -> Option<[At; 2]> {
    let ([left, right], [bottom, top]) = (axes.along.ends(), axes.down.ends());
    let straight = |(along, down): (Option<f64>, Option<f64>)| match (along, down) {
        (Some(along), _) => Some([(along, bottom), (along, top)]),
        (None, Some(down)) => Some([(left, down), (right, down)]),
        (None, None) => None,
    };
    match course {
        _ if !can_be_drawn(chart, course) => None,
        Course::Power { slope, through: [x, y] } => {
            clipped(slope, axes.place(x, y)?, [left, right], [bottom, top])
        }
        Course::AtY(y) if axes.turned => straight((axes.along.position(y), None)),
        Course::AtY(y) => straight((None, axes.down.position(y))),
        Course::AtX(x) if axes.turned => straight((None, axes.down.position(x))),
        Course::AtX(x) => straight((axes.along.position(x), None)),
    }
}

/// The part within the field of a line of this slope through a point.
fn clipped(
    slope: f64,
    (x, y): At,
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
    let is_seen = from < to && (bottom..=top).contains(&height((from + to) / 2.0));
    is_seen.then(|| [(from, height(from)), (to, height(to))])
}

/// The name of a guide, beside its last end.
struct GuideName<'a> {
    ends: [At; 2],
    /// Whether it ends at the right of the field.
    at_right: bool,
    name: &'a str,
}

impl<'a> PointCollection<'a, At> for &'a GuideName<'_> {
    type Point = &'a At;
    type IntoIter = slice::Iter<'a, At>;

    fn point_iter(self) -> Self::IntoIter {
        self.ends.iter()
    }
}

impl Drawable<Picture> for GuideName<'_> {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        places: I,
        picture: &mut Picture,
        _: (u32, u32),
    ) -> OnBackend {
        let places: Vec<BackendCoord> = places.collect();
        let &[from, to] = &places[..] else { return Ok(()) };
        let gap = pixels(GAP);
        let (at, sides) = match to.1 - from.1 {
            _ if from.0 == to.0 => ((to.0, to.1.min(from.1) - gap), (HPos::Center, VPos::Bottom)),
            _ if self.at_right => ((to.0 + gap, to.1), (HPos::Left, VPos::Center)),
            // On a screen, rows count downward.
            ..0 => ((to.0 + gap, to.1 + gap), (HPos::Left, VPos::Top)),
            _ => ((to.0 + gap, to.1 - gap), (HPos::Left, VPos::Bottom)),
        };
        let ink = Ink::full(Paint::Muted);
        picture.letter(self.name, at, sides, f64::from(pixels(NOTE)), ink, true);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guides_end_at_the_field() {
        let found = clipped(-0.5, (1.0, 1.0), [0.0, 4.0], [0.0, 2.0]).unwrap();
        assert_eq!(found, [(0.0, 1.5), (3.0, 0.0)]);
        assert_eq!(
            clipped(0.0, (1.0, 1.0), [0.0, 4.0], [0.0, 2.0]),
            Some([(0.0, 1.0), (4.0, 1.0)])
        );
        assert_eq!(clipped(0.0, (1.0, 3.0), [0.0, 4.0], [0.0, 2.0]), None);
        assert_eq!(clipped(1.0, (9.0, 1.0), [0.0, 4.0], [0.0, 2.0]), None);
    }
}
