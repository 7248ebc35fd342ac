//! A drawing, written as SVG. Coordinates are pixels, y downward.
//!
//! Each shape has its colour on white paper as an attribute, which any reader understands, and a
//! class, for which a style sheet may set another: the one in `chart.css` follows light and dark
//! themes, and has those on a dark background under the same names.

use super::number::exact;
use super::{Point, font};
use crate::markup::escape;

/// A point of a drawing.
pub(super) type At = [f64; 2];

/// The size of labels.
pub(super) const LABEL: f64 = 12.5;
/// The size of notes.
pub(super) const NOTE: f64 = 11.0;
/// The margin of a standalone drawing.
const MARGIN: f64 = 20.0;

/// Distances from a point to the base line of text below it, beside it and above it, as shares of
/// its size: capitals and digits of Noto Sans are 0.714 em high, and descenders reach 0.24 em
/// below.
pub(super) const BELOW: f64 = 0.8;
pub(super) const BESIDE: f64 = 0.357;
pub(super) const ABOVE: f64 = -0.24;

/// Texts wider than this have an explicit length: a browser without the font could otherwise make
/// them overlap others.
const LONG: f64 = 60.0;

/// Distance at which a pointer selects a mark.
const NEAR: f64 = 10.0;

/// The style sheet of all drawings.
const STYLE: &str = include_str!("chart.css");

/// A colour: its name in style sheets, and its value on white paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Paint(pub(super) &'static str, pub(super) [u8; 3]);

/// Those of Okabe and Ito's colours that have enough contrast to white: no chart has more series.
const SERIES: [Paint; 4] = [
    Paint("s0", [0, 114, 178]),
    Paint("s1", [213, 94, 0]),
    Paint("s2", [0, 158, 115]),
    Paint("s3", [0, 0, 0]),
];

impl Paint {
    /// Prominent text.
    pub(super) const INK: Self = Self("ink", [26, 28, 32]);
    /// Text and marks in the background.
    pub(super) const MUTED: Self = Self("muted", [92, 97, 105]);
    /// Guide lines.
    pub(super) const GUIDE: Self = Self("guide", [120, 125, 133]);
    /// Grid lines at the labels of an axis.
    pub(super) const GRID: Self = Self("grid", [215, 218, 223]);
    /// Grid lines between them.
    pub(super) const FAINT: Self = Self("faint", [238, 239, 242]);
    /// The background.
    pub(super) const PAPER: Self = Self("paper", [255, 255, 255]);

    /// The colour of a series, counted from 0: they begin again after the last.
    pub(super) fn series(index: usize) -> Self {
        SERIES[index % SERIES.len()]
    }
}

/// The shapes drawn so far.
pub(super) struct Drawing {
    /// Its width, without margins.
    pub width: f64,
    /// Its height so far.
    pub height: f64,
    shapes: String,
}

impl Drawing {
    /// An empty drawing of this width.
    pub(super) fn new(width: f64) -> Self {
        Self { width, height: 0.0, shapes: String::new() }
    }

    /// Adds a line along points.
    pub(super) fn line(&mut self, points: &[At], paint: Paint, width: f64) {
        let (stroke, width) = (colour(paint, "stroke", 'k'), number(width));
        let attributes = format!("fill=\"none\" {stroke} stroke-width=\"{width}\"");
        self.shapes += &format!("<path d=\"{}\" {attributes}/>\n", path(points));
    }

    /// Adds the inside of a polygon.
    pub(super) fn area(&mut self, points: &[At], paint: Paint) {
        self.shapes += &format!("<path d=\"{}Z\" {}/>\n", path(points), fill(paint));
    }

