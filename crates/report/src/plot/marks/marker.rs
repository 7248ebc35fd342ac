//! Markers and strokes, of a series and of its sample in the legend.

use std::slice;

use plotters::element::{Drawable, PointCollection};
use plotters::style::Color;
use plotters_backend::{BackendCoord, DrawingBackend};

use super::is_dashed;
use crate::plot::paint::Paint;
use crate::plot::picture::{Ink, OnBackend, Picture, Shape};

/// The radius of a round marker, in steps; others cover about as much.
const RADIUS: i32 = 45;

/// The width of a rim of paper around markers, and of the line of hollow ones, in steps.
const RIM: u32 = 14;

/// The width of a series' line, in steps.
const STROKE: u32 = 20;

/// The line of a series.
pub(in crate::plot) struct Stroke<C> {
    points: Vec<C>,
    index: usize,
}

impl<C> Stroke<C> {
    /// The line of the series of this number.
    pub(in crate::plot) fn of(index: usize, points: Vec<C>) -> Self {
        Self { points, index }
    }
}

impl<'a, C: 'a> PointCollection<'a, C> for &'a Stroke<C> {
    type Point = &'a C;
    type IntoIter = slice::Iter<'a, C>;

    fn point_iter(self) -> Self::IntoIter {
        self.points.iter()
    }
}

impl<C> Drawable<Picture> for Stroke<C> {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        points: I,
        picture: &mut Picture,
        _: (u32, u32),
    ) -> OnBackend {
        picture.dashed = is_dashed(self.index);
        let done =
            picture.draw_path(points, &Paint::Series(self.index).color().stroke_width(STROKE));
        picture.dashed = false;
        done
    }
}

/// The marker of a series.
pub(in crate::plot) struct Marker<C> {
    pub at: C,
    pub index: usize,
    /// Whether only its outline is drawn.
    pub hollow: bool,
}

impl<'a, C: 'a> PointCollection<'a, C> for &'a Marker<C> {
    type Point = &'a C;
    type IntoIter = slice::Iter<'a, C>;

    fn point_iter(self) -> Self::IntoIter {
        slice::from_ref(&self.at).iter()
    }
}

impl<C> Drawable<Picture> for Marker<C> {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        mut places: I,
        picture: &mut Picture,
        _: (u32, u32),
    ) -> OnBackend {
        let Some(center) = places.next() else { return Ok(()) };
        let (color, paper) = (Ink::full(Paint::Series(self.index)), Ink::full(Paint::Paper));
        // A rim of paper keeps markers apart that overlap; a hollow one has its inside of paper.
        let (inside, outline) = if self.hollow { (paper, color) } else { (color, paper) };
        let shapes = match outline_of(self.index) {
            None => {
                let radius = RADIUS as u32;
                let disk = |radius, ink| Shape::Disk { center, radius, ink };
                [disk(radius + RIM / 2, outline), disk(radius - RIM / 2, inside)]
            }
            Some(corners) => {
                let place = |&(x, y): &BackendCoord| (center.0 + x, center.1 + y);
                let points: Vec<BackendCoord> = corners.iter().map(place).collect();
                let closed = points.iter().chain(points.first()).copied().collect();
                let (ink, width) = (outline, 2 * RIM);
                let around = Shape::Line { points: closed, ink, width, dashed: false };
                [around, Shape::Area { points, ink: inside }]
            }
        };
        picture.shapes.extend(shapes);
        Ok(())
    }
}

/// The corners of the marker of a series, about its middle; a disk where there are none.
fn outline_of(index: usize) -> Option<&'static [BackendCoord]> {
    const SQUARE: &[BackendCoord] = &[(-40, -40), (40, -40), (40, 40), (-40, 40)];
    const UPWARD: &[BackendCoord] = &[(0, -53), (50, 35), (-50, 35)];
    const DIAMOND: &[BackendCoord] = &[(0, -56), (56, 0), (0, 56), (-56, 0)];
    const DOWNWARD: &[BackendCoord] = &[(0, 53), (50, -35), (-50, -35)];
    const PLUS: &[BackendCoord] = &[
        (-17, -52),
        (17, -52),
        (17, -17),
        (52, -17),
        (52, 17),
        (17, 17),
        (17, 52),
        (-17, 52),
        (-17, 17),
        (-52, 17),
        (-52, -17),
        (-17, -17),
    ];
    const HOURGLASS: &[BackendCoord] = &[(-45, -45), (45, -45), (-45, 45), (45, 45)];
    const ALL: [Option<&[BackendCoord]>; 7] = [
        None,
        Some(SQUARE),
        Some(UPWARD),
        Some(DIAMOND),
        Some(DOWNWARD),
        Some(PLUS),
        Some(HOURGLASS),
    ];
    // Where the colours begin again, the markers are already one further.
    ALL[(index + index / ALL.len()) % ALL.len()]
}
