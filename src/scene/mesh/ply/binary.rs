//! The body of a PLY file in binary numbers of either byte order.
//!
//! Files of many millions of triangles are nearly always of one form: little-endian, vertices of
//! three floats, faces of a byte and three 32-bit integers. The vertices of such a file are read
//! straight into their array; its faces are taken from the reader's buffer, where a row of constant
//! length needs no test but of its first byte and of its indices. Other rows without lists are
//! taken column by column from a block that stays in the cache.

use std::io::{BufRead, Read as _};

use super::header::Scalar;
use super::layout::{Column, ListLayout, VertexLayout};
use super::source::{Fault, Source, Vertices};

/// How many bytes of rows are taken apart at once.
const BLOCK: usize = 1 << 16;

/// A packed triangle: its number of corners and their indices.
const TRIANGLE: usize = 13;

/// A binary body; `BIG` for big-endian.
#[derive(Debug)]
pub(super) struct Binary<R, const BIG: bool> {
    reader: R,
    left: u64,
}

impl<R: BufRead, const BIG: bool> Binary<R, BIG> {
    /// The body of `left` bytes.
    pub(super) fn new(reader: R, left: u64) -> Self {
        Self { reader, left }
    }

    fn read_into(&mut self, to: &mut [u8]) -> Result<(), Fault> {
        let length = to.len() as u64;
        if length > self.left {
            return Err(Fault::End);
        }
        self.reader.read_exact(to)?;
        self.left -= length;
        Ok(())
    }

    /// The next `N` bytes, the least significant first.
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let mut bytes = [0; N];
        self.read_into(&mut bytes)?;
        if BIG {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// Reads rows of `stride` bytes, block by block.
    fn rows(
        &mut self,
        columns: &[Column],
        stride: usize,
        into: &mut Vertices,
    ) -> Result<(), Fault> {
        let count = into.positions.len();
        let per_block = (BLOCK / stride).max(1);
        let mut block = vec![0; per_block.min(count) * stride];
        for first in (0..count).step_by(per_block) {
            let rows = &mut block[..per_block.min(count - first) * stride];
            self.read_into(rows)?;
            columns.iter().for_each(|c| take_column::<BIG>(rows, stride, *c, first, into));
        }
        Ok(())
    }
}

/// `N` bytes of a row from `offset` on, the least significant first.
fn part<const N: usize, const BIG: bool>(row: &[u8], offset: usize) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.copy_from_slice(&row[offset..offset + N]);
    if BIG {
        bytes.reverse();
    }
    bytes
}

/// Takes one column out of `rows`. The type is looked at once, not in every row.
fn take_column<const BIG: bool>(
    rows: &[u8],
    stride: usize,
    Column { slot, kind, offset, scale }: Column,
    first: usize,
    into: &mut Vertices,
) {
    let rows = rows.chunks_exact(stride);
    macro_rules! fill {
        ($number:ty) => {
            into.fill(
                first,
                slot,
                rows.map(|row| {
                    <$number>::from_le_bytes(part::<_, BIG>(row, offset)) as f32 * scale
                }),
            )
        };
    }
    match kind {
        Scalar::I8 => fill!(i8),
        Scalar::U8 => fill!(u8),
        Scalar::I16 => fill!(i16),
        Scalar::U16 => fill!(u16),
        Scalar::I32 => fill!(i32),
        Scalar::U32 => fill!(u32),
        Scalar::F32 => fill!(f32),
        Scalar::F64 => fill!(f64),
    }
}

impl<R: BufRead, const BIG: bool> Source for Binary<R, BIG> {
    fn value(&mut self, kind: Scalar) -> Result<f64, Fault> {
        Ok(match kind {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.bytes()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.bytes()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.bytes()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.bytes()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.bytes()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.bytes()?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.bytes()?)),
            Scalar::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    fn skip(&mut self, kind: Scalar, count: u64) -> Result<(), Fault> {
        let length = self.least(kind, count);
        if length > self.left {
            return Err(Fault::End);
        }
        let skipped = std::io::copy(&mut (&mut self.reader).take(length), &mut std::io::sink())?;
        self.left -= skipped;
        if skipped == length { Ok(()) } else { Err(Fault::End) }
    }

    fn end_row(&mut self) -> Result<(), Fault> {
        Ok(())
    }

    fn left(&self) -> u64 {
        self.left
    }

    fn least(&self, kind: Scalar, count: u64) -> u64 {
        count.saturating_mul(kind.size() as u64)
    }

    fn trailing(&mut self) -> Result<u64, Fault> {
        Ok(self.left)
    }

    fn vertices(&mut self, layout: &VertexLayout, into: &mut Vertices) -> Result<bool, Fault> {
        let Some(stride) = layout.stride else { return Ok(false) };
        if layout.is_packed() && !BIG && cfg!(target_endian = "little") {
            self.read_into(bytemuck::cast_slice_mut(&mut into.positions))?;
        } else {
            let columns: Vec<Column> = layout.columns.iter().copied().flatten().collect();
            self.rows(&columns, stride, into)?;
        }
        Ok(true)
    }

    fn triangles(
        &mut self,
        layout: ListLayout,
        most: u64,
        vertices: usize,
        into: &mut Vec<[u32; 3]>,
    ) -> Result<u64, Fault> {
        if !layout.is_packed() {
            return Ok(0);
        }
        let before = into.len();
        let buffer = self.reader.fill_buf()?;
        let rows = buffer.as_chunks::<TRIANGLE>().0;
        let most = rows.len().min(usize::try_from(most).unwrap_or(usize::MAX));
        for row in &rows[..most] {
            let triangle = [1, 5, 9].map(|at| u32::from_le_bytes(part::<4, BIG>(row, at)));
            // A negative index reads as one that is too large.
            if row[0] != 3 || triangle.iter().any(|&i| i as usize >= vertices) {
                break;
            }
            into.push(triangle);
        }
        let count = into.len() - before;
        self.reader.consume(count * TRIANGLE);
        self.left = self.left.saturating_sub((count * TRIANGLE) as u64);
        Ok(count as u64)
    }
}
