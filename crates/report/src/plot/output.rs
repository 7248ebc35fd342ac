//! What is made of a chart: SVG, PNG, CSV, and notes on what could not be drawn.

use std::path::Path;

use super::frame::{ALONE, Frame, NARROW, WIDE};
use super::number::exact;
use super::picture::{Drawn, Picture};
use super::{Axis, Bar, Chart, Scale, Segment, StackedBars, bars, chart, marks, raster, svg};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::replace_file;

/// What both kinds of drawings are asked for.
pub(crate) trait Figure: serde::Serialize {
    /// Its title.
    fn title(&self) -> &str;

    /// How to read it.
    fn caption(&self) -> &str;

    /// What could not be drawn, in sentences.
    fn notes(&self) -> Vec<String>;

    /// Its figures: the header, then a row for each.
    fn rows(&self) -> Vec<Vec<String>>;

    /// The drawing.
    fn draw(&self, frame: Frame) -> Drawn<Picture>;

    /// The drawing, or why there is none.
    fn picture(&self, frame: Frame) -> Result<Picture> {
        self.draw(frame).map_err(|error| {
            let message = format!("cannot draw \"{}\": {error}", self.title());
            Error::new(ErrorKind::Limit, message)
        })
    }

    /// For a page: as wide as its text, and for narrow screens.
    fn elements(&self) -> Result<String> {
        let wide = svg::element(&self.picture(WIDE)?, self.title(), "wide");
        Ok(wide + &svg::element(&self.picture(NARROW)?, self.title(), "narrow"))
    }

    /// See [`Chart::svg`].
    fn svg_file(&self) -> Result<String> {
        Ok(svg::file(&self.picture(ALONE)?, self.title(), self.caption()))
    }

    /// See [`Chart::png`].
    fn png_file(&self, path: &Path, width: u32) -> Result<()> {
        let picture = self.picture(ALONE)?;
        replace_file(path, |sink| raster::write(&picture, width, sink))
    }

    /// See [`Chart::csv`].
    fn csv_text(&self) -> String {
        let line = |row: &Vec<String>| {
            let fields: Vec<String> = row.iter().map(|field| quoted(field)).collect();
            fields.join(",") + "\r\n"
        };
        self.rows().iter().map(line).collect()
    }
}

/// A field of CSV (RFC 4180).
fn quoted(field: &str) -> String {
    if field.contains(['"', ',', '\n', '\r']) {
        return format!("\"{}\"", field.replace('"', "\"\""));
    }
    field.to_owned()
}

impl Chart {
    /// The chart as an SVG file that stands alone. It follows light and dark where its reader does.
    ///
    /// # Errors
    /// When plotters cannot lay it out.
    pub fn svg(&self) -> Result<String> {
        self.svg_file()
    }

    /// Writes the chart as a PNG `width` pixels wide, as large as the SVG at 720.
    ///
    /// # Errors
    /// When the file cannot be written, or the width is 0 or above 16384.
    pub fn png(&self, path: &Path, width: u32) -> Result<()> {
        self.png_file(path, width)
    }

    /// All points as CSV, drawn or not: series, x, y, low, high and label, to the last digit.
    pub fn csv(&self) -> String {
        self.csv_text()
    }

    /// What could not be drawn, in sentences: points and guides that an axis has no place for.
    pub fn notes(&self) -> Vec<String> {
        let all = self.series.iter().flat_map(|series| &series.points);
        let missing =
            all.filter(|point| !has_place(&self.x, point.x) || !has_place(&self.y, point.y));
        let mut notes = Vec::new();
        let is_log = [&self.x, &self.y].map(|axis| axis.scale == Scale::Log).contains(&true);
        let why = match is_log {
            true => "a logarithmic axis has no place for 0, less, or what is not finite",
            false => "an axis has no place for it",
        };
        notes.extend(left_out(missing.count(), "point", why));
        let guides = self.guides.iter().filter(|guide| !marks::can_be_drawn(self, guide.course));
        notes.extend(left_out(guides.count(), "line to compare with", why));
        notes
    }
}

