//! Buffers, and the views into them that accessors and images use.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::format::Cursor;
use wavecrest_base::error::{ErrorKind, Result};

use super::fields::Fields;
use super::uri::{self, UriTarget};

/// A buffer: a range of bytes, which may be shared with the file itself.
#[derive(Clone, Debug)]
pub(super) struct Buffer {
    source: BufferSource,
    range: Range<usize>,
}

#[derive(Clone, Debug)]
enum BufferSource {
    Bytes(Arc<Vec<u8>>),
    /// A file that a survey does not read.
    Unread(PathBuf),
}

impl Buffer {
    /// The bytes of `range` of a file.
    pub(super) fn part(bytes: Arc<Vec<u8>>, range: Range<usize>) -> Self {
        Self { source: BufferSource::Bytes(bytes), range }
    }

    fn whole(bytes: Vec<u8>) -> Self {
        let range = 0..bytes.len();
        Self::part(Arc::new(bytes), range)
    }

    /// The bytes from `start` on of the file at `path`, which is not read.
    pub(super) fn unread(path: PathBuf, start: usize) -> Self {
        let regular = path.metadata().ok().filter(|metadata| metadata.is_file());
        let end =
            regular.map_or(0, |metadata| usize::try_from(metadata.len()).unwrap_or(usize::MAX));
        Self { source: BufferSource::Unread(path), range: start.min(end)..end }
    }

    /// How many bytes it has.
    pub(super) fn len(&self) -> usize {
        self.range.len()
    }

    /// Whether its bytes are read.
    pub(super) fn is_read(&self) -> bool {
        matches!(self.source, BufferSource::Bytes(_))
    }

    /// Its bytes; none if they are not read.
    fn bytes(&self) -> &[u8] {
        match &self.source {
            BufferSource::Bytes(bytes) => &bytes[self.range.clone()],
            BufferSource::Unread(_) => &[],
        }
    }

    /// Reads an element of `buffers`; its file only if it is `needed`. The first one without a URI
    /// is the `binary` chunk of a GLB file.
    pub(super) fn read(fields: &Fields<'_>, binary: Option<&Self>, needed: bool) -> Result<Self> {
        let length = fields.need_count("byteLength")?;
        let mut found = match (fields.get("uri"), binary) {
            (Some(uri), _) => match uri::target(&uri)? {
                UriTarget::Bytes(bytes) => Self::whole(bytes),
                UriTarget::File(path) if needed => Self::whole(beginning(&uri, &path, length)?),
                UriTarget::File(path) => Self::unread(path, 0),
            },
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
            return Err(
                error.remedy(format!("there are {there} bytes; check that its file is whole"))
            );
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
    // The length of a pipe or a device is meaningless, and opening one can block.
    if !path.metadata().map_err(refused)?.is_file() {
        let message = format!("{} is not a regular file", path.display());
        return Err(uri.error_of(ErrorKind::Io, message).remedy("name a file"));
    }
    uri.notes().reads(path);
    part(path, 0, length).map_err(refused)
}

/// `length` bytes of a file from `start` on, or fewer at its end.
fn part(path: &Path, start: u64, length: u64) -> io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    file.seek(SeekFrom::Start(start))?;
    let mut bytes = Vec::new();
    file.take(length).read_to_end(&mut bytes)?;
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

    /// Its bytes in its `buffer`; none if that is not read.
    pub(super) fn bytes<'b>(&self, buffer: &'b Buffer) -> &'b [u8] {
        buffer.bytes().get(self.range.clone()).unwrap_or(&[])
    }

    /// A copy of its bytes in its `buffer`, read now if that is not read and if they can be.
    pub(super) fn copied(&self, buffer: &Buffer) -> Arc<[u8]> {
        match &buffer.source {
            BufferSource::Unread(path) if !self.range.is_empty() => {
                let start = (buffer.range.start + self.range.start) as u64;
                part(path, start, self.range.len() as u64).unwrap_or_default().into()
            }
            _ => self.bytes(buffer).into(),
        }
    }
}

/// The format's largest stride.
const GREATEST_STRIDE: u64 = 252;

/// `length` bytes from `offset` on, if `there` are that many.
fn within(offset: u64, length: u64, there: usize) -> Option<Range<usize>> {
    let end = usize::try_from(offset.checked_add(length)?).ok()?;
    (end <= there).then_some(end - usize::try_from(length).ok()?..end)
}
