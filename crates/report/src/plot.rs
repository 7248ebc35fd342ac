//! Charts as data, written as SVG, PNG, CSV and JSON.
//!
//! A [`Chart`] shows series over two axes; [`StackedBars`] show where time went. They contain no
//! drawing instructions. Both are laid out as a list of shapes, written as SVG by one writer and as
//! PNG pixels by another, so that both show the same. Text widths come from a
//! built-in font: nothing depends on the system, and the bytes are the same on every machine.
//!
//! Colours are those of Okabe and Ito (*Color Universal Design*, 2008), which people with colour
//! vision deficiencies can distinguish; each series has its own marker as well.
//!
//! The JSON of a chart uses the names of the fields below.

mod bars;
mod chart;
mod drawing;
mod field;
pub(crate) mod figure;
mod font;
mod guides;
pub mod label;
mod legend;
mod marker;
pub mod number;
mod paint;
mod place;
mod raster;
pub(crate) mod svg;
#[cfg(test)]
mod tests;
mod ticks;

use serde::Serialize;

/// Series of points over two axes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Chart {
    /// The title, in a few words.
    pub title: String,
    /// The axis from left to right; an axis of names runs down the left instead, and `y` to the
    /// right.
    pub x: Axis,
    /// The other axis.
    pub y: Axis,
    /// The series, the most important first: it gets the clearest colour.
    pub series: Vec<Series>,
    /// Guide lines.
    pub guides: Vec<Guide>,
    /// How to read it, in a sentence or two; shown beside the drawing, not in it.
    pub caption: String,
}

/// The meaning of a coordinate.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// The quantity, such as "time".
    pub label: String,
    /// The unit, such as "s"; empty for a plain number.
    pub unit: String,
    /// The scale of the values.
    pub scale: Scale,
}

/// The scale of an axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Equal differences have equal distances.
    #[default]
    Linear,
    /// As [`Scale::Linear`], including 0.
    FromZero,
    /// Equal ratios have equal distances. Values of 0 or less are not drawn, and a note gives their
    /// number.
    Log,
    /// Names for the values 0, 1, 2 and so on. Only for `x`.
    Names(Vec<String>),
}

/// A series of points.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// How its points are drawn.
    pub draw: Draw,
    /// The points, in the order in which a line joins them.
    pub points: Vec<Point>,
}

/// How points are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Draw {
    /// Markers, with whiskers for intervals.
    #[default]
    Points,
    /// Markers with whiskers, joined by a line.
    Line,
}

/// One measurement.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Point {
    /// Its `x`; a value that is not finite is `null` in JSON, and not drawn.
    pub x: f64,
    /// Its `y`.
    pub y: f64,
    /// The lower end of the interval in `y`, if any.
    pub low: Option<f64>,
    /// The upper end.
    pub high: Option<f64>,
    /// A description, without the values; may be empty.
    pub label: String,
}

/// A guide line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Guide {
    /// Its label, such as "−1/2".
    pub name: String,
    /// Its course.
    pub course: Course,
}

/// The course of a [`Guide`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Course {
    /// `y` is proportional to `x` to the power of `slope`, through a point. Only for two
    /// logarithmic axes.
    Power {
        /// The exponent: -0.5 for an error that falls with the square root of the samples.
        slope: f64,
        /// A point on it, as `[x, y]`.
        through: [f64; 2],
    },
    /// Constant `y`.
    AtY(f64),
}

/// Time by stage: a bar for each measured item, in segments.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StackedBars {
    /// The title, in a few words.
    pub title: String,
    /// The bars, from top to bottom.
    pub bars: Vec<Bar>,
    /// How to read it; shown beside the drawing, not in it.
    pub caption: String,
}

/// One measured item.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Bar {
    /// Its name.
    pub name: String,
    /// Its segments, from left to right. Stages with the same name have the same colour in all
    /// bars.
    pub segments: Vec<Segment>,
}

/// The time of one stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Segment {
    /// The stage.
    pub stage: String,
    /// Its time in seconds, 0 or more.
    pub seconds: f64,
}

impl Axis {
    /// An axis of this scale.
    pub fn new(label: impl Into<String>, unit: impl Into<String>, scale: Scale) -> Self {
        Self { label: label.into(), unit: unit.into(), scale }
    }

    /// Label and unit, as written at the axis: "time (s)".
    pub fn heading(&self) -> String {
        if self.unit.is_empty() {
            return self.label.clone();
        }
        format!("{} ({})", self.label, self.unit)
    }
}

impl Series {
    /// Points without a line.
    pub fn of(name: &str, points: Vec<Point>) -> Self {
        Self { name: name.to_owned(), draw: Draw::Points, points }
    }
}

impl Guide {
    /// A line at a value of `y`.
    pub fn at(name: &str, y: f64) -> Self {
        Self { name: name.to_owned(), course: Course::AtY(y) }
    }
}

impl Point {
    /// A point without interval or label.
    pub fn new(x: f64, y: f64) -> Self {
        Self { x, y, ..Self::default() }
    }

    /// With an interval in `y`.
    #[must_use]
    pub fn within(self, low: f64, high: f64) -> Self {
        Self { low: Some(low), high: Some(high), ..self }
    }

    /// With a label.
    #[must_use]
    pub fn labelled(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }
}

impl Bar {
    /// The segments to draw: times that are finite and not negative.
    fn drawn(&self) -> impl Iterator<Item = &Segment> {
        self.segments.iter().filter(|s| s.seconds.is_finite() && s.seconds >= 0.0)
    }
}