impl StackedBars {
    /// The bars as an SVG file that stands alone. It follows light and dark where its reader does.
    ///
    /// # Errors
    /// When plotters cannot lay them out.
    pub fn svg(&self) -> Result<String> {
        self.svg_file()
    }

    /// Writes the bars as a PNG `width` pixels wide, as large as the SVG at 720.
    ///
    /// # Errors
    /// When the file cannot be written, or the width is 0 or above 16384.
    pub fn png(&self, path: &Path, width: u32) -> Result<()> {
        self.png_file(path, width)
    }

    /// All segments as CSV: bar, stage and seconds, to the last digit.
    pub fn csv(&self) -> String {
        self.csv_text()
    }

    /// What could not be drawn, in sentences: times that are negative or not finite.
    pub fn notes(&self) -> Vec<String> {
        let all = self.bars.iter().flat_map(|bar| &bar.segments);
        let missing = all.filter(|segment| !segment.is_drawn()).count();
        left_out(missing, "time", "it is below 0 or not finite").into_iter().collect()
    }

    /// The stages, in the order in which they first come.
    pub(super) fn stages(&self) -> Vec<&str> {
        let mut stages = Vec::new();
        for segment in self.bars.iter().flat_map(|bar| &bar.segments) {
            if !stages.contains(&segment.stage.as_str()) {
                stages.push(segment.stage.as_str());
            }
        }
        stages
    }
}

impl Segment {
    /// Whether it is a time.
    pub(super) fn is_drawn(&self) -> bool {
        self.seconds.is_finite() && self.seconds >= 0.0
    }
}

impl Bar {
    /// The sum of what is drawn, in seconds.
    pub(super) fn drawn(&self) -> f64 {
        self.segments.iter().filter(|s| s.is_drawn()).map(|segment| segment.seconds).sum()
    }
}

fn has_place(axis: &Axis, value: f64) -> bool {
    super::place::position(&axis.scale, value).is_some()
}

/// A note on so many things that are not shown.
fn left_out(count: usize, name: &str, why: &str) -> Option<String> {
    match count {
        0 => None,
        1 => Some(format!("1 {name} is not shown: {why}.")),
        _ => Some(format!("{count} {name}s are not shown: {why}.")),
    }
}

impl Figure for Chart {
    fn title(&self) -> &str {
        &self.title
    }

    fn caption(&self) -> &str {
        &self.caption
    }

    fn notes(&self) -> Vec<String> {
        Chart::notes(self)
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let (x, y) = (self.x.heading(), self.y.heading());
        let header = ["series", &x, &y, "low", "high", "label"].map(str::to_owned).to_vec();
        let x = |value: f64| match &self.x.scale {
            Scale::Names(_) => marks::name_or_value(&self.x, value),
            _ => exact(value),
        };
        let optional = |value: Option<f64>| value.map(exact).unwrap_or_default();
        let row = |name: &str, p: &super::Point| {
            let (low, high) = (optional(p.low), optional(p.high));
            vec![name.to_owned(), x(p.x), exact(p.y), low, high, p.label.clone()]
        };
        let rows = self.series.iter().flat_map(|s| s.points.iter().map(|p| row(&s.name, p)));
        std::iter::once(header).chain(rows).collect()
    }

    fn draw(&self, frame: Frame) -> Drawn<Picture> {
        chart::draw(self, frame)
    }
}

impl Figure for StackedBars {
    fn title(&self) -> &str {
        &self.title
    }

    fn caption(&self) -> &str {
        &self.caption
    }

    fn notes(&self) -> Vec<String> {
        StackedBars::notes(self)
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let header = ["bar", "stage", "seconds"].map(str::to_owned).to_vec();
        let row = |bar: &Bar, segment: &Segment| {
            vec![bar.name.clone(), segment.stage.clone(), exact(segment.seconds)]
        };
        let rows = self.bars.iter().flat_map(|bar| bar.segments.iter().map(|s| row(bar, s)));
        std::iter::once(header).chain(rows).collect()
    }

    fn draw(&self, frame: Frame) -> Drawn<Picture> {
        bars::draw(self, frame)
    }
}
