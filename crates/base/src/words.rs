//! Numbers and commands as words for readers.

use std::fmt::{Display, Formatter, Result};

/// A number of bytes in units of 1000, such as "1.5 GB". It is written without allocating memory.
#[derive(Clone, Copy, Debug)]
pub struct Size(pub u64);

impl Display for Size {
    fn fmt(&self, to: &mut Formatter<'_>) -> Result {
        let Self(bytes) = *self;
        let mut value = bytes as f64;
        for unit in ["B", "kB", "MB", "GB", "TB", "PB"] {
            // A larger number would be written with four digits before the point.
            if value < 999.95 {
                let decimals = usize::from(unit != "B");
                return write!(to, "{value:.decimals$} {unit}");
            }
            value /= 1000.0;
        }
        write!(to, "{value:.1} EB")
    }
}

/// Whole digits in groups of three, with `space` between them.
pub fn grouped(digits: &str, space: char) -> String {
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(space);
        }
        text.push(digit);
    }
    text
}

/// A number of things, whose plural ends in an s.
pub fn counted(count: u64, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// A command as a line for a shell: words are quoted where necessary.
pub fn command<W: AsRef<str>>(words: impl IntoIterator<Item = W>) -> String {
    let words = words.into_iter().map(|word| quoted(word.as_ref()));
    words.collect::<Vec<_>>().join(" ")
}

fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./,=:+%@".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_a_unit() {
        let numbers = [0, 999, 1000, 999_949, 999_950, 1_500_000_000, u64::MAX];
        let words = ["0 B", "999 B", "1.0 kB", "999.9 kB", "1.0 MB", "1.5 GB", "18.4 EB"];
        assert_eq!(numbers.map(|bytes| Size(bytes).to_string()), words);
    }

    #[test]
    fn a_shell_takes_each_word_for_one() {
        let words = ["a/b.json", "two words", "it's", "", "$x"];
        assert_eq!(command(words), r"a/b.json 'two words' 'it'\''s' '' '$x'");
    }
}
