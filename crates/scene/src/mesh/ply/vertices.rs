//! The vertices of a PLY file, and binary rows of constant length read on all threads.
//!
//! Each thread reads the next block of rows into memory that stays in its cache, distributes it to
//! the arrays and checks the positions there. Rows of exactly three floats are read directly into
//! place.

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::header::BodyEncoding;
use super::layout::{COLOR, NORMAL, NumberSource, SLOTS, UV, VertexLayout};
use super::numbers::Numbers;
use crate::mesh::origin::{origin, relative};
use crate::mesh::place::{ReadAt, part};
use crate::mesh::scalar::{Scalar, with_type};
use crate::mesh::validate::is_good_position;
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

impl VertexArrays {
    /// Room for `count` vertices. The caller has checked the count against the size of the file.
    pub(super) fn new(count: usize, layout: &VertexLayout) -> Self {
        let of = |first| if layout.has(first) { count } else { 0 };
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

    /// Stores the `values` of vertex `row`, by slots.
    pub(super) fn set(&mut self, row: usize, layout: &VertexLayout, mut values: [f64; SLOTS]) {
        if layout.is_double {
            let point = DVec3::new(values[0], values[1], values[2]);
            if row == 0 {
                self.origin = origin(point);
            }
            values[..3].copy_from_slice(&(point - self.origin).to_array());
        }
        for &NumberSource { slot, scale, .. } in layout.columns.iter().flatten() {
            let value = values[slot] as f32 * scale;
            match slot {
                ..NORMAL => self.positions[row][slot] = value,
                NORMAL..UV => self.normals[row][slot - NORMAL] = value,
                UV..COLOR => self.uvs[row][slot - UV] = value,
                _ => self.colors[row][slot - COLOR] = value,
            }
        }
    }

    /// Reads the first rows, up to the first block with an invalid position, and returns their
    /// number, possibly 0. An invalid vertex is left to be read again.
    pub(super) fn read(&mut self, layout: &VertexLayout, from: &mut Numbers<'_>) -> Result<u64> {
        let Some(stride) = layout.stride.filter(|_| from.block > 0) else { return Ok(0) };
        let columns =
            [0..NORMAL, NORMAL..UV, UV..COLOR, COLOR..SLOTS].map(|slots| layout.slots(slots));
        let is_packed = layout.is_packed();
        let rows = VertexRows { stride, is_packed, is_double: layout.is_double, columns };
        let count = match from.encoding {
            BodyEncoding::BigEndian => rows.read_all::<true>(from, self),
            _ => rows.read_all::<false>(from, self),
        };
        from.advance((stride * count) as u64)?;
        Ok(count as u64)
    }
}

/// The layout of a row.
struct VertexRows {
    stride: usize,
    is_packed: bool,
    /// Whether positions are in double precision.
    is_double: bool,
    /// The columns of positions, normals, texture coordinates and colours: none if there are none.
    columns: [Vec<NumberSource>; 4],
}

/// A block of rows and its destination: the numbers of the four arrays.
struct RowBlock<'a> {
    first: usize,
    place: u64,
    arrays: [&'a mut [f32]; 4],
}

impl VertexRows {
    /// Reads blocks; returns the number of rows before the first block with an error, or of all.
    fn read_all<const BIG: bool>(&self, from: &Numbers<'_>, to: &mut VertexArrays) -> usize {
        let (count, place) = (to.positions.len(), from.place());
        if self.is_double && count > 0 {
            let mut first = vec![0; self.stride];
            if from.file.read_exact_at(&mut first, place).is_err() {
                return 0;
            }
            to.origin = origin(self.point::<BIG>(&first));
        }
        let (per_task, origin) = ((from.block / self.stride).max(1), to.origin);
        let mut chunks = [
            bytemuck::cast_slice_mut(&mut to.positions).chunks_mut(per_task * 3),
            bytemuck::cast_slice_mut(&mut to.normals).chunks_mut(per_task * 3),
            bytemuck::cast_slice_mut(&mut to.uvs).chunks_mut(per_task * 2),
            bytemuck::cast_slice_mut(&mut to.colors).chunks_mut(per_task * 3),
        ];
        let mut tasks: Vec<RowBlock> = (0..count)
            .step_by(per_task)
            .map(|first| RowBlock {
                first,
                place: place + (first * self.stride) as u64,
                arrays: chunks.each_mut().map(|chunks| chunks.next().unwrap_or_default()),
            })
            .collect();
        let stops = tasks.par_iter_mut().map_init(Vec::new, |buffer, task| {
            // Rows that cannot be read are read again number by number, which reports the error.
            let is_good = self.read::<BIG>(from.file, task, origin, buffer).is_ok()
                && bytemuck::cast_slice(task.arrays[0]).iter().all(|p| is_good_position(*p));
            (!is_good).then_some(task.first)
        });
        stops.find_first(Option::is_some).flatten().unwrap_or(count)
    }

