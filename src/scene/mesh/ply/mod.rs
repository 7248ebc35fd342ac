//! Stanford PLY: a text header that declares elements and their properties, then the elements, as
//! text or as binary numbers of either byte order.
//!
//! Any header is followed: properties in any order and of any type, elements of any name. What a
//! mesh has no use for is passed over. [`header`] reads the declarations and [`layout`] finds in
//! them what a mesh needs; a [`source::Source`] yields the numbers of the body, from text
//! ([`ascii`]) or binary ([`binary`]); [`body`] walks the elements over any source, once. Rows of
//! numbers alone, and plain triangles, have short cuts in [`binary`] that run at about the speed of
//! a copy.
//!
//! No crate is used: those that read the format hand over every property of every row, where the
//! common form is better read as a block, and their errors do not name the element and its number.

mod ascii;
mod binary;
mod body;
mod header;
mod layout;
mod source;

use std::io::{BufRead, BufReader, Read as _};

use super::Read;
use crate::error::Result;
use header::Encoding;

/// How much of a body is in memory at once, besides the arrays made of it.
const BUFFER: usize = 1 << 20;

/// Reads a file of `length` bytes.
pub(super) fn read(file: std::fs::File, length: u64) -> Result<Read> {
    read_from(BufReader::with_capacity(BUFFER, file.take(length)), length)
}

fn read_from(mut reader: impl BufRead, length: u64) -> Result<Read> {
    let header = header::read(&mut reader)?;
    let left = length.saturating_sub(header.bytes);
    match header.encoding {
        Encoding::Ascii => body::read(&header, ascii::Ascii::new(reader, left, header.lines)),
        Encoding::LittleEndian => {
            body::read(&header, binary::Binary::<_, false>::new(reader, left))
        }
        Encoding::BigEndian => body::read(&header, binary::Binary::<_, true>::new(reader, left)),
    }
}

#[cfg(test)]
mod tests;
