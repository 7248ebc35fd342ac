//! Charts as data, and what is made of them: SVG, PNG, CSV and JSON of the same figures.
//!
//! A [`Chart`] says what was measured and how it is to be read; [`StackedBars`] and an [`Icicle`] say
//! where time went. None knows how it is drawn. All are laid out as a list of shapes; one writer makes
//! SVG of that list and another the pixels of a PNG, so that both show the same. Widths of text are
//! those of a font that is part of the program: nothing comes from the system, and the bytes are the
//! same on every machine.
//!
//! Colours are those of Okabe and Ito (*Color Universal Design*, 2008), which people see apart
//! whatever their eyes; each series has a marker of its own as well.
//!
//! The JSON of a chart has the names of the fields below.

mod bars;
mod chart;
mod drawing;
mod field;
pub(crate) mod figure;
mod font;
mod guides;
mod icicle;
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
    /// What is shown, in a few words.
    pub title: String,
    /// The axis from left to right; one of names runs down the left instead, and `y` to the right.
    pub x: Axis,
    /// The other axis.
    pub y: Axis,
    /// What is drawn, the most important first: it gets the clearest colour.
    pub series: Vec<Series>,
    /// Lines to compare with.
    pub guides: Vec<Guide>,
    /// How to read it, in a sentence or two; shown beside the drawing, not in it.
    pub caption: String,
}

/// What a coordinate means.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// What it is, such as "time".
    pub label: String,
    /// In what it is measured, such as "s"; empty for a plain number.
    pub unit: String,
    /// How values take their places.
    pub scale: Scale,
}

/// How the values of an axis take their places.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Equal differences at equal distances.
    #[default]
    Linear,
    /// As [`Scale::Linear`], and 0 is in sight.
    FromZero,
    /// Equal ratios at equal distances. There is no place for 0 or less: such points are not drawn, and
    /// a note says how many.
    Log,
    /// Names for the values 0, 1, 2 and so on. For `x` alone.
    Names(Vec<String>),
}

/// Points that belong together.
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
    /// Stairs below all else: a Pareto front from left to right, where less is better on either axis, of points
    /// that other series mark.
    Front,
}

/// One measurement.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Point {
    /// Where it is along `x`; a value that is not finite is `null` in JSON, and not drawn.
    pub x: f64,
    /// Where it is along `y`.
    pub y: f64,
    /// The lower end of the interval in `y`, if there is one.
    pub low: Option<f64>,
    /// The upper end.
    pub high: Option<f64>,
    /// What it is, besides its values; may be empty.
    pub label: String,
}

/// A line to compare with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Guide {
    /// What is written at it, such as "−1/2".
    pub name: String,
    /// Where it runs.
    pub course: Course,
}

/// Where a [`Guide`] runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Course {
    /// `y` is in proportion to `x` to the power of `slope`, and the line goes through a point. For
    /// two logarithmic axes alone.
    Power {
        /// The power: -0.5 for an error that falls with the root of the samples.
        slope: f64,
        /// A point on it, as `[x, y]`.
        through: [f64; 2],
    },
    /// `y` has this value.
    AtY(f64),
}

/// Where time went: a bar for each thing measured, in segments by stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StackedBars {
    /// What is shown, in a few words.
    pub title: String,
    /// The bars, from top to bottom.
    pub bars: Vec<Bar>,
    /// How to read it; shown beside the drawing, not in it.
    pub caption: String,
}

/// What was measured of one thing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Bar {
    /// Its name.
    pub name: String,
    /// Its parts, from left to right. Stages of one name have one colour in all bars.
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

/// Where time went, level by level: below each part stand those that it is divided into, as wide as they took long.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Icicle {
    /// What is shown, in a few words.
    pub title: String,
    /// What the parts of each level are, from the top down, such as "pass".
    pub levels: Vec<String>,
    /// The parts of the first level, from left to right.
    pub parts: Vec<Part>,
    /// How to read it; shown beside the drawing, not in it.
    pub caption: String,
}

/// A part of the time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Part {
    /// Its name. Parts of one name that are not divided have one colour.
    pub name: String,
    /// Its time in seconds, 0 or more: the sum of its parts, if it is divided.
    pub seconds: f64,
    /// What it is divided into, from left to right.
    pub parts: Vec<Part>,
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
    /// Points that no line joins.
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
    /// What is drawn of it: times that are finite and not negative.
    fn drawn(&self) -> impl Iterator<Item = &Segment> {
        self.segments.iter().filter(|s| s.seconds.is_finite() && s.seconds >= 0.0)
    }
}

impl Part {
    /// A part that is not divided.
    pub fn new(name: impl Into<String>, seconds: f64) -> Self {
        Self { name: name.into(), seconds, parts: Vec::new() }
    }

    /// A part that is divided into `parts`.
    pub fn of(name: impl Into<String>, parts: Vec<Self>) -> Self {
        Self { name: name.into(), seconds: parts.iter().map(Self::time).sum(), parts }
    }

    /// What is drawn of it: a time that is finite and not negative, or 0.
    fn time(&self) -> f64 {
        if self.seconds.is_finite() { self.seconds.max(0.0) } else { 0.0 }
    }

    /// The parts that are not divided, from left to right.
    fn leaves(&self) -> Vec<&Self> {
        if self.parts.is_empty() {
            return vec![self];
        }
        self.parts.iter().flat_map(Self::leaves).collect()
    }
}
