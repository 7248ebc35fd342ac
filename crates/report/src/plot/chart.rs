//! Draws a [`Chart`] (title, legend, axes, guides, series), and writes its values.

use std::path::Path;

use super::axis::{Field, Mapping};
use super::marks::{STROKE, legend, marker};
use super::number::{exact, figure, quantity};
use super::svg::{ABOVE, At, BESIDE, Drawing, NOTE, Paint};
use super::{Chart, ChartAxis, Draw, Point, Scale, Series, font};
use crate::files::write_text;
use wavecrest_base::error::Result;

/// Distance between rows of names.
const ROW: f64 = 34.0;
/// Distance from a guide to its name.
const GAP: f64 = 6.0;

/// Half the length of the cap of a whisker, and the width of its lines.
const CAP: f64 = 3.5;
const WHISKER: f64 = 1.4;

/// The width of a guide, and the smallest distance between names of guides.
const GUIDE: f64 = 1.2;
const APART: f64 = 1.2 * NOTE;

/// Width of a file: as in a page, less the margins; then in a page, and on a narrow screen.
const FILE: f64 = 680.0;
const WIDE: f64 = 720.0;
const NARROW: f64 = 340.0;

/// The size of the title of a file, and the distance from its top to the content below.
const TITLE: f64 = 17.0;
const TITLE_HEIGHT: f64 = TITLE + 14.0;

impl Chart {
    /// Two SVG elements for a page: at the width of its text, and for narrow screens.
    pub fn elements(&self) -> [String; 2] {
        let element = |width, class| {
            let mut drawing = Drawing::new(width);
            self.draw(&mut drawing);
            drawing.element(&self.title, class)
        };
        [element(WIDE, "wide"), element(NARROW, "narrow")]
    }

    /// A standalone SVG file. It follows the reader's light or dark theme.
    pub fn svg(&self) -> String {
        let mut drawing = Drawing::new(FILE);
        let title = font::shortened(&self.title, TITLE, FILE);
        drawing.words(&title, TITLE, Paint::INK, TITLE_HEIGHT);
        self.draw(&mut drawing);
        if let Some(note) = self.note() {
            drawing.words(&note, NOTE, Paint::MUTED, 1.5 * NOTE);
        }
        drawing.file(&self.title, &self.caption)
    }

    /// Its rows as CSV (RFC 4180).
    pub fn csv(&self) -> String {
        let line = |row: Vec<String>| {
            let fields: Vec<String> = row.iter().map(|field| quoted(field)).collect();
            fields.join(",") + "\r\n"
        };
        self.rows().into_iter().map(line).collect()
    }

