//! Buffers, and the views into them that accessors and images use.

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use crate::format::Cursor;
use wavecrest_base::error::{Error, ErrorKind, Result};

use super::fields::Fields;
use super::uri::{self, Target};

/// A buffer: a range of bytes, which may be shared with the file itself.
#[derive(Clone, Debug)]
pub(super) struct Buffer {
    bytes: Arc<Vec<u8>>,
    range: Range<usize>,
}

impl Buffer {
    /// The bytes of `range` of a file.
    pub(super) fn part(bytes: Arc<Vec<u8>>, range: Range<usize>) -> Self {
        Self { bytes, range }
    }

    fn whole(bytes: Vec<u8>) -> Self {
        let range = 0..bytes.len();
        Self { bytes: Arc::new(bytes), range }
    }

    /// Reads an element of `buffers`. The first one without a URI is the `binary` chunk of a GLB
    /// file.
    pub(super) fn read(fields: &Fields<'_>, binary: Option<&Self>) -> Result<Self> {
        let length = fields.need_count("byteLength")?;
        let found = match (fields.get("uri"), binary) {
            (Some(uri), _) => Self::whole(match uri::target(&uri)? {
                Target::Bytes(bytes) => bytes,
                Target::File(path) => beginning(&uri, &path, length)?,
            }),
            (None, Some(binary)) => binary.clone(),
            (None, None) => {
                let error = fields.error("has no uri, and the file has no binary chunk");
                return Err(error.remedy("add a uri, or store the data in a GLB file"));
            }
        };
        found.cut(fields, length)
    }

    /// The first `length` bytes: those after them are padding.
    fn cut(mut self, fields: &Fields<'_>, length: u64) -> Result<Self> {
        match usize::try_from(length).ok().filter(|&length| length <= self.range.len()) {
            Some(length) => {
                self.range.end = self.range.start + length;
                Ok(self)
            }
            None => {
                let cursor = fields.need("byteLength", "a number of bytes")?;
                let error = cursor.error("the length of the buffer is wrong");
                let there = self.range.len();
                Err(error.remedy(format!("there are {there} bytes; check that its file is whole")))
            }
        }
    }

    /// Its bytes.
    pub(super) fn bytes(&self) -> &[u8] {
        self.bytes.get(self.range.clone()).unwrap_or(&[])
    }
}

/// The first `length` bytes of a file, or all if there are fewer.
fn beginning(uri: &Cursor<'_>, path: &Path, length: u64) -> Result<Vec<u8>> {
    let refused = |e: std::io::Error| {
        let message = format!("cannot read the buffer {}: {e}", path.display());
        let error = uri.error_of(ErrorKind::Io, message);
        error.remedy("put it beside the glTF file").because(e)
    };
    let metadata = path.metadata().map_err(refused)?;
    // The length of a pipe or a device is meaningless, and opening one can block.
    if !metadata.is_file() {
        let message = format!("{} is not a regular file", path.display());
        return Err(uri.error_of(ErrorKind::Io, message).remedy("name a file"));
    }
    uri.notes().reads(path);
    let mut bytes = Vec::new();
    File::open(path).map_err(refused)?.take(length).read_to_end(&mut bytes).map_err(refused)?;
    Ok(bytes)
}

/// A part of a buffer.
#[derive(Clone, Debug)]
pub(super) struct View {
    buffer: usize,
    range: Range<usize>,
    /// Bytes from one element to the next, if the view states them.
    pub(super) stride: Option<usize>,
}

impl View {
    /// Reads an element of `bufferViews`.
    pub(super) fn read(fields: &Fields<'_>, buffers: &[Buffer]) -> Result<Self> {
        let buffer = fields.need_index("buffer", "buffers", buffers.len())?;
        let offset = fields.count("byteOffset")?.unwrap_or(0);
        let length = fields.need_count("byteLength")?;
        let there = buffers[buffer].bytes().len();
        // Both are at most 2^53.
        let Some(range) = within(offset, length, there) else {
            let end = offset + length;
            return Err(fields
                .error(format!("ends at byte {end}, past the end of the buffer at {there}"))
                .remedy("check that the file is whole, or export it again"));
        };
        let stride = fields.count("byteStride")?.map(|stride| checked_stride(fields, stride));
        Ok(Self { buffer, range, stride: stride.transpose()? })
    }

    /// Its bytes.
    pub(super) fn bytes<'b>(&self, buffers: &'b [Buffer]) -> &'b [u8] {
        buffers.get(self.buffer).and_then(|b| b.bytes().get(self.range.clone())).unwrap_or(&[])
    }

    /// How many bytes it has.
    pub(super) fn len(&self) -> usize {
        self.range.len()
    }
}

/// The format's largest stride.
const GREATEST_STRIDE: u64 = 252;

fn checked_stride(fields: &Fields<'_>, stride: u64) -> Result<usize> {
    match usize::try_from(stride) {
        Ok(stride) if (1..=GREATEST_STRIDE).contains(&(stride as u64)) => Ok(stride),
        _ => {
            let cursor = fields.need("byteStride", "a number of bytes")?;
            Err(cursor.error(format!("must be a whole number from 4 to {GREATEST_STRIDE}")))
        }
    }
}

/// `length` bytes from `offset` on, if `there` are that many.
fn within(offset: u64, length: u64, there: usize) -> Option<Range<usize>> {
    let end = usize::try_from(offset.checked_add(length)?).ok()?;
    (end <= there).then_some(end - usize::try_from(length).ok()?..end)
}

/// An error in the file of `cursor` without a value to show.
pub(super) fn missing_bytes(fields: &Fields<'_>, needed: u128, there: usize) -> Error {
    fields
        .error(format!("needs {needed} bytes of a buffer view that has {there}"))
        .remedy("check that the file is whole, or export it again")
}
