//! A drawing as a list of shapes: the backend that plotters draws on.
//!
//! Coordinates are whole tenths of a pixel of the drawing, since plotters counts in whole numbers. A
//! picture keeps what a bitmap would forget: which shapes make up one mark, and what is told of it.

use std::convert::Infallible;

use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
};

use super::font;
use super::paint::Paint;

/// Steps of a coordinate in a pixel.
pub(super) const STEPS: i32 = 10;

/// What drawing through plotters gives.
pub(crate) type Drawn<T = ()> = Result<T, plotters::drawing::DrawingAreaErrorKind<Infallible>>;

/// A picture, or a part of it, as plotters draws on it in steps.
pub(super) type Sheet = plotters::drawing::DrawingArea<Picture, plotters::coord::Shift>;

/// What drawing on the backend itself gives.
pub(super) type OnBackend = Result<(), DrawingErrorKind<Infallible>>;

/// A paint and how much of it covers, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ink {
    pub paint: Paint,
    pub alpha: f64,
}

impl Ink {
    /// A paint that covers.
    pub(super) fn full(paint: Paint) -> Self {
        Self { paint, alpha: 1.0 }
    }
}

impl From<BackendColor> for Ink {
    fn from(color: BackendColor) -> Self {
        Self { paint: Paint::of(color.rgb), alpha: color.alpha }
    }
}

/// One shape; coordinates, widths and radii in steps.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// A line along points, perhaps dashed.
    Line { points: Vec<BackendCoord>, ink: Ink, width: u32, dashed: bool },
    /// The inside of a polygon.
    Area { points: Vec<BackendCoord>, ink: Ink },
    /// A disk.
    Disk { center: BackendCoord, radius: u32, ink: Ink },
    /// A ring.
    Ring { center: BackendCoord, radius: u32, ink: Ink, width: u32 },
    /// A text.
    Text(Lettering),
    /// The shapes from here to [`Shape::End`] are one mark.
    Begin(Mark),
    /// The mark ends.
    End,
}

/// A text in its place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lettering {
    pub text: String,
    /// Where its base line begins.
    pub at: [f64; 2],
    /// The height of a line's letters.
    pub size: f64,
    /// How wide it is.
    pub width: f64,
    /// Which part of it does not move if a browser's font is wider: 0 for its start, 1 for its end.
    pub fixed: f64,
    pub ink: Ink,
    /// Whether a rim of paper keeps it apart from lines below it.
    pub rim: bool,
}

/// What is told of a group of shapes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Mark {
    /// In words, a line each.
    pub told: String,
    /// Its figures to the last digit, as in CSV: names and values.
    pub figures: Vec<(&'static str, String)>,
    /// Where a pointer is near it, if it is small.
    pub near: Option<BackendCoord>,
}

/// The list.
#[derive(Clone, Debug, Default)]
pub(crate) struct Picture {
    /// Width and height in steps.
    pub size: [u32; 2],
    pub(super) shapes: Vec<Shape>,
    /// Whether lines are dashed from now on.
    pub dashed: bool,
}

impl Picture {
    /// An empty picture of so many pixels.
    pub(super) fn new(width: f64, height: f64) -> Self {
        let steps = |pixels: f64| (pixels * f64::from(STEPS)) as u32;
        Self { size: [steps(width), steps(height)], ..Self::default() }
    }

    /// Places a text by the point and the sides named.
    pub(super) fn letter(
        &mut self,
        text: &str,
        at: BackendCoord,
        (side, line): (HPos, VPos),
        size: f64,
        ink: Ink,
        rim: bool,
    ) {
        let width = font::width(text, size);
        let fixed = match side {
            HPos::Left => 0.0,
            HPos::Center => 0.5,
            HPos::Right => 1.0,
        };
        let x = f64::from(at.0) - fixed * width;
        // Of Noto Sans, capitals and digits are 0.714 em high, and tails reach 0.24 em below.
        let y = f64::from(at.1)
            + match line {
                VPos::Top => 0.8 * size,
                VPos::Center => 0.357 * size,
                VPos::Bottom => -0.24 * size,
            };
        let text = text.to_owned();
        self.shapes.push(Shape::Text(Lettering { text, at: [x, y], size, width, fixed, ink, rim }));
    }

    fn add(&mut self, shape: Shape) -> OnBackend {
        self.shapes.push(shape);
        Ok(())
    }
}

impl DrawingBackend for Picture {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size.into()
    }

    fn ensure_prepared(&mut self) -> OnBackend {
        Ok(())
    }

    fn present(&mut self) -> OnBackend {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> OnBackend {
        let points = vec![(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
        self.add(Shape::Area { points, ink: color.into() })
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> OnBackend {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (x0, y0): BackendCoord,
        (x1, y1): BackendCoord,
        style: &S,
        fill: bool,
    ) -> OnBackend {
        let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)];
        if fill {
            return self.fill_polygon(corners, style);
        }
        self.draw_path(corners.into_iter().chain([(x0, y0)]), style)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> OnBackend {
        let (ink, width, dashed) = (style.color().into(), style.stroke_width(), self.dashed);
        self.add(Shape::Line { points: path.into_iter().collect(), ink, width, dashed })
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> OnBackend {
        let (ink, width) = (style.color().into(), style.stroke_width());
        self.add(match fill {
            true => Shape::Disk { center, radius, ink },
            false => Shape::Ring { center, radius, ink, width },
        })
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> OnBackend {
        let ink = style.color().into();
        self.add(Shape::Area { points: corners.into_iter().collect(), ink })
    }

    fn draw_text<T: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &T,
        at: BackendCoord,
    ) -> OnBackend {
        let sides = (style.anchor().h_pos, style.anchor().v_pos);
        self.letter(text, at, sides, style.size(), style.color().into(), false);
        Ok(())
    }

    fn estimate_text_size<T: BackendTextStyle>(
        &self,
        text: &str,
        style: &T,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let size = style.size();
        Ok((font::width(text, size).ceil() as u32, size.ceil() as u32))
    }
}
