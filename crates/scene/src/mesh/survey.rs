//! How much a mesh file holds, told without reading it into memory.
//!
//! A binary PLY tells it by its header and its length. Text is passed over once, block by block, and its words
//! are counted, not read: what they say is judged when the mesh is loaded. A file that breaks its format has a
//! survey all the same, of what its size allows.

use std::io::{BufRead, BufReader};
use std::path::Path;

use super::obj::survey as survey_obj;
use super::ply::survey as survey_ply;
use super::{Format, open};
use wavecrest_base::error::Result;

/// What a mesh holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Survey {
    /// Positions.
    pub positions: u64,
    /// Triangles, polygons divided.
    pub triangles: u64,
    /// Normals.
    pub normals: u64,
    /// Texture coordinates.
    pub uvs: u64,
    /// Whether corners have normals of their own numbers.
    pub normal_indices: bool,
    /// Whether corners have texture coordinates of their own numbers.
    pub uv_indices: bool,
}

/// How much of a text is in memory at once.
const BUFFER: usize = 1 << 17;

/// Bytes of a position, a normal or the three numbers of a triangle.
const TRIPLE: u64 = size_of::<[u32; 3]>() as u64;

/// Bytes of a pair of texture coordinates.
const PAIR: u64 = size_of::<[f32; 2]>() as u64;

impl Survey {
    /// Bytes of positions and triangles.
    pub fn prototype_bytes(&self) -> u64 {
        TRIPLE.saturating_mul(self.positions.saturating_add(self.triangles))
    }

    /// Bytes of normals.
    pub fn normal_bytes(&self) -> u64 {
        let indices = if self.normal_indices { self.triangles } else { 0 };
        TRIPLE.saturating_mul(self.normals.saturating_add(indices))
    }

    /// Bytes of texture coordinates.
    pub fn uv_bytes(&self) -> u64 {
        let indices = if self.uv_indices { self.triangles } else { 0 };
        PAIR.saturating_mul(self.uvs).saturating_add(TRIPLE.saturating_mul(indices))
    }

    /// Bytes of all that is held when the mesh has been read.
    pub fn bytes(&self) -> u64 {
        self.prototype_bytes().saturating_add(self.normal_bytes()).saturating_add(self.uv_bytes())
    }
}

/// What the mesh file at `path` holds.
///
/// # Errors
/// Where the system refuses, or a header does not say what there is.
pub fn survey(path: &Path) -> Result<Survey> {
    let format = Format::of(path)?;
    let (file, length) = open(path)?;
    let found = match format {
        Format::Ply => survey_ply(&file, length),
        Format::Obj => survey_obj(&file, length),
    };
    found.map_err(|error| error.in_file(path))
}

/// The number of words on each line of `text`, up to `lines` of them. What is longer than a buffer is
/// never in memory at once.
pub(super) fn words_of_lines(
    text: impl std::io::Read,
    lines: u64,
    mut each: impl FnMut(u64),
) -> std::io::Result<()> {
    let mut reader = BufReader::with_capacity(BUFFER, text);
    let (mut words, mut within, mut taken) = (0, false, 0);
    while taken < lines {
        let buffer = reader.fill_buf()?;
        if buffer.is_empty() {
            if words > 0 {
                each(words);
            }
            break;
        }
        let end = memchr::memchr(b'\n', buffer);
        let part = &buffer[..end.unwrap_or(buffer.len())];
        for byte in part {
            let blank = byte.is_ascii_whitespace();
            words += u64::from(!blank && !within);
            within = !blank;
        }
        let length = part.len() + usize::from(end.is_some());
        reader.consume(length);
        if end.is_some() {
            // A line without words is no row.
            if words > 0 {
                each(words);
                taken += 1;
            }
            (words, within) = (0, false);
        }
    }
    Ok(())
}
