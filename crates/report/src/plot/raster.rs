//! A drawing as a PNG.
//!
//! tiny-skia fills and strokes without machine-specific instructions, so that every machine makes
//! the same pixels.

use std::io::Write;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use tiny_skia::{
    FillRule, LineJoin, Paint as Brush, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};

use super::drawing::{At, Drawing, Shape, Text};
use super::font;
use super::paint::Paint;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The widest drawing, in pixels.
const WIDEST: u32 = 16_384;

/// Writes the drawing with this width in pixels.
pub(super) fn write(drawing: &Drawing, width: u32, sink: &mut impl Write) -> Result<()> {
    let [wide, high] = drawing.size();
    let scale = f64::from(width) / wide;
    let height = libm::ceil(high * scale) as u32;
    let pixmap = Pixmap::new(width, height).filter(|_| width.max(height) <= WIDEST);
    let Some(mut pixmap) = pixmap else {
        return Err(Error::new(ErrorKind::Limit, "a drawing cannot be made so wide")
            .value(width)
            .remedy(format!("use a width from 1 to {WIDEST} pixels, so that its height is too")));
    };
    pixmap.fill(color(Paint::Paper));
    let (scale, margin) = (scale as f32, (drawing.margin() * scale) as f32);
    let transform = Transform::from_row(scale, 0.0, 0.0, scale, margin, margin);
    let mut canvas = Canvas { pixmap, transform };
    drawing.shapes.iter().for_each(|shape| canvas.draw(shape));
    let pixels = canvas.pixmap.data().chunks_exact(4);
    let bytes: Vec<u8> = pixels.flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    PngEncoder::new_with_quality(sink, CompressionType::Best, FilterType::Adaptive)
        .write_image(&bytes, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| Error::new(ErrorKind::Io, format!("cannot write the drawing: {e}")).because(e))
}

struct Canvas {
    pixmap: Pixmap,
    /// From coordinates of the drawing to pixels.
    transform: Transform,
}

impl Canvas {
    fn draw(&mut self, shape: &Shape) {
        match shape {
            Shape::Line { points, paint, width, dashed } => {
                let dash = dashed.then(|| StrokeDash::new(vec![6.0, 4.0], 0.0)).flatten();
                self.stroke(polygon(points, false), *paint, *width as f32, dash);
            }
            Shape::Area { points, paint } => self.fill(polygon(points, true), *paint),
            Shape::Disk { center: [x, y], radius, paint } => {
                let disk = PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32);
                self.fill(disk, *paint);
            }
            Shape::Text(text) => self.text(text),
            Shape::Begin(_) | Shape::End => {}
        }
    }

    fn fill(&mut self, path: Option<Path>, paint: Paint) {
        let Some(path) = path else { return };
        self.pixmap.fill_path(&path, &brush(paint), FillRule::Winding, self.transform, None);
    }

    fn stroke(&mut self, path: Option<Path>, paint: Paint, width: f32, dash: Option<StrokeDash>) {
        let Some(path) = path else { return };
        let stroke = Stroke { width, dash, line_join: LineJoin::Round, ..Stroke::default() };
        self.pixmap.stroke_path(&path, &brush(paint), &stroke, self.transform, None);
    }

    fn text(&mut self, text: &Text) {
        let start = [text.at[0] - text.anchor * text.width(), text.at[1]];
        let path = font::outline(&text.text, text.size, start);
        if text.rim {
            self.stroke(path.clone(), Paint::Paper, 4.0, None);
        }
        self.fill(path, text.paint);
    }
}

fn brush(paint: Paint) -> Brush<'static> {
    let mut brush = Brush { anti_alias: true, ..Brush::default() };
    brush.set_color(color(paint));
    brush
}

fn color(paint: Paint) -> tiny_skia::Color {
    let [r, g, b] = paint.rgb();
    tiny_skia::Color::from_rgba8(r, g, b, 255)
}

fn polygon(points: &[At], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (index, at) in points.iter().enumerate() {
        let [x, y] = at.map(|at| at as f32);
        if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    if closed {
        path.close();
    }
    path.finish()
}
