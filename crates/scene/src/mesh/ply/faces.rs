//! The faces and strips of a PLY file.
//!
//! Nearly every large file has triangles, as four-byte indices after a count in one byte: these rows
//! are read in blocks. A row that is another face, or an invalid one, ends that.

use glam::Vec2;

use super::header::{BodyEncoding, Element};
use super::layout::{ListLayout, stride};
use super::numbers::{Numbers, Row};
use crate::mesh::data::{NO_VALUE, NamedMaterials};
use crate::mesh::faults::check_count;
use crate::mesh::place::part;
use crate::mesh::polygon::{self, Polygon};
use crate::mesh::validate::bad_index;
use wavecrest_base::error::Result;

/// The faces so far.
#[derive(Debug, Default)]
pub(super) struct FaceArrays {
    pub(super) triangles: Vec<[u32; 3]>,
    /// The faces with more than three corners.
    pub(super) polygons: Vec<Polygon>,
    /// Texture coordinates of corners, if faces have them, and their numbers for each triangle.
    pub(super) uvs: Vec<Vec2>,
    pub(super) of_uvs: Vec<[u32; 3]>,
    /// The images of faces.
    pub(super) images: NamedMaterials,
    /// Number of faces with fewer than three corners.
    pub(super) too_few_corners: u64,
    /// The corners of the current face.
    corners: Vec<u32>,
}

impl FaceArrays {
    /// Adds the face or the strip of a row, which refers to the first `vertices` vertices.
    pub(super) fn push(&mut self, row: &Row, layout: ListLayout, vertices: usize) -> Result<()> {
        self.corners.clear();
        for &number in row.of(layout.property) {
            self.corners.push(corner(number, layout.is_strip, vertices)?);
        }
        if layout.is_strip {
            let strips = self.corners.split(|&i| i == STRIP_END);
            self.triangles.extend(strips.flat_map(strip_triangles));
            return Ok(());
        }
        let corners = self.corners.len();
        if corners < 3 {
            self.too_few_corners += 1;
            return Ok(());
        }
        let first = self.triangles.len() as u32;
        if corners > 3 {
            check_count("triangles", (self.triangles.len() + corners) as u64)?;
            self.polygons.push(Polygon { first, corners: corners as u32 });
        }
        self.begin_image(first, layout.texture.map_or(&[], |property| row.of(property)));
        self.triangles.extend(polygon::fan(&self.corners));
        layout.uvs.map_or(Ok(()), |property| self.push_uvs(row.of(property)))
    }

    /// Gives the faces from triangle `first` on the image with this number. A negative number is
    /// none; faces without one have the first image.
    fn begin_image(&mut self, first: u32, number: &[f64]) {
        let number = number.first().copied().unwrap_or_default();
        let image = if number < 0.0 { usize::MAX } else { number as usize };
        // No material has the name of none.
        let name = self.images.textures.get(image).map_or("", String::as_str);
        let is_other = self.images.runs.last().is_none_or(|(_, last)| last != name);
        if is_other && !self.images.textures.is_empty() {
            let name = name.to_owned();
            self.images.begin(first, &name);
        }
    }

    /// Adds the texture coordinates of the current face's corners.
    fn push_uvs(&mut self, numbers: &[f64]) -> Result<()> {
        let (corners, pairs) = (self.corners.len(), numbers.as_chunks::<2>().0);
        check_count("texture coordinates", (self.uvs.len() + corners) as u64)?;
        // A face without them has none at any corner.
        let is_whole = pairs.len() == corners;
        let own = (self.uvs.len() as u32..).take(corners);
        let own: Vec<u32> = own.map(|i| if is_whole { i } else { NO_VALUE }).collect();
        self.of_uvs.extend(polygon::fan(&own));
        let uvs = pairs.iter().filter(|_| is_whole);
        self.uvs.extend(uvs.map(|uv| Vec2::from(uv.map(|number| number as f32))));
        Ok(())
    }