    fn read<const BIG: bool>(
        &self,
        file: &dyn ReadAt,
        task: &mut RowBlock<'_>,
        origin: DVec3,
        buffer: &mut Vec<u8>,
    ) -> std::io::Result<()> {
        let [positions, ..] = &mut task.arrays;
        if self.is_packed {
            file.read_exact_at(bytemuck::cast_slice_mut(positions), task.place)?;
            if BIG != cfg!(target_endian = "big") {
                let numbers: &mut [u32] = bytemuck::cast_slice_mut(positions);
                numbers.iter_mut().for_each(|n| *n = n.swap_bytes());
            }
            return Ok(());
        }
        buffer.resize(positions.len() / 3 * self.stride, 0);
        file.read_exact_at(buffer, task.place)?;
        let mut from = 0;
        if self.is_double {
            let positions: &mut [Vec3] = bytemuck::cast_slice_mut(positions);
            for (to, row) in positions.iter_mut().zip(buffer.chunks_exact(self.stride)) {
                *to = relative(self.point::<BIG>(row), origin);
            }
            from = 1;
        }
        for (columns, to) in self.columns.iter().zip(&mut task.arrays).skip(from) {
            match columns[..] {
                [a, b, c] => take_columns::<3, BIG>(buffer, self.stride, [a, b, c], to),
                [a, b] => take_columns::<2, BIG>(buffer, self.stride, [a, b], to),
                _ => {}
            }
        }
        Ok(())
    }

    /// The position in a row, in double precision.
    #[inline(always)]
    fn point<const BIG: bool>(&self, row: &[u8]) -> DVec3 {
        let at =
            |axis: usize| f64::from_le_bytes(part::<8, BIG>(row, self.columns[0][axis].offset));
        DVec3::new(at(0), at(1), at(2))
    }
}

/// Copies `columns` of `rows` to vectors.
#[allow(clippy::unnecessary_cast, reason = "one of the types is f32")]
fn take_columns<const N: usize, const BIG: bool>(
    rows: &[u8],
    stride: usize,
    columns: [NumberSource; N],
    to: &mut [f32],
) {
    let rows = || rows.chunks_exact(stride);
    let to = to.as_chunks_mut::<N>().0;
    // Nearly every file has floats, which are copied row by row.
    if columns.iter().all(|c| c.kind == Scalar::F32) {
        let offsets = columns.map(|c| c.offset);
        for (to, row) in to.iter_mut().zip(rows()) {
            *to = offsets.map(|at| f32::from_le_bytes(part::<4, BIG>(row, at)));
        }
        return;
    }
    for (number, NumberSource { kind, offset, scale, .. }) in columns.into_iter().enumerate() {
        // The type is matched once, not for every row.
        with_type!(kind, T => for (to, row) in to.iter_mut().zip(rows()) {
            to[number] = T::from_le_bytes(part::<_, BIG>(row, offset)) as f32 * scale;
        });
    }
}
