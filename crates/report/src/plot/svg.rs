//! A picture as SVG.
//!
//! Each shape has its colour on white paper as an attribute, which any reader understands, and a
//! class, by which a style sheet gives it another: the one in `chart.css` follows light and dark.

use std::fmt::Write as _;

use plotters_backend::BackendCoord;

use super::paint::Paint;
use super::picture::{Ink, Lettering, Mark, Picture, STEPS, Shape};
use crate::markup::escape;

/// Texts wider than this have their width prescribed, in pixels: a browser without the font would
/// have them reach into what stands beside them.
const LONG: f64 = 60.0;

/// How near a pointer has to come to a mark, in pixels.
const NEAR: f64 = 10.0;

/// The style sheet of all drawings.
pub(crate) const STYLE: &str = include_str!("chart.css");

/// A file that stands alone.
pub(super) fn file(picture: &Picture, title: &str, caption: &str) -> String {
    let [width, height] = picture.size.map(|steps| steps_to_text(f64::from(steps)));
    let (title, caption) = (escape(title), escape(caption));
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" class=\"chart\" role=\"img\" font-family=\"Noto Sans, sans-serif\">\n\
         <title>{title}</title>\n<desc>{caption}</desc>\n\
         <style>\n:root {{ color-scheme: light dark; }}\n{STYLE}</style>\n"
    );
    shapes(&mut text, picture);
    text + "</svg>\n"
}

/// An element of a page that has [`STYLE`]; `class` is its class besides `chart`.
pub(super) fn element(picture: &Picture, title: &str, class: &str) -> String {
    let [width, height] = picture.size.map(|steps| steps_to_text(f64::from(steps)));
    let mut text = format!(
        "<svg viewBox=\"0 0 {width} {height}\" class=\"chart {class}\" role=\"group\" aria-label=\"{}\">\n",
        escape(title)
    );
    shapes(&mut text, picture);
    text + "</svg>\n"
}

fn shapes(text: &mut String, picture: &Picture) {
    for shape in &picture.shapes {
        // Writing to a string does not fail.
        let _ = write_shape(text, shape);
    }
}

fn write_shape(text: &mut String, shape: &Shape) -> std::fmt::Result {
    match shape {
        Shape::Line { points, ink, width, dashed } => {
            let (width, dash) = (pixels(*width as i32), dash(*dashed));
            let (path, stroke) = (path(points), stroke(*ink));
            writeln!(
                text,
                "<path d=\"{path}\" fill=\"none\" {stroke} stroke-width=\"{width}\"{dash}/>"
            )
        }
        Shape::Area { points, ink } => {
            writeln!(text, "<path d=\"{}Z\" {}/>", path(points), fill(*ink))
        }
        Shape::Disk { center, radius, ink } => {
            writeln!(text, "<circle {} {}/>", circle(*center, *radius), fill(*ink))
        }
        Shape::Ring { center, radius, ink, width } => {
            let (circle, stroke) = (circle(*center, *radius), stroke(*ink));
            let width = pixels(*width as i32);
            writeln!(text, "<circle {circle} fill=\"none\" {stroke} stroke-width=\"{width}\"/>")
        }
        Shape::Text(lettering) => write_text(text, lettering),
        Shape::Begin(mark) => begin(text, mark),
        Shape::End => writeln!(text, "</g>"),
    }
}

fn begin(text: &mut String, mark: &Mark) -> std::fmt::Result {
    write!(text, "<g class=\"mark\" role=\"img\"")?;
    for (name, value) in &mark.figures {
        write!(text, " data-{name}=\"{}\"", escape(value))?;
    }
    writeln!(text, "><title>{}</title>", escape(&mark.told))?;
    if let Some((x, y)) = mark.near {
        let (x, y) = (pixels(x), pixels(y));
        writeln!(
            text,
            "<circle class=\"near\" cx=\"{x}\" cy=\"{y}\" r=\"{NEAR}\" fill=\"none\" pointer-events=\"all\"/>"
        )?;
    }
    Ok(())
}

fn write_text(text: &mut String, lettering: &Lettering) -> std::fmt::Result {
    let Lettering { at: [x, y], size, width, fixed, ink, rim, .. } = lettering;
    let (x, y) = (steps_to_text(x + fixed * width), steps_to_text(*y));
    let anchor = match fixed {
        0.0 => "",
        1.0 => " text-anchor=\"end\"",
        _ => " text-anchor=\"middle\"",
    };
    let (size, letters) = (steps_to_text(*size), escape(&lettering.text));
    let length = match width / f64::from(STEPS) > LONG {
        true => {
            format!(" textLength=\"{}\" lengthAdjust=\"spacingAndGlyphs\"", steps_to_text(*width))
        }
        false => String::new(),
    };
    let mut fill = fill(*ink);
    if *rim {
        let [r, g, b] = Paint::Paper.rgb();
        fill = fill.replace("class=\"", "class=\"k-paper ");
        let _ = write!(fill, " stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-width=\"4\"");
        fill.push_str(" stroke-linejoin=\"round\" paint-order=\"stroke\"");
    }
    writeln!(
        text,
        "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{anchor}{length} {fill}>{letters}</text>"
    )
}

fn path(points: &[BackendCoord]) -> String {
    let mut path = String::new();
    for (index, &(x, y)) in points.iter().enumerate() {
        let letter = if index == 0 { 'M' } else { 'L' };
        let _ = write!(path, "{letter}{} {}", pixels(x), pixels(y));
    }
    path
}

fn circle((x, y): BackendCoord, radius: u32) -> String {
    format!("cx=\"{}\" cy=\"{}\" r=\"{}\"", pixels(x), pixels(y), pixels(radius as i32))
}

fn fill(ink: Ink) -> String {
    paint(ink, "fill", 'f')
}

fn stroke(ink: Ink) -> String {
    paint(ink, "stroke", 'k')
}

/// Colour and class of a fill or a stroke.
fn paint(ink: Ink, property: &str, class: char) -> String {
    let ([r, g, b], name) = (ink.paint.rgb(), ink.paint.name());
    let mut text = format!("{property}=\"#{r:02x}{g:02x}{b:02x}\" class=\"{class}-{name}\"");
    if ink.alpha < 1.0 {
        let _ = write!(text, " {property}-opacity=\"{}\"", ink.alpha);
    }
    text
}

fn dash(dashed: bool) -> &'static str {
    if dashed { " stroke-dasharray=\"6 4\"" } else { "" }
}

/// Steps as pixels, in as few letters as they take.
fn pixels(steps: i32) -> String {
    steps_to_text(f64::from(steps))
}

fn steps_to_text(steps: f64) -> String {
    let text = format!("{:.1}", steps / f64::from(STEPS));
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
