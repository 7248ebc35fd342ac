//! The vertices of a PLY file.
//!
//! A block of rows is distributed to the arrays and its positions are checked while both are in
//! the cache of a thread. A row that was read number by number is a block of one row, of doubles.

use bytemuck::cast_slice_mut;
use glam::{DVec3, Vec2, Vec3};

use super::header::BodyEncoding;
use super::layout::{COLOR, NORMAL, NumberSource, UV, VertexLayout};
use super::numbers::Numbers;
use crate::mesh::origin::{origin, relative};
use crate::mesh::place::part;
use crate::mesh::scalar::{Scalar, with_type};
use crate::mesh::validate::{bad_position, is_good_position};
use wavecrest_base::error::Result;

/// The vertices while they are read. All rows exist from the start, as zeros.
#[derive(Debug, Default)]
pub(super) struct VertexArrays {
    /// Relative to the origin.
    pub(super) positions: Vec<Vec3>,
    pub(super) origin: DVec3,
    /// Empty if the file has none, as are the others.
    pub(super) normals: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) colors: Vec<Vec3>,
}

/// The numbers of some vertices in the four arrays.
type Destination<'a> = [&'a mut [f32]; 4];

impl VertexArrays {
    /// Keeps the first ones.
    pub(super) fn truncate(&mut self, count: usize) {
        self.positions.truncate(count);
        self.normals.truncate(count);
        self.uvs.truncate(count);
        self.colors.truncate(count);
    }

    /// Room for `count` vertices. The caller has checked the count against the size of the file.
    pub(super) fn new(count: usize, layout: &VertexLayout) -> Self {
        let of = |first: usize| layout.sources[first].map_or(0, |_| count);
        Self {
            // The system provides zeroed pages, first touched by the thread that fills them: `vec!`
            // would write each vector twice.
            positions: bytemuck::zeroed_vec(count),
            origin: DVec3::ZERO,
            normals: bytemuck::zeroed_vec(of(NORMAL)),
            uvs: bytemuck::zeroed_vec(of(UV)),
            colors: bytemuck::zeroed_vec(of(COLOR)),
        }
    }

    /// Stores vertex `index`, from the numbers of its row. The first one gives the origin.
    pub(super) fn set(
        &mut self,
        index: usize,
        layout: &VertexLayout,
        numbers: &[f64],
    ) -> Result<()> {
        // Numbers in memory have the byte order of the machine.
        const BIG: bool = cfg!(target_endian = "big");
        let row = bytemuck::cast_slice(numbers);
        if let (0, Some(point)) = (index, layout.double()) {
            self.origin = origin(self::point::<BIG>(row, point));
        }
        let origin = self.origin;
        let good = self.blocks(index, 1).map(|to| decode::<BIG>(layout, origin, row, to)).next();
        if good == Some(1) { Ok(()) } else { Err(bad_position(self.positions[index])) }
    }

    /// Reads the vertices after the first, up to the first block with an invalid position, and
    /// returns their number, possibly 0. An invalid vertex is left to be read again.
    pub(super) fn read(&mut self, layout: &VertexLayout, from: &mut Numbers<'_>) -> Result<u64> {
        let (count, origin) = (self.positions.len() as u64 - 1, self.origin);
        let Some(stride) = layout.stride else { return Ok(0) };
        let Some(at_once) = from.rows_at_once(stride, count) else { return Ok(0) };
        let is_big = from.encoding == BodyEncoding::BigEndian;
        let decode = if is_big { decode::<true> } else { decode::<false> };
        let blocks = self.blocks(1, at_once);
        from.blocks(stride, count, blocks, |rows, to| decode(layout, origin, rows, to))
    }

    /// The vertices from number `first` on, in blocks.
    fn blocks(&mut self, first: usize, rows: usize) -> impl Iterator<Item = Destination<'_>> {
        let mut blocks = [
            cast_slice_mut(&mut self.positions[first..]).chunks_mut(3 * rows),
            cast_slice_mut(self.normals.get_mut(first..).unwrap_or_default()).chunks_mut(3 * rows),
            cast_slice_mut(self.uvs.get_mut(first..).unwrap_or_default()).chunks_mut(2 * rows),
            cast_slice_mut(self.colors.get_mut(first..).unwrap_or_default()).chunks_mut(3 * rows),
        ];
        std::iter::from_fn(move || {
            let block = blocks.each_mut().map(|array| array.next().unwrap_or_default());
            (!block[0].is_empty()).then_some(block)
        })
    }
}

/// Stores a block of rows; returns their number, or 0 if a position is invalid.
fn decode<const BIG: bool>(
    layout: &VertexLayout,
    origin: DVec3,
    rows: &[u8],
    [positions, normals, uvs, colors]: Destination<'_>,
) -> usize {
    let stride = layout.stride.unwrap_or(rows.len());
    take::<3, BIG>(rows, stride, layout.sources(NORMAL), normals);
    take::<2, BIG>(rows, stride, layout.sources(UV), uvs);
    take::<3, BIG>(rows, stride, layout.sources(COLOR), colors);
    if let Some(columns) = layout.double() {
        let positions: &mut [Vec3] = cast_slice_mut(positions);
        for (to, row) in positions.iter_mut().zip(rows.chunks_exact(stride)) {
            *to = relative(point::<BIG>(row, columns), origin);
        }
    } else {
        take::<3, BIG>(rows, stride, layout.sources(0), positions);
    }
    let positions: &[Vec3] = bytemuck::cast_slice(positions);
    if positions.iter().all(|p| is_good_position(*p)) { positions.len() } else { 0 }
}

/// The position in a row, in double precision.
#[inline(always)]
fn point<const BIG: bool>(row: &[u8], columns: [NumberSource; 3]) -> DVec3 {
    DVec3::from(columns.map(|c| f64::from_le_bytes(part::<8, BIG>(row, c.offset))))
}

/// Copies `columns` of `rows` to vectors, if there are any.
#[allow(clippy::unnecessary_cast, reason = "one of the types is f32")]
fn take<const N: usize, const BIG: bool>(
    rows: &[u8],
    stride: usize,
    columns: Option<[NumberSource; N]>,
    to: &mut [f32],
) {
    let Some(columns) = columns else { return };
    let to = to.as_chunks_mut::<N>().0;
    // Nearly every file has floats, which are copied row by row.
    if columns.iter().all(|c| c.kind == Scalar::F32) {
        let offsets = columns.map(|c| c.offset);
        // If a row is only these, the compiler knows every offset.
        let (size, packed) = (size_of::<[f32; N]>(), std::array::from_fn(|i| i * size_of::<f32>()));
        return if (stride, offsets) == (size, packed) {
            take_floats::<N, BIG>(rows, size, packed, to)
        } else {
            take_floats::<N, BIG>(rows, stride, offsets, to)
        };
    }
    for (number, NumberSource { kind, offset, scale, .. }) in columns.into_iter().enumerate() {
        // The type is matched once, not for every row.
        with_type!(kind, T => for (to, row) in to.iter_mut().zip(rows.chunks_exact(stride)) {
            to[number] = T::from_le_bytes(part::<_, BIG>(row, offset)) as f32 * scale;
        });
    }
}

#[inline(always)]
fn take_floats<const N: usize, const BIG: bool>(
    rows: &[u8],
    stride: usize,
    offsets: [usize; N],
    to: &mut [[f32; N]],
) {
    for (to, row) in to.iter_mut().zip(rows.chunks_exact(stride)) {
        *to = offsets.map(|at| f32::from_le_bytes(part::<4, BIG>(row, at)));
    }
}
