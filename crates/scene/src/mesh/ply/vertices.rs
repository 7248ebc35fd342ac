//! Binary vertices with rows of constant length, read on all threads.
//!
//! Each thread reads the next block of rows into memory that stays in its cache, distributes it to
//! the arrays and checks the positions there. Rows of exactly three floats are read directly into
//! place.

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::header::Scalar;
use super::layout::{Column, VertexLayout};
use super::source::Vertices;
use crate::mesh::origin::{origin, relative};
use crate::mesh::place::ReadAt;
use crate::mesh::validate::is_good_position;

/// Reads rows from `place` on into `vertices`, which has room for them; a thread reads about
/// `block` bytes at once. Returns the number of rows before the first block with an error, or of
/// all.
pub(super) fn read<F: ReadAt + ?Sized, const BIG: bool>(
    file: &F,
    place: u64,
    layout: &VertexLayout,
    block: usize,
    vertices: &mut Vertices,
) -> usize {
    let Some(mut rows) = Rows::of(layout) else { return 0 };
    if layout.is_double() && !vertices.positions.is_empty() {
        let mut first = vec![0; rows.stride];
        if file.read_exact_at(&mut first, place).is_err() {
            return 0;
        }
        rows.origin = Some(origin(point::<BIG>(&first, &rows.position)));
        vertices.origin = rows.origin.unwrap_or_default();
    }
    let per_task = (block / rows.stride).max(1);
    let mut tasks = tasks(vertices, per_task, place, rows.stride);
    let stops = tasks.par_iter_mut().map_init(Vec::new, |buffer, task| {
        // Rows that cannot be read are read again number by number, which reports the error.
        let is_good = rows.read::<F, BIG>(file, task, buffer).is_ok()
            && task.positions.iter().all(|p| is_good_position(*p));
        (!is_good).then_some(task.first)
    });
    let stop = stops.find_first(Option::is_some).flatten();
    stop.unwrap_or(vertices.positions.len())
}

/// A block of rows and its destination.
struct Task<'a> {
    first: usize,
    place: u64,
    positions: &'a mut [Vec3],
    normals: &'a mut [Vec3],
    uvs: &'a mut [Vec2],
    colors: &'a mut [Vec3],
}

fn tasks(vertices: &mut Vertices, rows: usize, place: u64, stride: usize) -> Vec<Task<'_>> {
    let mut normals = vertices.normals.chunks_mut(rows);
    let mut uvs = vertices.uvs.chunks_mut(rows);
    let mut colors = vertices.colors.chunks_mut(rows);
    let task = |(number, positions)| Task {
        first: number * rows,
        place: place + (number * rows * stride) as u64,
        positions,
        normals: normals.next().unwrap_or_default(),
        uvs: uvs.next().unwrap_or_default(),
        colors: colors.next().unwrap_or_default(),
    };
    vertices.positions.chunks_mut(rows).enumerate().map(task).collect()
}

/// The layout of a row.
struct Rows {
    stride: usize,
    packed: bool,
    position: [Column; 3],
    /// If positions are in double precision.
    origin: Option<DVec3>,
    normal: Option<[Column; 3]>,
    uv: Option<[Column; 2]>,
    color: Option<[Column; 3]>,
}

impl Rows {
    fn of(layout: &VertexLayout) -> Option<Self> {
        Some(Self {
            stride: layout.stride?,
            packed: layout.is_packed(),
            position: layout.slots(0)?,
            origin: None,
            normal: layout.slots(3),
            uv: layout.slots(6),
            color: layout.slots(8),
        })
    }

    fn read<F: ReadAt + ?Sized, const BIG: bool>(
        &self,
        file: &F,
        task: &mut Task<'_>,
        buffer: &mut Vec<u8>,
    ) -> std::io::Result<()> {
        if self.packed {
            file.read_exact_at(bytemuck::cast_slice_mut(task.positions), task.place)?;
            to_native::<BIG>(task.positions);
        } else {
            buffer.resize(task.positions.len() * self.stride, 0);
            file.read_exact_at(buffer, task.place)?;
            self.take_apart::<BIG>(buffer, task);
        }
        Ok(())
    }

    fn take_apart<const BIG: bool>(&self, rows: &[u8], task: &mut Task<'_>) {
        if let Some(origin) = self.origin {
            for (to, row) in task.positions.iter_mut().zip(rows.chunks_exact(self.stride)) {
                *to = relative(point::<BIG>(row, &self.position), origin);
            }
        } else {
            take_columns::<_, 3, BIG>(rows, self.stride, &self.position, task.positions);
        }
        if let Some(columns) = &self.normal {
            take_columns::<_, 3, BIG>(rows, self.stride, columns, task.normals);
        }
        if let Some(columns) = &self.uv {
            take_columns::<_, 2, BIG>(rows, self.stride, columns, task.uvs);
        }
        if let Some(columns) = &self.color {
            take_columns::<_, 3, BIG>(rows, self.stride, columns, task.colors);
        }
    }
}

/// Converts numbers to the native byte order.
fn to_native<const BIG: bool>(positions: &mut [Vec3]) {
    if BIG != cfg!(target_endian = "big") {
        let numbers: &mut [u32] = bytemuck::cast_slice_mut(positions);
        numbers.iter_mut().for_each(|n| *n = n.swap_bytes());
    }
}

/// `N` bytes of a row from `offset` on, the least significant first.
#[inline(always)]
pub(super) fn part<const N: usize, const BIG: bool>(row: &[u8], offset: usize) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.copy_from_slice(&row[offset..offset + N]);
    if BIG {
        bytes.reverse();
    }
    bytes
}

/// The position in a row, in double precision.
#[inline(always)]
fn point<const BIG: bool>(row: &[u8], columns: &[Column; 3]) -> DVec3 {
    columns.map(|column| f64::from_le_bytes(part::<8, BIG>(row, column.offset))).into()
}

/// Copies `columns` of `rows` to vectors.
fn take_columns<T: AsMut<[f32; N]>, const N: usize, const BIG: bool>(
    rows: &[u8],
    stride: usize,
    columns: &[Column; N],
    to: &mut [T],
) {
    // Nearly every file has floats, which are copied row by row.
    if columns.iter().all(|c| c.kind == Scalar::F32) {
        let offsets = columns.map(|c| c.offset);
        for (to, row) in to.iter_mut().zip(rows.chunks_exact(stride)) {
            *to.as_mut() = offsets.map(|at| f32::from_le_bytes(part::<4, BIG>(row, at)));
        }
        return;
    }
    for (number, column) in columns.iter().enumerate() {
        take_column::<_, N, BIG>(rows, stride, *column, to, number);
    }
}

/// Copies one column of `rows`. The type is matched once, not for every row.
fn take_column<T: AsMut<[f32; N]>, const N: usize, const BIG: bool>(
    rows: &[u8],
    stride: usize,
    Column { kind, offset, scale, .. }: Column,
    to: &mut [T],
    number: usize,
) {
    macro_rules! take {
        ($type:ty) => {
            for (to, row) in to.iter_mut().zip(rows.chunks_exact(stride)) {
                let value = <$type>::from_le_bytes(part::<_, BIG>(row, offset));
                to.as_mut()[number] = value as f32 * scale;
            }
        };
    }
    match kind {
        Scalar::I8 => take!(i8),
        Scalar::U8 => take!(u8),
        Scalar::I16 => take!(i16),
        Scalar::U16 => take!(u16),
        Scalar::I32 => take!(i32),
        Scalar::U32 => take!(u32),
        Scalar::F32 => take!(f32),
        Scalar::F64 => take!(f64),
    }
}