    /// Writes it as SVG and CSV to files of this name in `folder`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path, name: &str) -> Result<()> {
        write_text(&folder.join(format!("{name}.svg")), &self.svg())?;
        write_text(&folder.join(format!("{name}.csv")), &self.csv())
    }

    /// A note on the number of points that are not drawn.
    pub fn note(&self) -> Option<String> {
        let field = self.field();
        let points = self.series.iter().flat_map(|series| &series.points);
        let missing = points.filter(|point| field.at(point.x, point.y).is_none()).count();
        let verb = if missing == 1 { "point is" } else { "points are" };
        let why = "a logarithmic axis has no place for 0, less, or what is not finite";
        (missing > 0).then(|| format!("{missing} {verb} not shown: {why}."))
    }

    /// Its values to the last digit, drawn or not: the header, then a row for each.
    pub(crate) fn rows(&self) -> Vec<Vec<String>> {
        let (x, y) = (self.x.heading(), self.y.heading());
        let header = ["series", &x, &y, "low", "high", "label"].map(str::to_owned).to_vec();
        let x = |value: f64| match &self.x.scale {
            Scale::Names(_) => name_or_value(&self.x, value),
            _ => exact(value),
        };
        let row = |name: &str, p: &Point| {
            vec![name.to_owned(), x(p.x), exact(p.y), exact(p.low), exact(p.high), p.label.clone()]
        };
        let rows = self.series.iter().flat_map(|s| s.points.iter().map(|p| row(&s.name, p)));
        std::iter::once(header).chain(rows).collect()
    }

    fn draw(&self, drawing: &mut Drawing) {
        legend(drawing, &self.series);
        let mut field = self.field();
        let height = match &self.x.scale {
            Scale::Names(names) => ROW * names.len().max(1) as f64,
            _ if drawing.width < 500.0 => 230.0,
            _ => 330.0,
        };
        field.draw(drawing, height, self.room());
        self.draw_guides(drawing, &field);
        for index in 0..self.series.len() {
            self.draw_series(drawing, index, &field);
        }
    }

    /// The axes, with room for everything visible.
    fn field(&self) -> Field<'_> {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let ys = points().flat_map(|point| [point.y, point.low, point.high]);
        let guides =
            |side: usize| self.guides.iter().flat_map(move |guide| guide.ends.map(|end| end[side]));
        Field {
            x: Mapping::new(&self.x, points().map(|point| point.x).chain(guides(0))),
            y: Mapping::new(&self.y, ys.chain(guides(1))),
            turned: matches!(self.x.scale, Scale::Names(_)),
        }
    }

    /// The room above the field and on its right, for names of guides.
    fn room(&self) -> [f64; 2] {
        let names = self.guides.iter().map(|guide| font::width(&guide.name, NOTE) + 2.0 * GAP);
        match self.x.scale {
            Scale::Names(_) => [if self.guides.is_empty() { 0.0 } else { 1.5 * NOTE }, 0.0],
            _ => [0.0, names.fold(0.0, f64::max)],
        }
    }

    /// Draws the guides, each with its name at its end, without overlaps between names.
    fn draw_guides(&self, drawing: &mut Drawing, field: &Field<'_>) {
        let place =
            |[x, y]: [f64; 2]| field.oriented(field.x.pixel_of_end(x), field.y.pixel_of_end(y));
        let mut names: Vec<(At, &str)> = Vec::new();
        for guide in &self.guides {
            let [from, to] = guide.ends.map(place);
            drawing.line(&[from, to], Paint::GUIDE, GUIDE);
            names.push((to, &guide.name));
        }
        names.sort_by(|(a, _), (b, _)| a[1].total_cmp(&b[1]));
        let mut free = f64::NEG_INFINITY;
        for ([x, y], name) in names {
            let (at, align) = match field.turned {
                true => ([x, y - GAP], ("middle", ABOVE)),
                false => ([x + GAP, y.max(free)], ("start", BESIDE)),
            };
            free = at[1] + APART;
            drawing.text(name, at, align, NOTE, Paint::MUTED);
        }
    }

    fn draw_series(&self, drawing: &mut Drawing, index: usize, field: &Field<'_>) {
        let Series { draw, points, .. } = &self.series[index];
        let places: Vec<Option<At>> = points.iter().map(|p| field.at(p.x, p.y)).collect();
        if *draw == Draw::Line {
            // Points without a position separate lines.
            for run in places.split(Option::is_none).filter(|run| run.len() > 1) {
                let run: Vec<At> = run.iter().copied().flatten().collect();
                drawing.line(&run, Paint::series(index), STROKE);
            }
        }
        for (point, at) in points.iter().zip(places) {
            let Some(at) = at else { continue };
            drawing.begin(&self.words(index, point), point, at);
            let end = |y: f64| {
                let y = field.y.pixel_of_end(y);
                if field.turned { [y, at[1]] } else { [at[0], y] }
            };
            whisker(drawing, [point.low, point.high].map(end), field.turned, index);
            marker(drawing, at, index);
            drawing.end();
        }
    }

    fn words(&self, index: usize, point: &Point) -> String {
        let x = match (&self.x.scale, &*self.x.label) {
            (Scale::Names(_), _) | (_, "") => name_or_value(&self.x, point.x),
            (_, label) => format!("{label}: {}", name_or_value(&self.x, point.x)),
        };
        let value = quantity(point.y, &self.y.unit);
        let [low, high] = [point.low, point.high].map(figure);
        let y = format!("{}: {value} ({low} to {high})", self.y.label);
        let lines = [&self.series[index].name, &point.label, &x, &y].map(String::as_str);
        lines.into_iter().filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
    }
}

/// A line between the ends of an interval, with a cap at each.
fn whisker(drawing: &mut Drawing, ends: [At; 2], turned: bool, index: usize) {
    let [dx, dy] = if turned { [0.0, CAP] } else { [CAP, 0.0] };
    let cap = |[x, y]: At| [[x - dx, y - dy], [x + dx, y + dy]];
    for line in [ends, cap(ends[0]), cap(ends[1])] {
        drawing.line(&line, Paint::series(index), WHISKER);
    }
}

/// A value of `x` in words.
fn name_or_value(axis: &ChartAxis, value: f64) -> String {
    match &axis.scale {
        Scale::Names(names) => names.get(value as usize).cloned().unwrap_or_default(),
        _ => quantity(value, &axis.unit),
    }
}

/// A field of CSV.
fn quoted(field: &str) -> String {
    if field.contains(['"', ',', '\n', '\r']) {
        return format!("\"{}\"", field.replace('"', "\"\""));
    }
    field.to_owned()
}
