//! The numbers of a PLY body, one after another, however they are written.

use glam::{Vec2, Vec3};

use super::header::{Property, Scalar};
use super::layout::{ListLayout, VertexLayout};

/// Why a number could not be had.
#[derive(Debug)]
pub(super) enum Fault {
    /// The file ends before it, or inside it.
    End,
    /// This is no number.
    Malformed(String),
    /// A row of text goes on after its last value.
    LongRow,
    /// The system failed.
    Io(std::io::Error),
}

impl From<std::io::Error> for Fault {
    /// A file can shrink while it is read: that too is an end.
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => Self::End,
            _ => Self::Io(error),
        }
    }
}

/// A body that is being read.
pub(super) trait Source {
    /// The next number, which is of the type `kind`. `f64` holds every value of every type.
    fn value(&mut self, kind: Scalar) -> Result<f64, Fault>;

    /// Passes over `count` numbers of the type `kind`.
    fn skip(&mut self, kind: Scalar, count: u64) -> Result<(), Fault>;

    /// Marks the end of a row.
    fn end_row(&mut self) -> Result<(), Fault>;

    /// How many bytes of the file are not read yet.
    fn left(&self) -> u64;

    /// The fewest bytes that `count` numbers of the type `kind` can take.
    fn least(&self, kind: Scalar, count: u64) -> u64;

    /// How many bytes remain that mean something, at the end of the body.
    fn trailing(&mut self) -> Result<u64, Fault>;

    /// The line being read, in a text.
    fn line(&self) -> Option<u64> {
        None
    }

    /// Reads all vertices at once, if this source can do so for such rows; else reads nothing and
    /// returns false.
    fn vertices(&mut self, _: &VertexLayout, _: &mut Vertices) -> Result<bool, Fault> {
        Ok(false)
    }

    /// Reads some of the next `most` faces, as long as they are triangles of the first `vertices`
    /// vertices, and returns how many: perhaps none. A face at fault is left to be read again.
    fn triangles(
        &mut self,
        _layout: ListLayout,
        _most: u64,
        _vertices: usize,
        _into: &mut Vec<[u32; 3]>,
    ) -> Result<u64, Fault> {
        Ok(0)
    }

    /// The fewest bytes that a row of these properties can take: its lists may be empty.
    fn least_row(&self, properties: &[Property]) -> u64 {
        use super::header::Shape;
        let least = |p: &Property| match p.shape {
            Shape::One(kind) | Shape::List { count: kind, .. } => self.least(kind, 1),
        };
        properties.iter().map(least).sum()
    }
}

/// The vertices that are being filled in. All rows are there from the start, as zeros.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    pub(super) positions: Vec<Vec3>,
    /// Empty if the file has none.
    pub(super) normals: Vec<Vec3>,
    /// Empty if the file has none.
    pub(super) uvs: Vec<Vec2>,
}

impl Vertices {
    /// Room for `count` vertices. The caller has held the count against the size of the file.
    pub(super) fn new(count: usize, layout: &VertexLayout) -> Self {
        Self {
            positions: vec![Vec3::ZERO; count],
            normals: vec![Vec3::ZERO; if layout.normals { count } else { 0 }],
            uvs: vec![Vec2::ZERO; if layout.uvs { count } else { 0 }],
        }
    }

    /// Fills the rows from `first` on of the column `slot`.
    pub(super) fn fill(&mut self, first: usize, slot: usize, values: impl Iterator<Item = f32>) {
        match slot {
            0..3 => {
                self.positions[first..].iter_mut().zip(values).for_each(|(p, v)| p[slot] = v);
            }
            3..6 => {
                self.normals[first..].iter_mut().zip(values).for_each(|(n, v)| n[slot - 3] = v);
            }
            _ => self.uvs[first..].iter_mut().zip(values).for_each(|(t, v)| t[slot - 6] = v),
        }
    }
}
