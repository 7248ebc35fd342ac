//! [`StackedBars`] on a picture: names down the left, bars in segments, their sums at the end.

use std::slice;

use plotters::chart::{ChartBuilder, LabelAreaPosition};
use plotters::element::{Drawable, PointCollection};
use plotters::style::text_anchor::{HPos, VPos};
use plotters_backend::BackendCoord;

use super::chart::{GAP, HEADING, draw_axes, mark_along, mark_down};
use super::frame::{Frame, LABEL, NOTE, letter, pixels, style};
use super::legend::{Entry, Legend};
use super::number::{exact, figure, seconds, time_unit};
use super::paint::Paint;
use super::picture::{Drawn, Ink, Mark, OnBackend, Picture, Shape};
use super::place::Place;
use super::{Axis, Bar, Scale, Segment, StackedBars, font};

/// Bars are so far apart, in pixels.
const ROW: f64 = 38.0;

/// Half the height of a bar, in steps.
const HALF: i32 = 110;

/// The width of the line of paper between segments, in steps.
const BETWEEN: u32 = 10;

/// Draws the bars.
pub(super) fn draw(bars: &StackedBars, frame: Frame) -> Drawn<Picture> {
    let stages = bars.stages();
    let legend = Legend::new(&entries(&stages), frame.width);
    let notes = if frame.whole { frame.notes(&bars.notes()) } else { Vec::new() };
    let field_height = ROW * bars.bars.len().max(1) as f64;
    let head = frame.title_height() + legend.height();
    let foot = LABEL + 2.0 * GAP + HEADING + NOTE * 1.5 * notes.len() as f64;
    let (picture, root) = frame.sheet(head + field_height + foot)?;
    frame.title(&root, &bars.title)?;
    legend.draw(&root, frame.title_height())?;

    let longest = bars.bars.iter().map(Bar::drawn).fold(0.0, f64::max);
    let (scale, unit) = time_unit(longest);
    let time = Axis::new("time", unit, Scale::FromZero);
    let names = Scale::Names(bars.bars.iter().map(|bar| bar.name.clone()).collect());
    let names = Axis::new("", "", names);
    let mut along = Place::new(&time, [longest * scale].into_iter());
    let mut down = Place::new(&names, std::iter::empty());
    let left = mark_down(&mut down, field_height, frame.width);
    let room = font::width(&format!("  {}", seconds(0.123_45)), LABEL);
    mark_along(&mut along, frame.width - left - room);

    let bottom = head + field_height + LABEL + 2.0 * GAP;
    let heading = time.heading();
    let start = frame.width - room - font::width(&heading, LABEL);
    letter(&root, &heading, (start, bottom), &style(LABEL, Paint::Muted))?;
    let mut field = ChartBuilder::on(&root)
        .margin_top(pixels(head))
        .margin_bottom(pixels(foot - LABEL - 2.0 * GAP))
        .margin_right(pixels(room))
        .set_label_area_size(LabelAreaPosition::Left, pixels(left))
        .set_label_area_size(LabelAreaPosition::Bottom, pixels(LABEL + 2.0 * GAP))
        .build_cartesian_2d(along, down)?;
    draw_axes(&mut field, true)?;
    for (row, bar) in bars.bars.iter().enumerate() {
        let mut from = 0.0;
        for segment in bar.segments.iter().filter(|segment| segment.is_drawn()) {
            let to = from + scale * segment.seconds;
            let index = stages.iter().position(|stage| *stage == segment.stage);
            let corners = [(from, -(row as f64)), (to, -(row as f64))];
            let mark = told(bar, segment);
            field.plotting_area().draw(&Block {
                corners,
                index: index.unwrap_or_default(),
                mark,
            })?;
            from = to;
        }
        let ends = [(0.0, -(row as f64)), (from, -(row as f64))];
        field.plotting_area().draw(&Sum { ends, seconds: bar.drawn() })?;
    }
    frame.write_notes(&root, &notes, bottom + HEADING)?;
    Ok(picture.take())
}

fn entries<'a>(stages: &[&'a str]) -> Vec<Entry<'a>> {
    let stages = stages.iter().enumerate();
    stages
        .map(|(index, name)| Entry { name, index, marker: false, line: false, block: true })
        .collect()
}

/// What is told of a segment.
fn told(bar: &Bar, segment: &Segment) -> Mark {
    let share = figure(libm::round(1000.0 * segment.seconds / bar.drawn()) / 10.0);
    let lines = [
        bar.name.clone(),
        format!("{}: {}, {share}% of the bar", segment.stage, seconds(segment.seconds)),
    ];
    Mark {
        told: lines.into_iter().filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n"),
        figures: vec![("stage", segment.stage.clone()), ("seconds", exact(segment.seconds))],
        near: None,
    }
}

/// A segment.
struct Block {
    /// Its two ends.
    corners: [(f64, f64); 2],
    index: usize,
    mark: Mark,
}

impl<'a> PointCollection<'a, (f64, f64)> for &'a Block {
    type Point = &'a (f64, f64);
    type IntoIter = slice::Iter<'a, (f64, f64)>;

    fn point_iter(self) -> Self::IntoIter {
        self.corners.iter()
    }
}

impl Drawable<Picture> for Block {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        corners: I,
        picture: &mut Picture,
        _: (u32, u32),
    ) -> OnBackend {
        let corners: Vec<BackendCoord> = corners.collect();
        let &[(x0, y), (x1, _)] = &corners[..] else { return Ok(()) };
        let points = vec![(x0, y - HALF), (x1, y - HALF), (x1, y + HALF), (x0, y + HALF)];
        let ends = vec![(x1, y - HALF), (x1, y + HALF)];
        let (ink, paper) = (Ink::full(Paint::Series(self.index)), Ink::full(Paint::Paper));
        picture.shapes.extend([
            Shape::Begin(self.mark.clone()),
            Shape::Area { points, ink },
            Shape::Line { points: ends, ink: paper, width: BETWEEN, dashed: false },
            Shape::End,
        ]);
        Ok(())
    }
}

/// The sum of a bar, beside its end.
struct Sum {
    ends: [(f64, f64); 2],
    seconds: f64,
}

impl<'a> PointCollection<'a, (f64, f64)> for &'a Sum {
    type Point = &'a (f64, f64);
    type IntoIter = slice::Iter<'a, (f64, f64)>;

    fn point_iter(self) -> Self::IntoIter {
        self.ends[1..].iter()
    }
}

impl Drawable<Picture> for Sum {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        mut places: I,
        picture: &mut Picture,
        _: (u32, u32),
    ) -> OnBackend {
        let Some((x, y)) = places.next() else { return Ok(()) };
        let (at, sides) = ((x + pixels(6.0), y), (HPos::Left, VPos::Center));
        let (size, ink) = (f64::from(pixels(LABEL)), Ink::full(Paint::Ink));
        picture.letter(&seconds(self.seconds), at, sides, size, ink, true);
        Ok(())
    }
}
