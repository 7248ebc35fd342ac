//! How large a drawing is, and what stands around it.

use std::cell::RefCell;
use std::rc::Rc;

use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, TextStyle};

use super::font;
use super::paint::Paint;
use super::picture::{Drawn, Picture, STEPS, Sheet};

/// The size of labels, in pixels.
pub(super) const LABEL: f64 = 12.5;
/// The size of notes, in pixels.
pub(super) const NOTE: f64 = 11.0;
/// The size of a title, in pixels.
const TITLE: f64 = 17.0;
/// Space under a title, in pixels.
const UNDER_TITLE: f64 = 14.0;

/// How large a drawing is and whether it has to stand alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// Its width in pixels; the height follows from what is in it.
    pub width: f64,
    /// Whether it stands alone, with its title, its notes and its own paper.
    pub whole: bool,
}

/// The margin of a drawing that stands alone, in pixels.
const MARGIN: f64 = 20.0;

/// A drawing that stands alone: as wide as the others with its margins.
pub(super) const ALONE: Frame = Frame { width: 680.0, whole: true };
/// A drawing in a page.
pub(super) const WIDE: Frame = Frame { width: 720.0, whole: false };
/// A drawing in a page on a narrow screen.
pub(super) const NARROW: Frame = Frame { width: 340.0, whole: false };

/// Pixels in steps of the picture.
pub(super) fn pixels(pixels: f64) -> i32 {
    libm::round(pixels * f64::from(STEPS)) as i32
}

/// A text of this size in pixels, placed by its upper left corner.
pub(super) fn style(size: f64, paint: Paint) -> TextStyle<'static> {
    // plotters wants a name, and looks for no font.
    let font = ("sans-serif", f64::from(pixels(size))).into_font();
    let color = paint.color().to_backend_color();
    TextStyle { font, color, pos: Pos::new(HPos::Left, VPos::Top) }
}

impl Frame {
    /// The height of a field that nothing else decides, in pixels.
    pub(super) fn field_height(&self) -> f64 {
        if self.width < 500.0 { 230.0 } else { 330.0 }
    }

    /// An empty picture with room for so many pixels in height, and what is drawn on: all of it, or
    /// all but a margin.
    pub(super) fn sheet(&self, height: f64) -> Drawn<(Rc<RefCell<Picture>>, Sheet)> {
        let margin = if self.whole { MARGIN } else { 0.0 };
        let picture = Picture::new(self.width + 2.0 * margin, height + 2.0 * margin);
        let picture = Rc::new(RefCell::new(picture));
        let sheet = Sheet::from(&picture);
        if self.whole {
            sheet.fill(&Paint::Paper.color())?;
        }
        let margin = pixels(margin);
        Ok((picture, sheet.margin(margin, margin, margin, margin)))
    }

    /// The height of the title, if there is one.
    pub(super) fn title_height(&self) -> f64 {
        if self.whole { TITLE + UNDER_TITLE } else { 0.0 }
    }

    /// The title, for a drawing that stands alone.
    pub(super) fn title(&self, root: &Sheet, title: &str) -> Drawn {
        if !self.whole {
            return Ok(());
        }
        let title = font::shortened(title, TITLE, self.width);
        letter(root, &title, (0.0, 0.0), &style(TITLE, Paint::Ink))
    }

    /// Notes in lines that fit.
    pub(super) fn notes(&self, notes: &[String]) -> Vec<String> {
        notes.iter().flat_map(|note| font::wrapped(note, NOTE, self.width)).collect()
    }

    /// Writes lines of notes from `top` on, in pixels.
    pub(super) fn write_notes(&self, root: &Sheet, lines: &[String], top: f64) -> Drawn {
        let style = style(NOTE, Paint::Muted);
        lines.iter().enumerate().try_for_each(|(index, line)| {
            letter(root, line, (0.0, top + 1.5 * NOTE * index as f64), &style)
        })
    }
}

/// Writes a text at a place in pixels.
pub(super) fn letter(root: &Sheet, text: &str, (x, y): (f64, f64), style: &TextStyle<'_>) -> Drawn {
    root.draw_text(text, style, (pixels(x), pixels(y)))
}
