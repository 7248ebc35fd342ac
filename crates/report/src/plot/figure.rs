//! Output of figures: SVG, PNG, CSV, and notes on omitted values.

use std::path::Path;

use super::drawing::{Drawing, Frame};
use super::number::exact;
use super::place::position;
use super::{Bar, Chart, Point, Scale, Segment, StackedBars, bars, chart, guides, raster, svg};
use wavecrest_base::error::Result;
use wavecrest_base::replace::replace_file;

/// The common interface of all kinds of figures.
pub(crate) trait Figure: serde::Serialize {
    /// Its title.
    fn title(&self) -> &str;

    /// How to read it.
    fn caption(&self) -> &str;

    /// Notes on omitted values, in sentences.
    fn notes(&self) -> Vec<String>;

    /// Its values to the last digit, drawn or not: the header, then a row for each.
    fn rows(&self) -> Vec<Vec<String>>;

    /// The drawing without its notes.
    fn draw(&self, frame: Frame) -> Drawing;

    /// The drawing.
    fn drawing(&self, frame: Frame) -> Drawing {
        let mut drawing = self.draw(frame);
        drawing.notes(&self.notes());
        drawing
    }

    /// For a page: at the width of its text, and for narrow screens.
    fn elements(&self) -> String {
        let element = |frame, class| svg::element(&self.drawing(frame), self.title(), class);
        element(Frame::WIDE, "wide") + &element(Frame::NARROW, "narrow")
    }

    /// A standalone SVG file. It follows the reader's light or dark theme.
    fn svg(&self) -> String {
        svg::file(&self.drawing(Frame::FILE), self.title(), self.caption())
    }

    /// Writes a PNG with this width in pixels, with the layout of the SVG at 720.
    ///
    /// # Errors
    /// If the file cannot be written, or the width is 0 or above 16384.
    fn png(&self, path: &Path, width: u32) -> Result<()> {
        replace_file(path, |sink| raster::write(&self.drawing(Frame::FILE), width, sink))
    }

    /// Its rows as CSV (RFC 4180).
    fn csv(&self) -> String {
        let line = |row: &Vec<String>| {
            let fields: Vec<String> = row.iter().map(|field| quoted(field)).collect();
            fields.join(",") + "\r\n"
        };
        self.rows().iter().map(line).collect()
    }
}

/// A field of CSV.
fn quoted(field: &str) -> String {
    if field.contains(['"', ',', '\n', '\r']) {
        return format!("\"{}\"", field.replace('"', "\"\""));
    }
    field.to_owned()
}

/// A note on the number of omitted items.
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

    /// Notes on points and guides that an axis cannot show.
    fn notes(&self) -> Vec<String> {
        let why = match self.x.scale == Scale::Log || self.y.scale == Scale::Log {
            true => "a logarithmic axis has no place for 0, less, or what is not finite",
            false => "an axis has no place for it",
        };
        let has_place = |point: &&Point| {
            position(&self.x.scale, point.x).and(position(&self.y.scale, point.y)).is_some()
        };
        let points = self.series.iter().flat_map(|series| &series.points);
        let points = points.filter(|point| !has_place(point)).count();
        let guides = self.guides.iter().filter(|guide| !guides::can_be_drawn(self, guide.course));
        let guides = left_out(guides.count(), "line to compare with", why);
        left_out(points, "point", why).into_iter().chain(guides).collect()
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let (x, y) = (self.x.heading(), self.y.heading());
        let header = ["series", &x, &y, "low", "high", "label"].map(str::to_owned).to_vec();
        let x = |value: f64| match &self.x.scale {
            Scale::Names(_) => chart::name_or_value(&self.x, value),
            _ => exact(value),
        };
        let optional = |value: Option<f64>| value.map(exact).unwrap_or_default();
        let row = |name: &str, p: &Point| {
            let (low, high) = (optional(p.low), optional(p.high));
            vec![name.to_owned(), x(p.x), exact(p.y), low, high, p.label.clone()]
        };
        let rows = self.series.iter().flat_map(|s| s.points.iter().map(|p| row(&s.name, p)));
        std::iter::once(header).chain(rows).collect()
    }

    fn draw(&self, frame: Frame) -> Drawing {
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

    /// Notes on times that are negative or not finite.
    fn notes(&self) -> Vec<String> {
        let missing = self.bars.iter().map(|bar| bar.segments.len() - bar.drawn().count());
        left_out(missing.sum(), "time", "it is below 0 or not finite").into_iter().collect()
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let header = ["bar", "stage", "seconds"].map(str::to_owned).to_vec();
        let row = |bar: &Bar, segment: &Segment| {
            vec![bar.name.clone(), segment.stage.clone(), exact(segment.seconds)]
        };
        let rows = self.bars.iter().flat_map(|bar| bar.segments.iter().map(|s| row(bar, s)));
        std::iter::once(header).chain(rows).collect()
    }

    fn draw(&self, frame: Frame) -> Drawing {
        bars::draw(self, frame)
    }
}
