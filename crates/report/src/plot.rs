//! Charts as data, written as SVG and CSV.
//!
//! A [`Chart`] shows series over two axes, as lines, points or bars. It contains no drawing
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

use number::{figure, time_unit};

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
    /// Segments of bars, over an axis of names: the interval of a point is its segment.
    Bars,
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

impl Chart {
    /// Bars of stages, one above the other: the name and the seconds of each stage. A stage has its
    /// colour in every bar.
    pub fn bars(title: &str, caption: &str, bars: &[(String, Vec<(String, f64)>)]) -> Self {
        let sum = |stages: &[(String, f64)]| stages.iter().map(|(_, seconds)| seconds).sum::<f64>();
        let (scale, unit) =
            time_unit(bars.iter().map(|(_, stages)| sum(stages)).fold(0.0, f64::max));
        let mut series: Vec<Series> = Vec::new();
        for (row, (_, stages)) in bars.iter().enumerate() {
            let mut end = 0.0;
            for (stage, seconds) in stages {
                // A bar of no length has no parts.
                let all = sum(stages).max(f64::MIN_POSITIVE);
                let (low, share) = (end, (1000.0 * seconds / all).round() / 10.0);
                end += scale * seconds;
                let label = format!("{}% of the bar", figure(share));
                let (x, y) = (row as f64, scale * seconds);
                let point = Point { x, y, low, high: end, label };
                match series.iter_mut().find(|series| series.name == *stage) {
                    Some(series) => series.points.push(point),
                    None => series.push(Series {
                        name: stage.clone(),
                        draw: Draw::Bars,
                        points: vec![point],
                    }),
                }
            }
        }
        let names = bars.iter().map(|(name, _)| name.clone()).collect();
        Self {
            title: title.to_owned(),
            x: ChartAxis::new("bar", "", Scale::Names(names)),
            y: ChartAxis::new("time", unit, Scale::Linear),
            series,
            guides: Vec::new(),
            caption: caption.to_owned(),
        }
    }
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
