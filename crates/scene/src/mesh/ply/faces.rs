//! The faces of a PLY file, and binary ones with the same number of corners as the first read on
//! all threads.
//!
//! If other properties have constant length too, such rows have one length, and the offset of each
//! is known in advance. Whether all have the same number of corners shows only while reading: a row
//! that has not, or that is not a valid face, ends the fast path.

use glam::Vec2;
use rayon::prelude::*;

use super::header::{BodyEncoding, Element};
use super::layout::{ListLayout, stride};
use super::numbers::Numbers;
use crate::mesh::data::{MAX_COUNT, NamedMaterials};
use crate::mesh::place::{ReadAt, part};
use crate::mesh::polygon::Polygon;
use crate::mesh::scalar::{Scalar, with_type};
use wavecrest_base::error::Result;

/// The usual number of corners.
const TRIANGLE: usize = 3;

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
}

impl FaceArrays {
    /// Reads the first faces as long as they refer only to the first `vertices` vertices, and
    /// returns their number, possibly 0. An invalid face is left to be read again.
    pub(super) fn read(
        &mut self,
        element: &Element,
        layout: ListLayout,
        vertices: usize,
        from: &mut Numbers<'_>,
    ) -> Result<u64> {
        let is_textured = layout.uvs.is_some() || layout.texture.is_some();
        if from.block == 0 || is_textured || !self.triangles.is_empty() {
            return Ok(0);
        }
        let read = match from.encoding {
            BodyEncoding::BigEndian => read::<true>(from, element, layout, vertices, self),
            _ => read::<false>(from, element, layout, vertices, self),
        };
        let (faces, bytes) = read.unwrap_or_default();
        from.advance(bytes)?;
        Ok(faces)
    }
}

/// The layout of a row.
#[derive(Clone, Copy, Debug)]
struct FaceRow {
    stride: usize,
    /// The offset of the list.
    list: usize,
    corners: usize,
    /// The limit of indices, exclusive.
    limit: u32,
}

impl FaceRow {
    /// The layout of the first face, at `place`. `None` if rows vary in length even for equal lists
    /// of corners, if counts and indices are not integers, or if it is not a valid face.
    fn first<const BIG: bool>(
        file: &dyn ReadAt,
        place: u64,
        element: &Element,
        layout: ListLayout,
        vertices: usize,
    ) -> Option<Self> {
        let (before, rest) = element.properties.split_at_checked(layout.property)?;
        let list = stride(before)?;
        let after = stride(rest.get(1..)?)?;
        let size = layout.count.size();
        let mut count = [0; 4];
        file.read_exact_at(count.get_mut(..size)?, place + list as u64).ok()?;
        let corners = with_type!(layout.count, C => number::<{ size_of::<C>() }, BIG>(&count, 0));
        let is_face = corners >= TRIANGLE as u32 && corners <= layout.count.greatest()?;
        let corners = usize::try_from(corners).ok().filter(|_| is_face)?;
        let length = size.checked_add(corners.checked_mul(layout.item.size())?)?;
        let stride = length.checked_add(list + after)?;
        Some(Self { stride, list, corners, limit: limit(layout.item, vertices)? })
    }

    /// Number of triangles of a face.
    fn fan(self) -> usize {
        self.corners - 2
    }
}

/// The exclusive limit of an index of this type, read as unsigned: a negative number is then too
/// large.
fn limit(kind: Scalar, vertices: usize) -> Option<u32> {
    let beyond = u64::from(kind.greatest()?) + 1;
    // Both fit: there are fewer vertices than `u32::MAX`.
    Some(beyond.min(vertices as u64) as u32)
}

/// The number of `N` bytes at `offset`, read as unsigned.
#[inline(always)]
fn number<const N: usize, const BIG: bool>(row: &[u8], offset: usize) -> u32 {
    let mut bytes = [0; 4];
    bytes[..N].copy_from_slice(&part::<N, BIG>(row, offset));
    u32::from_le_bytes(bytes)
}

