//! A drawing as SVG.
//!
//! Each shape has its colour on white paper as an attribute, which any reader understands, and a
//! class, for which a style sheet may set another: the one in `chart.css` follows light and dark
//! themes.

use std::fmt::{Result, Write as _};

use super::drawing::{At, Drawing, Mark, Shape, Text};
use super::paint::Paint;
use crate::markup::escape;

/// Texts wider than this have an explicit length: a browser without the font could otherwise make
/// them overlap others.
const LONG: f64 = 60.0;

/// Distance at which a pointer selects a mark.
const NEAR: f64 = 10.0;

/// The style sheet of all drawings.
pub(crate) const STYLE: &str = include_str!("chart.css");

/// A standalone file.
pub(super) fn file(drawing: &Drawing, title: &str, caption: &str) -> String {
    let ([width, height], start) = (drawing.size().map(number), number(-drawing.margin()));
    let (title, caption) = (escape(title), escape(caption));
    let head = format!(
        "xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" class=\"chart\" \
         role=\"img\" font-family=\"Noto Sans, sans-serif\">\n\
         <title>{title}</title>\n<desc>{caption}</desc>\n\
         <style>\n:root {{ color-scheme: light dark; }}\n{STYLE}</style>\n\
         <rect x=\"{start}\" y=\"{start}\" width=\"{width}\" height=\"{height}\" {}/>",
        fill(Paint::Paper)
    );
    element_of(drawing, &head)
}

/// An element of a page with [`STYLE`]; its classes are `chart` and `class`.
pub(super) fn element(drawing: &Drawing, title: &str, class: &str) -> String {
    let title = escape(title);
    let head = format!("class=\"chart {class}\" role=\"group\" aria-label=\"{title}\">");
    element_of(drawing, &head)
}

/// The element: `head` has the rest of its start tag, and the content before the shapes.
fn element_of(drawing: &Drawing, head: &str) -> String {
    let ([width, height], start) = (drawing.size().map(number), number(-drawing.margin()));
    let mut text = format!("<svg viewBox=\"{start} {start} {width} {height}\" {head}\n");
    for shape in &drawing.shapes {
        // Writing to a string does not fail.
        let _ = write_shape(&mut text, shape);
    }
    text + "</svg>\n"
}

fn write_shape(out: &mut String, shape: &Shape) -> Result {
    match shape {
        Shape::Line { points, paint, width, dashed } => {
            let dash = if *dashed { " stroke-dasharray=\"6 4\"" } else { "" };
            let (stroke, width) = (colour(*paint, "stroke", 'k'), number(*width));
            let line = format!("fill=\"none\" {stroke} stroke-width=\"{width}\"{dash}");
            writeln!(out, "<path d=\"{}\" {line}/>", path(points))
        }
        Shape::Area { points, paint } => {
            writeln!(out, "<path d=\"{}Z\" {}/>", path(points), fill(*paint))
        }
        Shape::Disk { center, radius, paint } => {
            let ([x, y], r) = (center.map(number), number(*radius));
            writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" {}/>", fill(*paint))
        }
        Shape::Text(text) => write_text(out, text),
        Shape::Begin(mark) => begin(out, mark),
        Shape::End => writeln!(out, "</g>"),
    }
}

fn begin(out: &mut String, mark: &Mark) -> Result {
    write!(out, "<g class=\"mark\" role=\"img\"")?;
    for (name, value) in &mark.figures {
        write!(out, " data-{name}=\"{}\"", escape(value))?;
    }
    writeln!(out, "><title>{}</title>", escape(&mark.title))?;
    let Some([x, y]) = mark.near.map(|at| at.map(number)) else { return Ok(()) };
    let circle = format!("cx=\"{x}\" cy=\"{y}\" r=\"{NEAR}\"");
    writeln!(out, "<circle class=\"near\" {circle} fill=\"none\" pointer-events=\"all\"/>")
}

fn write_text(out: &mut String, text: &Text) -> Result {
    let ([x, y], size) = (text.at.map(number), number(text.size));
    write!(out, "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"")?;
    if text.anchor > 0.0 {
        let anchor = if text.anchor < 1.0 { "middle" } else { "end" };
        write!(out, " text-anchor=\"{anchor}\"")?;
    }
    if text.width() > LONG {
        let width = number(text.width());
        write!(out, " textLength=\"{width}\" lengthAdjust=\"spacingAndGlyphs\"")?;
    }
    let mut fill = fill(text.paint);
    if text.rim {
        fill = fill.replace("class=\"", "class=\"k-paper ") + " stroke=\"#ffffff\"";
        fill += " stroke-width=\"4\" stroke-linejoin=\"round\" paint-order=\"stroke\"";
    }
    writeln!(out, " {fill}>{}</text>", escape(&text.text))
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
    let ([r, g, b], name) = (paint.rgb(), paint.name());
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
