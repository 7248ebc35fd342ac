//! Charts as data, written as SVG and CSV.
//!
//! A [`Chart`] shows series over two axes, as lines or points. It contains no drawing
//! instructions. Text widths come from a built-in font: nothing depends on the system, and the
//! bytes are the same on every machine.
//!
//! Colours are those of Okabe and Ito (*Color Universal Design*, 2008), which people with colour
//! vision deficiencies can distinguish; each series has its own marker as well.

mod axis;
mod chart;
mod font;
mod marks;
pub mod number;
pub(crate) mod svg;

/// Series of points over two axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// The title, in a few words.
    pub title: String,
    /// The axis from left to right; an axis of names runs down the left instead, and `y` to the
    /// right.
    pub x: ChartAxis,
    /// The other axis.
    pub y: ChartAxis,
    /// The series, the most important first: it gets the clearest colour.
    pub series: Vec<Series>,
    /// Guide lines.
    pub guides: Vec<Guide>,
    /// How to read it, in a sentence or two; shown beside the drawing, not in it.
    pub caption: String,
}

/// The meaning of a coordinate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartAxis {
    /// The quantity, such as "time".
    pub label: String,
    /// The unit, such as "s"; empty for a plain number.
    pub unit: String,
    /// The scale of the values.
    pub scale: Scale,
}

/// The scale of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Scale {
    /// Equal differences have equal distances.
    #[default]
    Linear,
    /// Equal ratios have equal distances. Values of 0 or less are not drawn, and a note gives their
    /// number.
    Log,
    /// Names for the values 0, 1, 2 and so on. Only for `x`.
    Names(Vec<String>),
}

/// A series of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// How its points are drawn.
    pub draw: Draw,
    /// The points, in the order in which a line joins them.
    pub points: Vec<Point>,
}

/// How points are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Draw {
    /// Markers, with whiskers for intervals.
    #[default]
    Points,
    /// Markers with whiskers, joined by a line.
    Line,
}

/// One measurement with its interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Its `x`; a value that is not finite is not drawn.
    pub x: f64,
    /// Its `y`.
    pub y: f64,
    /// The lower end of the interval in `y`.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// A description, without the values; may be empty.
    pub label: String,
}

/// A guide line.
#[derive(Clone, Debug, PartialEq)]
pub struct Guide {
    /// Its name, such as "−1/2", written at its second end.
    pub name: String,
    /// Its ends as `[x, y]`; an infinite coordinate is that end of the axis.
    pub ends: [[f64; 2]; 2],
}

impl ChartAxis {
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

impl Guide {
    /// A line at a value of `y`.
    pub fn at(name: &str, y: f64) -> Self {
        Self { name: name.to_owned(), ends: [[f64::NEG_INFINITY, y], [f64::INFINITY, y]] }
    }

    /// A line along which `y` is proportional to `x` to the power of `slope`, below 0: from a point
    /// until it reaches either coordinate of another.
    pub fn power(name: &str, slope: f64, [x, y]: [f64; 2], [last, lowest]: [f64; 2]) -> Self {
        let end = last.min(x * libm::pow(lowest / y, 1.0 / slope));
        Self { name: name.to_owned(), ends: [[x, y], [end, y * libm::pow(end / x, slope)]] }
    }
}