    /// Adds a disk.
    pub(super) fn disk(&mut self, center: At, radius: f64, paint: Paint) {
        let ([x, y], r) = (center.map(number), number(radius));
        self.shapes += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" {}/>\n", fill(paint));
    }

    /// Adds a text at a point: `anchor` is the part of it at the point, `start`, `middle` or `end`,
    /// and `line` one of [`BELOW`], [`BESIDE`] and [`ABOVE`]. An outline in the background colour
    /// separates it from lines below.
    pub(super) fn text(
        &mut self,
        text: &str,
        [x, y]: At,
        (anchor, line): (&str, f64),
        size: f64,
        paint: Paint,
    ) {
        let ([x, y], width) = ([x, y + line * size].map(number), font::width(text, size));
        let length = match width > LONG {
            true => format!(" textLength=\"{}\" lengthAdjust=\"spacingAndGlyphs\"", number(width)),
            false => String::new(),
        };
        let fill = fill(paint).replace("class=\"", "class=\"k-paper ");
        self.shapes += &format!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" text-anchor=\"{anchor}\"{length} {fill} \
             stroke=\"#ffffff\" stroke-width=\"4\" stroke-linejoin=\"round\" \
             paint-order=\"stroke\">{}</text>\n",
            number(size),
            escape(text)
        );
    }

    /// Adds a line of text of this height at the bottom.
    pub(super) fn words(&mut self, text: &str, size: f64, paint: Paint, height: f64) {
        self.text(text, [0.0, self.height], ("start", BELOW), size, paint);
        self.height += height;
    }

    /// Starts a mark: its meaning in words, a line each, and the values of its point, as in CSV. A
    /// pointer near its centre selects it.
    pub(super) fn begin(&mut self, title: &str, p: &Point, center: At) {
        self.shapes += "<g class=\"mark\" role=\"img\"";
        for (name, value) in [("x", p.x), ("y", p.y), ("low", p.low), ("high", p.high)] {
            self.shapes += &format!(" data-{name}=\"{}\"", exact(value));
        }
        self.shapes += &format!("><title>{}</title>\n", escape(title));
        let [x, y] = center.map(number);
        self.shapes += &format!(
            "<circle class=\"near\" cx=\"{x}\" cy=\"{y}\" r=\"{NEAR}\" fill=\"none\" \
             pointer-events=\"all\"/>\n"
        );
    }

    /// Ends the mark.
    pub(super) fn end(&mut self) {
        self.shapes += "</g>\n";
    }

    /// An element of a page with [`STYLE`]; its classes are `chart` and `class`.
    pub(super) fn element(&self, title: &str, class: &str) -> String {
        let title = escape(title);
        self.svg(0.0, &format!("class=\"chart {class}\" role=\"group\" aria-label=\"{title}\">"))
    }

    /// A standalone file.
    pub(super) fn file(&self, title: &str, caption: &str) -> String {
        let [width, height] = [self.width, self.height].map(|side| number(side + 2.0 * MARGIN));
        let (title, caption, start) = (escape(title), escape(caption), number(-MARGIN));
        let head = format!(
            "xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             class=\"chart\" role=\"img\" font-family=\"Noto Sans, sans-serif\">\n\
             <title>{title}</title>\n<desc>{caption}</desc>\n\
             <style>\n:root {{ color-scheme: light dark; }}\n{STYLE}</style>\n\
             <rect x=\"{start}\" y=\"{start}\" width=\"{width}\" height=\"{height}\" {}/>",
            fill(Paint::PAPER)
        );
        self.svg(MARGIN, &head)
    }

    /// The element with this margin: `head` has the rest of its start tag, and the content before
    /// the shapes.
    fn svg(&self, margin: f64, head: &str) -> String {
        let [width, height] = [self.width, self.height].map(|side| number(side + 2.0 * margin));
        let (start, shapes) = (number(-margin), &self.shapes);
        format!("<svg viewBox=\"{start} {start} {width} {height}\" {head}\n{shapes}</svg>\n")
    }
}

fn path(points: &[At]) -> String {
    let points = points.iter().map(|at| at.map(number).join(" "));
    format!("M{}", points.collect::<Vec<_>>().join("L"))
}

fn fill(paint: Paint) -> String {
    colour(paint, "fill", 'f')
}

/// Colour and class of a fill or a stroke.
fn colour(paint: Paint, property: &str, class: char) -> String {
    let Paint(name, [r, g, b]) = paint;
    format!("{property}=\"#{r:02x}{g:02x}{b:02x}\" class=\"{class}-{name}\"")
}

/// A length to a tenth of a pixel, as short as possible.
fn number(pixels: f64) -> String {
    let text = format!("{pixels:.1}");
    match text.strip_suffix(".0").unwrap_or(&text) {
        "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_style_sheet_knows_every_paint() {
        let css = include_str!("chart.css");
        let others =
            [Paint::INK, Paint::MUTED, Paint::GUIDE, Paint::GRID, Paint::FAINT, Paint::PAPER];
        for Paint(name, [r, g, b]) in others.into_iter().chain(SERIES) {
            let light = format!("--{name}: light-dark(#{r:02x}{g:02x}{b:02x}, #");
            assert_eq!(css.matches(&light).count(), 1, "{light}");
            for (class, property) in [("f", "fill"), ("k", "stroke")] {
                let rule = format!(".{class}-{name} {{ {property}: var(--{name}); }}");
                assert_eq!(css.matches(&rule).count(), 1, "{rule}");
            }
        }
    }

    /// Web Content Accessibility Guidelines 2.2, "relative luminance" and "contrast ratio".
    fn contrast(a: [u8; 3], b: [u8; 3]) -> f64 {
        let luminance = |rgb: [u8; 3]| {
            let linear = rgb.map(|byte| {
                let c = f64::from(byte) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            });
            0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    /// The colour of this name on dark paper.
    fn dark(name: &str) -> [u8; 3] {
        let css = include_str!("chart.css");
        let both = css.split_once(&format!("--{name}: light-dark(")).unwrap().1;
        let rest = both.split_once(", #").unwrap().1;
        let byte = |at: usize| u8::from_str_radix(&rest[at..at + 2], 16).unwrap();
        [byte(0), byte(2), byte(4)]
    }

    #[test]
    fn text_and_series_stand_out_from_either_paper() {
        let papers = [Paint::PAPER.1, dark("paper")];
        let text = [Paint::INK, Paint::MUTED].map(|paint| (paint, 4.5));
        for (Paint(name, colour), least) in text.into_iter().chain(SERIES.map(|s| (s, 3.0))) {
            for (colour, paper) in [colour, dark(name)].into_iter().zip(papers) {
                assert!(contrast(colour, paper) >= least, "{name} {}", contrast(colour, paper));
            }
        }
    }
}
