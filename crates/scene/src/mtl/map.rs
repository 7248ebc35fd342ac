//! Maps: the name of an image after options.

use std::collections::BTreeSet;

/// An image that a material names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Map {
    /// As in the file.
    pub(super) name: String,
    /// Whether coordinates outside 0 to 1 are clamped to the edge.
    pub(super) clamp: bool,
}

/// The options, with the largest number of words after each. Offset, scale and turbulence may have
/// fewer.
const OPTIONS: [(&str, usize); 14] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-bm", 1),
    ("-boost", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-colorspace", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-texres", 1),
    ("-type", 1),
];

impl Map {
    /// Reads the text after `map_Kd`; `None` if it names no image. Options without effect are added
    /// to `skipped`.
    pub(super) fn read(text: &str, skipped: &mut BTreeSet<String>) -> Option<Self> {
        let mut clamp = false;
        let mut rest = text;
        while let Some((option, most, after)) = option(rest) {
            rest = after;
            let mut first = None;
            for taken in 0..most {
                let (word, after) = word(rest)?;
                // The second and third number may be missing.
                if taken > 0 && most == 3 && word.parse::<f64>().is_err() {
                    break;
                }
                first.get_or_insert(word);
                rest = after;
            }
            match option {
                "-clamp" => clamp = first.is_some_and(|word| word.eq_ignore_ascii_case("on")),
                _ => {
                    skipped.insert(option.to_owned());
                }
            }
        }
        let name = without_options(rest, skipped);
        (!name.is_empty()).then(|| Self { name: name.to_owned(), clamp })
    }
}

/// The option at the start of a text, the number of words that may follow it, and the text after
/// it.
fn option(text: &str) -> Option<(&'static str, usize, &str)> {
    let (first, rest) = word(text)?;
    let (name, most) = OPTIONS.iter().find(|(name, _)| first.eq_ignore_ascii_case(name))?;
    Some((name, *most, rest))
}

/// The first word of a text, and the text after it.
fn word(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_start();
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    (end > 0).then(|| text.split_at(end))
}

/// A name that may contain blanks, up to an option that some programs write after it.
fn without_options<'a>(text: &'a str, skipped: &mut BTreeSet<String>) -> &'a str {
    let found =
        OPTIONS.iter().filter_map(|(name, _)| Some((text.find(&format!(" {name} "))?, name)));
    let Some((end, option)) = found.min() else { return text.trim() };
    skipped.insert((*option).to_owned());
    text[..end].trim()
}
