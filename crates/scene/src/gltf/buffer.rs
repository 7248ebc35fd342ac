//! Buffers, and the views into them that accessors and images use.

use std::io::{self, Read as _};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use crate::format::Cursor;
use wavecrest_base::error::{ErrorKind, Result};
use wavecrest_base::memory::Activity;
use wavecrest_base::read::open;

use super::fields::Fields;
use super::uri::{self, UriTarget};

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
        Self::part(Arc::new(bytes), range)
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes[self.range.clone()]
    }

    /// Reads an element of `buffers`. The first one without a URI is the `binary` chunk of a GLB file.
    pub(super) fn read(fields: &Fields<'_>, binary: Option<&Self>) -> Result<Self> {
        let length = fields.need_count("byteLength")?;
        let mut found = match (fields.get("uri"), binary) {
            (Some(uri), _) => Self::whole(match uri::target(&uri)? {
                UriTarget::Bytes(bytes) => bytes,
                UriTarget::File(path) => beginning(&uri, &path, length)?,
            }),
            (None, Some(binary)) => binary.clone(),
            (None, None) => {
                let error = fields.error("has no uri, and the file has no binary chunk");
                return Err(error.remedy("add a uri, or store the data in a GLB file"));
            }
        };
        // Bytes after these are padding.
        let there = found.range.len();
        let Some(range) = within(0, length, there) else {
            let error = fields.error_at("byteLength", "the length of the buffer is wrong");
            let remedy = format!("there are {there} bytes; check that its file is whole");
            return Err(error.remedy(remedy));
        };
        found.range.end = found.range.start + range.len();
        Ok(found)
    }
}

/// The first `length` bytes of a file, or all if there are fewer.
fn beginning(uri: &Cursor<'_>, path: &Path, length: u64) -> Result<Vec<u8>> {
    let refused = |e: io::Error| {
        let message = format!("cannot read the buffer {}: {e}", path.display());
        let error = uri.error_of(ErrorKind::Io, message);
        error.remedy("put it beside the glTF file").because(e)
    };
    let (file, _) = open(path).map_err(refused)?;
    uri.notes().reads(path);
    let _reading = Activity::new(format!("reading {}", path.display()));
    let mut bytes = Vec::new();
    file.take(length).read_to_end(&mut bytes).map_err(refused)?;
    Ok(bytes)
}

/// A part of a buffer.
#[derive(Clone, Debug)]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    pub(super) range: Range<usize>,
    /// Bytes from one element to the next, if the view states them.
    pub(super) stride: Option<usize>,
}

impl BufferView {
    /// Reads an element of `bufferViews`.
    pub(super) fn read(fields: &Fields<'_>, buffers: &[Buffer]) -> Result<Self> {
        let buffer = fields.need_index("buffer", "buffers")?;
        let offset = fields.offset()?;
        let length = fields.need_count("byteLength")?;
        let there = buffers[buffer].range.len();
        // Both are at most 2^53.
        let Some(range) = within(offset, length, there) else {
            let end = offset + length;
            return Err(fields
                .error(format!("ends at byte {end}, past the end of the buffer at {there}"))
                .remedy("check that the file is whole, or export it again"));
        };
        let stride = fields.count("byteStride")?;
        if stride.is_some_and(|stride| !(1..=GREATEST_STRIDE).contains(&stride)) {
            let message = format!("must be a whole number from 4 to {GREATEST_STRIDE}");
            return Err(fields.error_at("byteStride", message));
        }
        Ok(Self { buffer, range, stride: stride.map(|stride| stride as usize) })
    }
}

/// The format's largest stride.
const GREATEST_STRIDE: u64 = 252;

/// `length` bytes from `offset` on, if `there` are that many.
fn within(offset: u64, length: u64, there: usize) -> Option<Range<usize>> {
    let end = usize::try_from(offset.checked_add(length)?).ok()?;
    (end <= there).then_some(end - usize::try_from(length).ok()?..end)
}
