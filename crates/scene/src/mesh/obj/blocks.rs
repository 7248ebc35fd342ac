//! The text in blocks of whole statements, and blocks in pieces.

use super::lines::{first_end, last_end};
use crate::mesh::faults::read_failure;
use crate::mesh::place::{ReadAt, fill};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Largest part of the text in memory at once, unless a statement is longer.
pub(super) const BLOCK_BYTES: usize = 1 << 24;

/// Approximate text for each task.
pub(super) const PIECE_BYTES: usize = 1 << 17;

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
        return Err(Error::new(ErrorKind::Syntax, "the text is UTF-16 or binary")
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