/// Reads all faces with as many corners as the first, up to the first other one. Returns the number
/// of faces and of bytes. `None` without a fast path: if rows have other types, or the file cannot
/// hold that many.
fn read<const BIG: bool>(
    from: &Numbers<'_>,
    element: &Element,
    layout: ListLayout,
    vertices: usize,
    into: &mut FaceArrays,
) -> Option<(u64, u64)> {
    let row = FaceRow::first::<BIG>(from.file, from.place(), element, layout, vertices)?;
    let triangles = element.count.checked_mul(row.fan() as u64)?;
    if (row.stride as u64).checked_mul(element.count)? > from.left || triangles > MAX_COUNT {
        return None;
    }
    // Sizes alone matter: there is one function for each pair of them.
    let decode: ReadRows = with_type!(layout.count, C => with_type!(layout.item, I => {
        decode::<{ size_of::<C>() }, { size_of::<I>() }, BIG>
    }));
    let (file, start) = (from.file, from.place());
    let count = usize::try_from(element.count).ok()?;
    into.triangles = vec![[0; 3]; triangles as usize];
    let per_task = (from.block / row.stride).max(1);
    let stops = into.triangles.par_chunks_mut(per_task * row.fan()).enumerate().map_init(
        Vec::new,
        |buffer: &mut Vec<u8>, (number, triangles)| {
            let (first, faces) = (number * per_task, triangles.len() / row.fan());
            buffer.resize(faces * row.stride, 0);
            let place = start + (first * row.stride) as u64;
            // Rows that cannot be read are read again number by number, which reports the error.
            let read = file.read_exact_at(buffer, place).is_ok();
            let good = if read { decode(buffer, row, triangles) } else { 0 };
            (good < faces).then_some(first + good)
        },
    );
    let good = stops.find_first(Option::is_some).flatten().unwrap_or(count);
    into.triangles.truncate(good * row.fan());
    if row.corners > TRIANGLE {
        // Triangles, and so the corners of a face, are fewer than 2^32.
        let polygon = |first| Polygon { first: first as u32, corners: row.corners as u32 };
        into.polygons = (0..into.triangles.len()).step_by(row.fan()).map(polygon).collect();
    }
    Some((good as u64, (good * row.stride) as u64))
}

/// Reads rows; returns the number of rows before the first that is not a valid face of this many
/// corners.
type ReadRows = fn(&[u8], FaceRow, &mut [[u32; 3]]) -> usize;

fn decode<const C: usize, const I: usize, const BIG: bool>(
    rows: &[u8],
    row: FaceRow,
    to: &mut [[u32; 3]],
) -> usize {
    // If a row is only a triangle's list, the compiler knows every offset.
    let packed = FaceRow { stride: C + TRIANGLE * I, list: 0, corners: TRIANGLE, ..row };
    if (row.stride, row.corners) == (packed.stride, packed.corners) {
        decode_rows::<C, I, BIG>(rows, packed, to)
    } else {
        decode_rows::<C, I, BIG>(rows, row, to)
    }
}

#[inline(always)]
fn decode_rows<const C: usize, const I: usize, const BIG: bool>(
    rows: &[u8],
    row: FaceRow,
    to: &mut [[u32; 3]],
) -> usize {
    let is_good = |(to, bytes): (&mut [[u32; 3]], &[u8])| {
        let greatest = fan::<I, BIG>(&bytes[row.list + C..], to);
        (number::<C, BIG>(bytes, row.list) == row.corners as u32) & (greatest < row.limit)
    };
    let faces = to.len() / row.fan();
    let both = to.chunks_exact_mut(row.fan()).zip(rows.chunks_exact(row.stride));
    if both.map(is_good).fold(true, |all, good| all & good) {
        return faces;
    }
    let mut both = to.chunks_exact_mut(row.fan()).zip(rows.chunks_exact(row.stride));
    both.position(|face| !is_good(face)).unwrap_or(faces)
}

/// Writes the triangles of a face; returns the largest index.
#[inline(always)]
fn fan<const N: usize, const BIG: bool>(items: &[u8], to: &mut [[u32; 3]]) -> u32 {
    let index = |i: usize| number::<N, BIG>(items, i * N);
    let (first, mut before) = (index(0), index(1));
    let mut greatest = first.max(before);
    for (i, to) in (2..).zip(to) {
        let next = index(i);
        *to = [first, before, next];
        greatest = greatest.max(next);
        before = next;
    }
    greatest
}
