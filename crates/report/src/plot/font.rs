//! The font of drawings: text widths.
//!
//! Noto Sans, under the SIL Open Font License, is built in, so that the layout is the same
//! everywhere. A browser may use another font for an SVG, so every text has some spare room.

use std::sync::OnceLock;

use ttf_parser::Face;

/// The font, parsed once.
fn face() -> Option<&'static Face<'static>> {
    static FACE: OnceLock<Option<Face<'static>>> = OnceLock::new();
    FACE.get_or_init(|| Face::parse(notosans::REGULAR_TTF, 0).ok()).as_ref()
}

/// The width of a missing letter, as a share of the size.
const UNKNOWN: f64 = 0.6;

/// The width of `text`, where `size` is the em.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(|letter| size * advance(letter)).sum()
}

/// The width of a letter, as a share of the size.
fn advance(letter: char) -> f64 {
    own_advance(letter).unwrap_or_else(|| match letter {
        // The font has superscript digits, but no superscript minus.
        '⁻' => 0.6 * own_advance('−').unwrap_or(UNKNOWN),
        // A narrow space is a third of the usual one.
        '\u{202f}' => 0.16,
        _ => UNKNOWN,
    })
}

/// The width of a letter that the font has.
fn own_advance(letter: char) -> Option<f64> {
    let face = face()?;
    let advance = face.glyph_hor_advance(face.glyph_index(letter)?)?;
    Some(f64::from(advance) / f64::from(face.units_per_em()))
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
        for letter in "0123456789⁰¹²³⁴⁵⁶⁷⁸⁹−×.…µ()%/ abcXYZ".chars() {
            assert!(own_advance(letter).is_some(), "{letter:?}");
        }
        assert!(width("⁻", 10.0) < width("−", 10.0));
        assert!(width("\u{202f}", 10.0) < width(" ", 10.0));
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
