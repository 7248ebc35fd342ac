//! The colours of a drawing, by purpose.
//!
//! These are the colours on white paper; `chart.css` has those on a dark background under the same
//! names.

/// The purpose of a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Paint {
    /// Prominent text.
    Ink,
    /// Text and marks in the background.
    Muted,
    /// Guide lines.
    Guide,
    /// Grid lines at the labels of an axis.
    Grid,
    /// Grid lines between them.
    Faint,
    /// The background.
    Paper,
    /// One of the series, counted from 0.
    Series(usize),
}

/// Number of distinct colours of series.
pub(super) const COLOURS: usize = 7;

/// Okabe and Ito's colours, in the order of their contrast to white. Their yellow has almost none
/// and is left out.
const SERIES: [(&str, [u8; 3]); COLOURS] = [
    ("s0", [0, 114, 178]),
    ("s1", [213, 94, 0]),
    ("s2", [0, 158, 115]),
    ("s3", [204, 121, 167]),
    ("s4", [0, 0, 0]),
    ("s5", [230, 159, 0]),
    ("s6", [86, 180, 233]),
];

impl Paint {
    /// Its name in style sheets, and the colour on white paper.
    pub(super) fn entry(self) -> (&'static str, [u8; 3]) {
        match self {
            Self::Ink => ("ink", [26, 28, 32]),
            Self::Muted => ("muted", [92, 97, 105]),
            Self::Guide => ("guide", [120, 125, 133]),
            Self::Grid => ("grid", [215, 218, 223]),
            Self::Faint => ("faint", [238, 239, 242]),
            Self::Paper => ("paper", [255, 255, 255]),
            Self::Series(index) => SERIES[index % COLOURS],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> impl Iterator<Item = Paint> {
        let others =
            [Paint::Ink, Paint::Muted, Paint::Guide, Paint::Grid, Paint::Faint, Paint::Paper];
        others.into_iter().chain((0..COLOURS).map(Paint::Series))
    }

    #[test]
    fn colours_begin_again_after_the_last() {
        assert_eq!(Paint::Series(COLOURS).entry().0, "s0");
    }

    #[test]
    fn the_style_sheet_knows_every_paint() {
        let css = include_str!("chart.css");
        for paint in all() {
            let name = paint.entry().0;
            let [r, g, b] = paint.entry().1;
            let light = format!("--{name}: light-dark(#{r:02x}{g:02x}{b:02x}, #");
            assert_eq!(css.matches(&light).count(), 1, "{light}");
            for (class, property) in [("f", "fill"), ("k", "stroke")] {
                let rule = format!(".{class}-{name} {{ {property}: var(--{name}); }}");
                assert_eq!(css.matches(&rule).count(), 1, "{rule}");
            }
        }
    }

    /// Web Content Accessibility Guidelines 2.2, "relative luminance" and "contrast ratio".
    fn contrast(a: [u8; 3], b: [u8; 3]) -> f64 {
        let luminance = |rgb: [u8; 3]| {
            let linear = rgb.map(|byte| {
                let c = f64::from(byte) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            });
            0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    /// The colour of this name on dark paper.
    fn dark(name: &str) -> [u8; 3] {
        let css = include_str!("chart.css");
        let both = css.split_once(&format!("--{name}: light-dark(")).unwrap().1;
        let rest = both.split_once(", #").unwrap().1;
        let byte = |at: usize| u8::from_str_radix(&rest[at..at + 2], 16).unwrap();
        [byte(0), byte(2), byte(4)]
    }

    #[test]
    fn text_and_series_stand_out_from_either_paper() {
        let papers = [Paint::Paper.entry().1, dark("paper")];
        for paint in [Paint::Ink, Paint::Muted] {
            let colours = [paint.entry().1, dark(paint.entry().0)];
            for (colour, paper) in colours.into_iter().zip(papers) {
                assert!(contrast(colour, paper) >= 4.5, "{paint:?} {}", contrast(colour, paper));
            }
        }
        for series in (0..COLOURS).map(Paint::Series) {
            let found = contrast(dark(series.entry().0), papers[1]);
            assert!(found >= 3.0, "{series:?} {found}");
        }
        // Okabe and Ito's colours are unchanged: the last two are for many series, which the
        // markers distinguish as well.
        for series in [0, 1, 2, 4].map(Paint::Series) {
            let found = contrast(series.entry().1, papers[0]);
            assert!(found >= 3.0, "{series:?} {found}");
        }
    }
}
