//! The two formats of a glTF file: JSON as text, and GLB, which contains the JSON and one buffer.
//!
//! A GLB file is a header and chunks, each with a length and a type (glTF 2.0 specification,
//! section 4). Every length is checked against the file before it is used.

use std::ops::Range;

use wavecrest_base::error::{Error, ErrorKind, Result};

/// The first bytes of a GLB file.
pub(crate) const MAGIC: [u8; 4] = *b"glTF";
/// The type of the first chunk.
const JSON: [u8; 4] = *b"JSON";
/// The type of the chunk that is the first buffer.
const BIN: [u8; 4] = *b"BIN\0";

/// The header: magic, version, length of the file.
const HEADER_BYTES: usize = 12;
/// The header of a chunk: its length and its type.
const CHUNK_HEADER_BYTES: usize = 8;

/// The ranges of the JSON and of the binary chunk of a GLB file, if it has one.
pub(super) type GlbParts = (Range<usize>, Option<Range<usize>>);

/// Finds the parts of a file.
pub(super) fn parts(bytes: &[u8]) -> Result<GlbParts> {
    if bytes.is_empty() {
        return Err(broken("the file is empty").remedy("export it again"));
    }
    if bytes.starts_with(&MAGIC) {
        return glb(bytes);
    }
    // A byte order mark may come first.
    let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes).trim_ascii_start();
    if !matches!(text.first(), Some(b'{' | b'[')) {
        let error =
            broken("a file must begin with \"{\", as JSON does, or with \"glTF\", as GLB does");
        return Err(error.value(bytes[..bytes.len().min(MAGIC.len())].escape_ascii()));
    }
    Ok((0..bytes.len(), None))
}

fn glb(bytes: &[u8]) -> Result<GlbParts> {
    check_header(bytes)?;
    let (kind, json) = chunk(bytes, HEADER_BYTES)?;
    if kind != JSON {
        let error = broken("the first chunk of a GLB file must be of the type JSON");
        return Err(error.at(place(HEADER_BYTES)).value(kind.escape_ascii()));
    }
    let (mut binary, mut next) = (None, json.end);
    // Chunks of other types belong to later versions of the format and are skipped.
    while next < bytes.len() {
        let (kind, data) = chunk(bytes, next)?;
        next = data.end;
        if kind == BIN && binary.is_none() {
            binary = Some(data);
        }
    }
    Ok((json, binary))
}

fn check_header(bytes: &[u8]) -> Result<()> {
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(broken("the 12-byte header of the GLB file is cut off")
            .value(format_args!("{} bytes", bytes.len())));
    };
    if version != 2 {
        return Err(broken("only version 2 of GLB is read")
            .at(place(4))
            .value(version)
            .remedy("export it as glTF 2.0"));
    }
    if length as usize != bytes.len() {
        let message = "the length in the header is wrong";
        let found = format!("{length} for a file of {} bytes", bytes.len());
        return Err(broken(message).at(place(8)).value(found));
    }
    Ok(())
}

/// The type of the chunk whose header is at `start`, and the range of its data.
fn chunk(bytes: &[u8], start: usize) -> Result<([u8; 4], Range<usize>)> {
    let header = bytes.get(start..start + CHUNK_HEADER_BYTES);
    let (Some(length), Some(&[_, _, _, _, a, b, c, d])) = (word(bytes, start), header) else {
        return Err(broken("the file ends within the header of a chunk").at(place(start)));
    };
    let data = start + CHUNK_HEADER_BYTES;
    let left = bytes.len() - data;
    if length as usize > left {
        let found = format!("{length} bytes where {left} are left");
        return Err(broken("the chunk is longer than the file").at(place(start)).value(found));
    }
    Ok(([a, b, c, d], data..data + length as usize))
}

/// The little-endian number at an offset.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|bytes| u32::from_le_bytes(*bytes))
}

fn place(byte: usize) -> String {
    format!("byte {byte}")
}

fn broken(message: &str) -> Error {
    Error::new(ErrorKind::Syntax, message)
        .remedy("check that the file is whole, or export it again")
}
