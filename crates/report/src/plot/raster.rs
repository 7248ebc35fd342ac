//! A picture as a PNG.
//!
//! tiny-skia fills and strokes without vector instructions of any machine, so that every machine makes
//! the same pixels.

use std::io::Write;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use plotters_backend::BackendCoord;
use tiny_skia::{
    FillRule, LineJoin, Paint as Brush, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};
use ttf_parser::OutlineBuilder;

use super::font;
use super::paint::Paint;
use super::picture::{Ink, Lettering, Picture, STEPS, Shape};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The widest drawing, in pixels.
const WIDEST: u32 = 16_384;

/// Writes the picture, so many pixels wide.
pub(super) fn write(picture: &Picture, width: u32, sink: &mut impl Write) -> Result<()> {
    let [wide, high] = picture.size.map(f64::from);
    let scale = f64::from(width) / wide;
    let height = libm::ceil(high * scale) as u32;
    let pixmap = Pixmap::new(width, height).filter(|_| width.max(height) <= WIDEST);
    let Some(mut pixmap) = pixmap else {
        return Err(Error::new(ErrorKind::Limit, "a drawing cannot be made so wide")
            .value(width)
            .remedy(format!("use a width from 1 to {WIDEST} pixels, so that its height is too")));
    };
    pixmap.fill(color(Ink::full(Paint::Paper)));
    let mut canvas = Canvas { pixmap, scale: scale as f32 };
    picture.shapes.iter().for_each(|shape| canvas.draw(shape));
    let opaque = canvas.pixmap.data().chunks_exact(4);
    let bytes: Vec<u8> = opaque.flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    PngEncoder::new_with_quality(sink, CompressionType::Best, FilterType::Adaptive)
        .write_image(&bytes, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| Error::new(ErrorKind::Io, format!("cannot write the drawing: {e}")).because(e))
}

struct Canvas {
    pixmap: Pixmap,
    /// Pixels in a step.
    scale: f32,
}

impl Canvas {
    fn draw(&mut self, shape: &Shape) {
        match shape {
            Shape::Line { points, ink, width, dashed } => {
                self.stroke(polygon(points, false), *ink, *width as f32, *dashed);
            }
            Shape::Area { points, ink } => self.fill(polygon(points, true), *ink),
            Shape::Disk { center, radius, ink } => self.fill(circle(*center, *radius), *ink),
            Shape::Ring { center, radius, ink, width } => {
                self.stroke(circle(*center, *radius), *ink, *width as f32, false);
            }
            Shape::Text(lettering) => self.letter(lettering),
            Shape::Begin(_) | Shape::End => {}
        }
    }

    fn fill(&mut self, path: Option<Path>, ink: Ink) {
        let Some(path) = path else { return };
        let (brush, scale) = (brush(ink), self.transform());
        self.pixmap.fill_path(&path, &brush, FillRule::Winding, scale, None);
    }

    fn stroke(&mut self, path: Option<Path>, ink: Ink, width: f32, dashed: bool) {
        let Some(path) = path else { return };
        let steps = STEPS as f32;
        let dash = if dashed { StrokeDash::new(vec![6.0 * steps, 4.0 * steps], 0.0) } else { None };
        let stroke = Stroke { width, dash, line_join: LineJoin::Round, ..Stroke::default() };
        let (brush, scale) = (brush(ink), self.transform());
        self.pixmap.stroke_path(&path, &brush, &stroke, scale, None);
    }

    fn transform(&self) -> Transform {
        Transform::from_scale(self.scale, self.scale)
    }

    fn letter(&mut self, lettering: &Lettering) {
        let Lettering { text, at, size, ink, rim, .. } = lettering;
        let mut outline = Outline::default();
        font::outlines(text, *size, &mut outline, |outline, [x, up], unit| {
            (outline.x, outline.y) = ((at[0] + x) as f32, (at[1] - up) as f32);
            outline.unit = unit as f32;
        });
        let path = outline.path.finish();
        if *rim {
            self.stroke(path.clone(), Ink::full(Paint::Paper), 4.0 * STEPS as f32, false);
        }
        self.fill(path, *ink);
    }
}

fn brush(ink: Ink) -> Brush<'static> {
    let mut brush = Brush { anti_alias: true, ..Brush::default() };
    brush.set_color(color(ink));
    brush
}

fn color(ink: Ink) -> tiny_skia::Color {
    let [r, g, b] = ink.paint.rgb();
    tiny_skia::Color::from_rgba8(r, g, b, libm::round(255.0 * ink.alpha) as u8)
}

fn polygon(points: &[BackendCoord], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (index, &(x, y)) in points.iter().enumerate() {
        let (x, y) = (x as f32, y as f32);
        if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    if closed {
        path.close();
    }
    path.finish()
}

fn circle((x, y): BackendCoord, radius: u32) -> Option<Path> {
    PathBuilder::from_circle(x as f32, y as f32, radius as f32)
}

/// Outlines of letters as a path.
struct Outline {
    path: PathBuilder,
    /// Where the letter begins on the base line, and the size of the font's unit.
    x: f32,
    y: f32,
    unit: f32,
}

impl Default for Outline {
    fn default() -> Self {
        Self { path: PathBuilder::new(), x: 0.0, y: 0.0, unit: 1.0 }
    }
}

impl Outline {
    fn place(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + self.unit * x, self.y - self.unit * y)
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.place(x1, y1), self.place(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2)) = (self.place(x1, y1), self.place(x2, y2));
        let (x, y) = self.place(x, y);
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
