//! Names of series beside their markers, in as many rows as they need.

use plotters::element::Rectangle;
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::font;
use super::frame::{LABEL, pixels, style};
use super::marks::{Marker, Stroke};
use super::paint::Paint;
use super::picture::{Drawn, Sheet};

/// The height of a row, in pixels.
const ROW: f64 = 22.0;
/// From the sample to the name.
const GAP: f64 = 7.0;
/// From one entry to the next.
const BETWEEN: f64 = 22.0;
/// The width of a sample with a line.
const LINE: f64 = 24.0;
/// The width of a sample without.
const BLOCK: f64 = 12.0;
/// Space below the last row.
const BELOW: f64 = 6.0;

/// A name and how to know what has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry<'a> {
    pub name: &'a str,
    /// The series, or the stage of bars.
    pub index: usize,
    pub marker: bool,
    pub line: bool,
    /// Whether it is told by a block of colour instead.
    pub block: bool,
}

impl Entry<'_> {
    /// The width of its sample, in pixels.
    fn sample(&self) -> f64 {
        if self.line { LINE } else { BLOCK }
    }
}

/// Entries with their places.
pub(super) struct Legend<'a> {
    /// Each entry, where it begins, and its name as far as it fits.
    placed: Vec<(Entry<'a>, [f64; 2], String)>,
    rows: usize,
}

impl<'a> Legend<'a> {
    /// The entries in rows of this width, in pixels.
    pub(super) fn new(entries: &[Entry<'a>], width: f64) -> Self {
        let (mut x, mut rows) = (0.0, usize::from(!entries.is_empty()));
        let mut placed = Vec::new();
        for entry in entries {
            let sample = entry.sample();
            let name = font::shortened(entry.name, LABEL, width - sample - GAP);
            let wide = sample + GAP + font::width(&name, LABEL);
            if x > 0.0 && x + wide > width {
                (x, rows) = (0.0, rows + 1);
            }
            placed.push((*entry, [x, ROW * (rows as f64 - 0.5)], name));
            x += wide + BETWEEN;
        }
        Self { placed, rows }
    }

    /// The height of all rows, in pixels.
    pub(super) fn height(&self) -> f64 {
        if self.rows == 0 { 0.0 } else { ROW * self.rows as f64 + BELOW }
    }

    /// Draws it from `top` on, in pixels.
    pub(super) fn draw(&self, root: &Sheet, top: f64) -> Drawn {
        let style = style(LABEL, Paint::Ink).pos(Pos::new(HPos::Left, VPos::Center));
        for (entry, [x, y], name) in &self.placed {
            let (x, y, sample) = (pixels(*x), pixels(top + y), entry.sample());
            let middle = (x + pixels(sample / 2.0), y);
            if entry.block {
                let (half, color) = (pixels(BLOCK / 2.0), Paint::Series(entry.index).color());
                let corners = [(middle.0 - half, y - half), (middle.0 + half, y + half)];
                root.draw(&Rectangle::new(corners, color.filled()))?;
            }
            if entry.line {
                root.draw(&Stroke::of(entry.index, vec![(x, y), (x + pixels(sample), y)]))?;
            }
            if entry.marker {
                root.draw(&Marker { at: middle, index: entry.index, hollow: false })?;
            }
            root.draw_text(name, &style, (x + pixels(sample + GAP), y))?;
        }
        Ok(())
    }
}