    /// Reads the first faces as long as they are triangles that refer only to the first `vertices`
    /// vertices, and returns their number, possibly 0. An invalid face is left to be read again.
    pub(super) fn read(
        &mut self,
        layout: ListLayout,
        vertices: usize,
        from: &mut Numbers<'_>,
    ) -> Result<u64> {
        let Some(element) = from.element else { return Ok(0) };
        let row = TriangleRow::of(element, layout, vertices).filter(|_| self.triangles.is_empty());
        let Some(row) = row else { return Ok(0) };
        let Some(at_once) = from.rows_at_once(row.stride, element.count) else { return Ok(0) };
        let is_big = from.encoding == BodyEncoding::BigEndian;
        let decode = if is_big { decode::<true> } else { decode::<false> };
        self.triangles = vec![[0; 3]; element.count as usize];
        let blocks = self.triangles.chunks_mut(at_once);
        let read =
            from.blocks(row.stride, element.count, blocks, |rows, to| decode(rows, row, to))?;
        self.triangles.truncate(read as usize);
        Ok(read)
    }
}

/// In a strip's list: the end of the strip.
const STRIP_END: u32 = u32::MAX;

/// The corner of a face or of a strip, from its number.
fn corner(number: f64, is_strip: bool, vertices: usize) -> Result<u32> {
    match number {
        // -1, also if it was written as an unsigned number.
        -1.0 | 4_294_967_295.0 if is_strip => Ok(STRIP_END),
        _ if number >= 0.0 && number < vertices as f64 && number.fract() == 0.0 => {
            Ok(number as u32)
        }
        _ => Err(bad_index("vertex", number, vertices)),
    }
}

/// The triangles of a strip. Every second one is reversed, so that all face the same way; those
/// with a repeated corner only join parts of the strip.
fn strip_triangles(strip: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let turn = |(i, w): (usize, &[u32])| {
        if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] }
    };
    let plain = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    strip.windows(3).enumerate().map(turn).filter(plain)
}

/// The binary row of a triangle.
#[derive(Clone, Copy, Debug)]
struct TriangleRow {
    stride: usize,
    /// The offset of the list.
    list: usize,
    /// The exclusive limit of an index, read as unsigned: a negative number is then too large.
    limit: u32,
}

/// The size of a list of three corners, with its count.
const LIST: usize = 1 + 3 * size_of::<u32>();

impl TriangleRow {
    /// The row of triangles without images. `None` if it varies in length, or has other types.
    fn of(element: &Element, layout: ListLayout, vertices: usize) -> Option<Self> {
        let is_plain = !layout.is_strip && layout.uvs.is_none() && layout.texture.is_none();
        let is_usual = (layout.count.size(), layout.item.size()) == (1, size_of::<u32>());
        let greatest = layout.item.greatest().filter(|_| is_plain && is_usual)?;
        let (before, rest) = element.properties.split_at_checked(layout.property)?;
        let list = stride(before)?;
        // There are fewer vertices than `u32::MAX`.
        let limit = (vertices as u32).min(greatest.saturating_add(1));
        Some(Self { stride: list + LIST + stride(rest.get(1..)?)?, list, limit })
    }
}

/// Stores rows; returns the number of rows before the first that is not a valid triangle.
fn decode<const BIG: bool>(rows: &[u8], row: TriangleRow, to: &mut [[u32; 3]]) -> usize {
    // If a row is only the list, the compiler knows every offset.
    if row.stride == LIST {
        decode_rows::<BIG>(rows, TriangleRow { stride: LIST, list: 0, ..row }, to)
    } else {
        decode_rows::<BIG>(rows, row, to)
    }
}

#[inline(always)]
fn decode_rows<const BIG: bool>(rows: &[u8], row: TriangleRow, to: &mut [[u32; 3]]) -> usize {
    let is_good = |(to, bytes): (&mut [u32; 3], &[u8])| {
        let list = &bytes[row.list..row.list + LIST];
        *to = [1, 5, 9].map(|at| u32::from_le_bytes(part::<4, BIG>(list, at)));
        (list[0] == 3) & (to[0].max(to[1]).max(to[2]) < row.limit)
    };
    let both = to.iter_mut().zip(rows.chunks_exact(row.stride));
    if both.map(is_good).fold(true, |all, good| all & good) {
        return to.len();
    }
    let mut both = to.iter_mut().zip(rows.chunks_exact(row.stride));
    both.position(|face| !is_good(face)).unwrap_or(to.len())
}
