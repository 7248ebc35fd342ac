//! The body of a PLY file in binary numbers of either byte order.
//!
//! Single numbers; [`vertices`] and [`faces`] read many rows of the common forms at once.

use std::io::{BufReader, Read as _};

use super::header::{Element, Scalar};
use super::layout::{ListLayout, VertexLayout};
use super::source::{Faces, Fault, Source, Vertices};
use super::{faces, vertices};
use crate::mesh::place::{ReadAt, Section};

/// A binary body; `BIG` for big-endian.
#[derive(Debug)]
pub(super) struct Binary<'a, F: ?Sized, const BIG: bool> {
    file: &'a F,
    /// Positioned at the next number.
    reader: BufReader<Section<'a, F>>,
    /// The end of the body.
    end: u64,
    left: u64,
}

impl<'a, F: ReadAt + ?Sized, const BIG: bool> Binary<'a, F, BIG> {
    /// The body of `left` bytes that ends at `end` of the `file`, and a reader of it.
    pub(super) fn new(file: &'a F, reader: BufReader<Section<'a, F>>, end: u64, left: u64) -> Self {
        Self { file, reader, end, left }
    }

    /// The next `N` bytes, the least significant first.
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let mut bytes = [0; N];
        if N as u64 > self.left {
            return Err(Fault::End);
        }
        self.reader.read_exact(&mut bytes)?;
        self.left -= N as u64;
        if BIG {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// The offset of the next number in the file.
    fn place(&self) -> u64 {
        self.end - self.left
    }

    /// Number of bytes that a thread reads at once.
    fn block(&self) -> usize {
        self.reader.capacity()
    }

    /// Skips bytes.
    fn advance(&mut self, bytes: u64) -> Result<(), Fault> {
        if bytes > self.left {
            return Err(Fault::End);
        }
        self.reader.seek_relative(bytes.cast_signed())?;
        self.left -= bytes;
        Ok(())
    }
}

impl<F: ReadAt + ?Sized, const BIG: bool> Source for Binary<'_, F, BIG> {
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
        self.advance(self.least(kind, count))
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

    fn vertices(&mut self, layout: &VertexLayout, into: &mut Vertices) -> Result<u64, Fault> {
        let block = self.block();
        let rows = vertices::read::<F, BIG>(self.file, self.place(), layout, block, into);
        self.advance((layout.stride.unwrap_or(0) * rows) as u64)?;
        Ok(rows as u64)
    }

    fn faces(
        &mut self,
        element: &Element,
        layout: ListLayout,
        vertices: usize,
        into: &mut Faces,
    ) -> Result<u64, Fault> {
        if !into.triangles.is_empty() {
            return Ok(0);
        }
        let (place, left, block) = (self.place(), self.left, self.block());
        let from = faces::Source { file: self.file, place, left, block };
        let read = faces::read::<F, BIG>(&from, element, layout, vertices, into);
        let (faces, bytes) = read.unwrap_or_default();
        self.advance(bytes)?;
        Ok(faces)
    }
}
