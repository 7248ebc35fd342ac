//! The font of drawings: text widths.
//!
//! They are those of Noto Sans, written down here, so that the layout is the same everywhere. A browser may use
//! another font for an SVG, so every text has some spare room.

/// The size, in the units of [`ASCII`].
const EM: f64 = 2048.0;

/// The widths of the letters from the space to the tilde, a row for 16 of them.
#[rustfmt::skip]
const ASCII: [u16; 95] = [
    532, 551, 836, 1323, 1171, 1702, 1499, 461, 614, 614, 1128, 1171, 549, 659, 549, 762,
    1171, 1171, 1171, 1171, 1171, 1171, 1171, 1171, 1171, 1171, 549, 549, 1171, 1171, 1171, 889,
    1841, 1309, 1331, 1294, 1495, 1139, 1063, 1491, 1518, 694, 559, 1268, 1073, 1858, 1556, 1599,
    1239, 1599, 1274, 1124, 1139, 1497, 1229, 1905, 1200, 1159, 1171, 674, 762, 674, 1171, 909,
    1188, 1149, 1260, 983, 1260, 1155, 705, 1260, 1266, 528, 528, 1094, 528, 1915, 1266, 1239,
    1260, 1260, 846, 981, 739, 1266, 1040, 1610, 1083, 1044, 963, 778, 1128, 778, 1171,
];

/// The width of `text`, where `size` is the em.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(|letter| size * f64::from(advance(letter)) / EM).sum()
}

/// The width of a letter.
fn advance(letter: char) -> u16 {
    let ascii = (letter as usize).checked_sub(' ' as usize).and_then(|place| ASCII.get(place));
    ascii.copied().unwrap_or(match letter {
        // Unbroken and narrow spaces.
        '\u{a0}' => 532,
        '\u{202f}' => 410,
        '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' | '⁻' => 717,
        '−' | '×' | '±' => 1171,
        'µ' => 1276,
        '–' => 1024,
        '…' => 1620,
        // Most scripts from here on are written in squares.
        '\u{1100}'.. => 2048,
        // The mean of Cyrillic letters, which are wider than Greek ones and those with accents.
        _ => 1372,
    })
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
    fn every_letter_has_a_width() {
        for [narrow, wide] in [['i', '0'], ['0', 'M'], ['⁻', '−'], ['\u{202f}', ' '], ['é', '漢']]
        {
            assert!(advance(narrow) < advance(wide), "{narrow:?} {wide:?}");
        }
        // The first and the last of a row, and of all.
        assert_eq!(width(" /0mo~", 2048.0), 532.0 + 762.0 + 1171.0 + 1915.0 + 1239.0 + 1171.0);
        assert_eq!(width("0m~", 2048.0), 1171.0 + 1915.0 + 1171.0);
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
