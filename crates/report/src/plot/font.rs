//! The font of drawings: text widths and outlines.
//!
//! Noto Sans, under the SIL Open Font License, is built in, so that the layout is the same
//! everywhere. A browser may use another font for an SVG, so every text has some spare room.

use std::sync::OnceLock;

use tiny_skia::{Path, PathBuilder, Transform};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// The font, parsed once.
fn face() -> Option<&'static Face<'static>> {
    static FACE: OnceLock<Option<Face<'static>>> = OnceLock::new();
    FACE.get_or_init(|| Face::parse(notosans::REGULAR_TTF, 0).ok()).as_ref()
}

/// The width of a missing letter, as a share of the size.
const UNKNOWN: f64 = 0.6;

/// The width of `text`, where `size` is the em.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(|letter| size * Letter::of(letter).advance).sum()
}

/// The glyph of a letter, in shares of the size.
struct Letter {
    glyph: Option<GlyphId>,
    advance: f64,
    scale: f64,
    raised: f64,
}

impl Letter {
    fn of(letter: char) -> Self {
        let blank = |advance| Self { glyph: None, advance, scale: 1.0, raised: 0.0 };
        Self::scaled(letter, 1.0, 0.0).unwrap_or_else(|| match letter {
            // The font has superscript digits, but no superscript minus.
            '⁻' => Self::scaled('−', 0.6, 0.36).unwrap_or(blank(UNKNOWN)),
            // A narrow space is a third of the usual one.
            '\u{202f}' => blank(0.16),
            _ => blank(UNKNOWN),
        })
    }

    fn scaled(letter: char, scale: f64, raised: f64) -> Option<Self> {
        let face = face()?;
        let glyph = face.glyph_index(letter)?;
        let advance = f64::from(face.glyph_hor_advance(glyph)?) / f64::from(face.units_per_em());
        Some(Self { glyph: Some(glyph), advance: scale * advance, scale, raised })
    }
}

/// The outline of a text whose base line starts at `start`.
pub(super) fn outline(text: &str, size: f64, [mut x, y]: [f64; 2]) -> Option<Path> {
    let face = face()?;
    let mut path = PathBuilder::new();
    for letter in text.chars().map(Letter::of) {
        let mut outline = LetterOutline(PathBuilder::new());
        letter.glyph.map(|glyph| face.outline_glyph(glyph, &mut outline));
        // The font's y axis points up.
        let unit = (size * letter.scale / f64::from(face.units_per_em())) as f32;
        let [left, base] = [x, y - size * letter.raised].map(|at| at as f32);
        let place = Transform::from_row(unit, 0.0, 0.0, -unit, left, base);
        if let Some(outline) = outline.0.finish().and_then(|outline| outline.transform(place)) {
            path.push_path(&outline);
        }
        x += size * letter.advance;
    }
    path.finish()
}

/// The outline of a letter in the font's units.
struct LetterOutline(PathBuilder);

impl OutlineBuilder for LetterOutline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}

/// `text`, or its end after an ellipsis, no wider than `most`: the end of a path is more
/// informative than its start.
pub(super) fn shortened(text: &str, size: f64, most: f64) -> String {
    if width(text, size) <= most {
        return text.to_owned();
    }
    let starts = text.char_indices().map(|(at, _)| format!("…{}", &text[at..]));
    let mut fitting = starts.skip(1).filter(|rest| width(rest, size) <= most);
    fitting.next().unwrap_or_else(|| "…".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_numbers_are_written_with() {
        for letter in "0123456789⁰¹²³⁴⁵⁶⁷⁸⁹⁻−×.…µ()%/ abcXYZ".chars() {
            assert!(Letter::of(letter).glyph.is_some(), "{letter:?}");
        }
        assert!(width("\u{202f}", 10.0) < width(" ", 10.0));
    }

    #[test]
    fn widths_are_those_of_the_font() {
        // 1171 of 2048 units for every digit.
        assert_eq!(width("0123456789", 2048.0), 11710.0);
        assert_eq!(width("", 10.0), 0.0);
        assert!(width("W", 10.0) > width("i", 10.0));
    }

    #[test]
    fn text_is_made_to_fit() {
        assert_eq!(shortened("short", 10.0, 100.0), "short");
        let found = shortened("scenes/large/knot-of-ten-million.json", 10.0, 100.0);
        assert!(found.starts_with('…') && found.ends_with("million.json"), "{found}");
        assert!(width(&found, 10.0) <= 100.0);
        assert_eq!(shortened("much", 10.0, 1.0), "…");
    }
}
