//! An OBJ text in blocks of whole statements, cut into pieces; its statements, and their words.
//!
//! A statement is a line, continued on the next if it ends in a backslash. That applies only to the
//! statements that are read: comments and names may end in a backslash too, as paths of folders,
//! and must not swallow the next line.

use crate::mesh::faults::{read_failure, syntax};
use crate::mesh::place::{ReadAt, fill};
use wavecrest_base::error::{Error, Result};

/// Largest part of the text in memory at once, unless a statement is longer.
pub(in crate::mesh) const BLOCK: usize = 1 << 24;

/// Passes the text to `take`, in blocks that end with a statement.
pub(super) fn each_block(
    file: &dyn ReadAt,
    length: u64,
    size: usize,
    mut take: impl FnMut(&[u8]) -> Result<()>,
) -> Result<()> {
    let mut text = Vec::new();
    let mut place = 0;
    loop {
        // The rest of the last block is the start of a statement.
        let begun = text.len();
        let read = (length - place).min(size as u64) as usize;
        text.resize(begun + read, 0);
        fill(file, place, &mut text[begun..]).map_err(read_failure)?;
        if place == 0 {
            check_encoding(&mut text)?;
        }
        place += read as u64;
        let end = if place == length { text.len() } else { last_end(&text) };
        take(&text[..end])?;
        if place == length {
            return Ok(());
        }
        text.drain(..end);
    }
}

/// Refuses UTF-16, in which every second byte is invalid here, and drops the byte order mark that
/// some programs put before UTF-8.
fn check_encoding(text: &mut Vec<u8>) -> Result<()> {
    let utf16 = matches!(text[..], [0xFE, 0xFF, ..] | [0xFF, 0xFE, ..])
        || text.iter().take(64).any(|&byte| byte == 0);
    if utf16 {
        return Err(syntax("the text is UTF-16 or binary")
            .at("line 1")
            .remedy("save the file as ASCII or UTF-8"));
    }
    if text.starts_with(&[0xEF, 0xBB, 0xBF]) {
        text.drain(..3);
    }
    Ok(())
}

/// Cuts a block into pieces of about `size` that end with a statement.
pub(super) fn cut(mut text: &[u8], size: usize) -> Vec<&[u8]> {
    let mut pieces = Vec::new();
    while !text.is_empty() {
        let (piece, rest) = text.split_at(first_end(text, size));
        pieces.push(piece);
        text = rest;
    }
    pieces
}

/// The supported statements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyword {
    Position,
    Uv,
    Normal,
    Face,
    /// Sets the material of the following faces.
    Material,
    /// Names files of materials.
    Library,
    /// Colours of vertices in a comment, as ZBrush writes them.
    Paint,
    /// Any other, or none.
    Other,
}

/// The statements that a backslash at the end of a line continues.
const LONG: [Keyword; 4] = [Keyword::Position, Keyword::Uv, Keyword::Normal, Keyword::Face];

/// A statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Statement<'a> {
    pub(super) keyword: Keyword,
    /// The text after the keyword, including inner line ends and backslashes.
    pub(super) rest: &'a [u8],
    /// Its number of lines.
    pub(super) lines: u64,
}

/// The statements of `text`.
pub(super) fn statements(mut text: &[u8]) -> impl Iterator<Item = Statement<'_>> {
    std::iter::from_fn(move || {
        if text.is_empty() {
            return None;
        }
        let (keyword, from) = keyword(text);
        let may_go_on = LONG.contains(&keyword);
        let (mut end, mut lines) = (0, 0);
        loop {
            let start = end;
            end += line_length(&text[start..]);
            lines += 1;
            let goes_on =
                may_go_on && ends_in_backslash(&text[..end]) && !text[start..end].contains(&b'#');
            if !goes_on || end == text.len() {
                break;
            }
        }
        let (statement, rest) = text.split_at(end);
        text = rest;
        Some(Statement { keyword, rest: &statement[from.min(end)..], lines })
    })
}

/// The length of the first line, including its end.
fn line_length(text: &[u8]) -> usize {
    memchr::memchr(b'\n', text).map_or(text.len(), |i| i + 1)
}

/// The keyword at the start of a line, and its end.
fn keyword(line: &[u8]) -> (Keyword, usize) {
    let start = line.iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
    let end = start + word_length(&line[start..]);
    let keyword = match &line[start..end] {
        b"v" => Keyword::Position,
        b"vt" => Keyword::Uv,
        b"vn" => Keyword::Normal,
        b"f" => Keyword::Face,
        b"usemtl" => Keyword::Material,
        b"mtllib" => Keyword::Library,
        b"#MRGB" => Keyword::Paint,
        _ => Keyword::Other,
    };
    (keyword, end)
}

fn ends_in_backslash(line: &[u8]) -> bool {
    matches!(line, [.., b'\\', b'\n'] | [.., b'\\', b'\r', b'\n'] | [.., b'\\'])
}

/// The rest of a line as a name, which may contain blanks.
pub(super) fn name(rest: &[u8]) -> String {
    String::from_utf8_lossy(rest.trim_ascii()).into_owned()
}

/// Separators between words, including a backslash at a line end inside a statement.
#[inline]
pub(super) fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r' | b'\\')
}

/// A statement's text from its first word on; `None` if it has only a comment or nothing.
#[inline]
pub(super) fn first_word(rest: &[u8]) -> Option<&[u8]> {
    let start = rest.iter().position(|&b| !is_blank(b))?;
    (rest[start] != b'#').then(|| &rest[start..])
}

/// The words of a statement; comments are not left out.
pub(super) fn words(rest: &[u8]) -> impl Iterator<Item = &[u8]> {
    rest.split(|&byte| is_blank(byte)).filter(|word| !word.is_empty())
}

/// The length of the word at the start of a text.
#[inline]
pub(super) fn word_length(text: &[u8]) -> usize {
    text.iter().position(|&b| is_blank(b)).unwrap_or(text.len())
}

/// The position after the last line end of `text` that surely ends a statement; 0 if there is none.
pub(super) fn last_end(text: &[u8]) -> usize {
    let mut end = text.len();
    loop {
        let Some(newline) = memchr::memrchr(b'\n', &text[..end]) else { return 0 };
        if !ends_in_backslash(&text[..=newline]) {
            return newline + 1;
        }
        end = newline;
    }
}

/// The position after the first line end of `text` at `from` or later that surely ends a statement.
pub(super) fn first_end(text: &[u8], from: usize) -> usize {
    let mut end = from.min(text.len());
    while end < text.len() {
        end += line_length(&text[end..]);
        if !ends_in_backslash(&text[..end]) {
            break;
        }
    }
    end
}

/// The error of a `word` that should be `what`.
pub(super) fn malformed(what: &str, word: &[u8], remedy: &str) -> Error {
    syntax(format!("{what} is malformed"))
        .value(format_args!("\"{}\"", String::from_utf8_lossy(word)))
        .remedy(remedy)
}
