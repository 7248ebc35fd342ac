//! A drawing as a list of shapes, from which SVG and PNG are written. Coordinates are pixels, y downward.

use super::font;
use super::paint::Paint;

/// A point of a drawing.
pub(super) type At = [f64; 2];

/// The size of labels.
pub(super) const LABEL: f64 = 12.5;
/// The size of notes.
pub(super) const NOTE: f64 = 11.0;
/// The size of a title.
const TITLE: f64 = 17.0;
/// Distance from the top of a title to the content below.
const TITLE_HEIGHT: f64 = TITLE + 14.0;
/// The margin of a standalone drawing.
const MARGIN: f64 = 20.0;

/// Distances from a point to the base line of text below it, beside it and above it, as shares of
/// its size: capitals and digits of Noto Sans are 0.714 em high, and descenders reach 0.24 em
/// below.
pub(super) const BELOW: f64 = 0.8;
pub(super) const BESIDE: f64 = 0.357;
pub(super) const ABOVE: f64 = -0.24;

/// The width of a drawing and its context.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// Its width; the height follows from the content.
    pub width: f64,
    /// Whether it is a separate file, with title, notes, background and a margin outside its width.
    pub standalone: bool,
}

impl Frame {
    /// A file: as wide as in a page, plus its margins.
    pub(super) const FILE: Self = Self { width: 680.0, standalone: true };
    /// A drawing in a page.
    pub(super) const WIDE: Self = Self { width: 720.0, standalone: false };
    /// A drawing in a page on a narrow screen.
    pub(super) const NARROW: Self = Self { width: 340.0, standalone: false };
}

/// One shape.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// A line along points.
    Line { points: Vec<At>, paint: Paint, width: f64, dashed: bool },
    /// The inside of a polygon.
    Area { points: Vec<At>, paint: Paint },
    /// A disk.
    Disk { center: At, radius: f64, paint: Paint },
    /// A text.
    Text(Text),
    /// Starts a mark, which extends to [`Shape::End`].
    Begin(Mark),
    /// Ends the mark.
    End,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Text {
    pub text: String,
    /// A point on its base line.
    pub at: At,
    /// The part of it at the point: 0 for its start, 1 for its end. It stays there if a browser
    /// uses a wider font.
    pub anchor: f64,
    /// The em.
    pub size: f64,
    pub paint: Paint,
    /// Whether an outline in the background colour separates it from lines below.
    pub rim: bool,
}

impl Text {
    /// A text at a point: `anchor` is the part of it at the point, and `line` one of [`BELOW`],
    /// [`BESIDE`] and [`ABOVE`].
    pub(super) fn new(text: &str, [x, y]: At, [anchor, line]: [f64; 2], size: f64) -> Self {
        let (text, at) = (text.to_owned(), [x, y + line * size]);
        Self { text, at, anchor, size, paint: Paint::Muted, rim: false }
    }

    /// In the most prominent paint.
    pub(super) fn in_ink(self) -> Self {
        Self { paint: Paint::Ink, ..self }
    }

    /// With an outline in the background colour.
    pub(super) fn with_rim(self) -> Self {
        Self { rim: true, ..self }
    }

    /// Its width in the built-in font.
    pub(super) fn width(&self) -> f64 {
        font::width(&self.text, self.size)
    }
}

/// The meaning of a group of shapes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Mark {
    /// In words, a line each.
    pub title: String,
    /// Its figures to the last digit, as in CSV: names and values.
    pub figures: Vec<(&'static str, String)>,
    /// Its centre, if it is small: a nearby pointer selects it.
    pub near: Option<At>,
}

/// The list.
#[derive(Clone, Debug)]
pub(crate) struct Drawing {
    pub(super) frame: Frame,
    /// Its height so far.
    pub(super) height: f64,
    pub(super) shapes: Vec<Shape>,
}

impl Drawing {
    /// A drawing that starts with its title, if the frame shows it.
    pub(super) fn new(title: &str, frame: Frame) -> Self {
        let mut drawing = Self { frame, height: 0.0, shapes: Vec::new() };
        if frame.standalone {
            let title = font::shortened(title, TITLE, frame.width);
            drawing.text(Text::new(&title, [0.0; 2], [0.0, BELOW], TITLE).in_ink());
            drawing.height = TITLE_HEIGHT;
        }
        drawing
    }

    /// The margin around it.
    pub(super) fn margin(&self) -> f64 {
        if self.frame.standalone { MARGIN } else { 0.0 }
    }

    /// Width and height with the margin.
    pub(super) fn size(&self) -> [f64; 2] {
        [self.frame.width, self.height].map(|side| side + 2.0 * self.margin())
    }

    /// Adds a line.
    pub(super) fn line(&mut self, points: Vec<At>, paint: Paint, width: f64) {
        self.shapes.push(Shape::Line { points, paint, width, dashed: false });
    }

    /// Adds a text.
    pub(super) fn text(&mut self, text: Text) {
        self.shapes.push(Shape::Text(text));
    }

    /// Adds notes at the bottom, if the frame shows them.
    pub(super) fn notes(&mut self, notes: &[String]) {
        if !self.frame.standalone {
            return;
        }
        let width = self.frame.width;
        for line in notes.iter().flat_map(|note| font::wrapped(note, NOTE, width)) {
            self.text(Text::new(&line, [0.0, self.height], [0.0, BELOW], NOTE));
            self.height += 1.5 * NOTE;
        }
    }
}
