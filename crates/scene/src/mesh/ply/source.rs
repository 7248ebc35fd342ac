//! The numbers of a PLY body in sequence, in any encoding.

use glam::{DVec3, Vec2, Vec3};

use super::header::{Element, Property, Scalar};
use super::layout::{ListLayout, SLOTS, VertexLayout};
use crate::mesh::origin::origin;
use crate::mesh::polygon::Polygon;

/// Why a number could not be read.
#[derive(Debug)]
pub(super) enum Fault {
    /// The file ends before or inside it.
    End,
    /// It is malformed.
    Malformed(String),
    /// A text row continues after its last value.
    LongRow,
    /// The system failed.
    Io(std::io::Error),
}

impl From<std::io::Error> for Fault {
    /// A file can shrink while it is read: that counts as its end.
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => Self::End,
            _ => Self::Io(error),
        }
    }
}

/// A body that is being read.
pub(super) trait Source {
    /// The next number, of the type `kind`. `f64` represents every value of every type.
    fn value(&mut self, kind: Scalar) -> Result<f64, Fault>;

    /// Skips `count` numbers of the type `kind`.
    fn skip(&mut self, kind: Scalar, count: u64) -> Result<(), Fault>;

    /// Marks the end of a row.
    fn end_row(&mut self) -> Result<(), Fault>;

    /// The number of bytes not read yet.
    fn left(&self) -> u64;

    /// The smallest number of bytes of `count` numbers of the type `kind`.
    fn least(&self, kind: Scalar, count: u64) -> u64;

    /// The number of meaningful bytes after the end of the body.
    fn trailing(&mut self) -> Result<u64, Fault>;

    /// The current line, in a text.
    fn line(&self) -> Option<u64> {
        None
    }

    /// Reads the first vertices up to the first invalid position, and returns their number,
    /// possibly 0. An invalid vertex is left to be read again.
    fn vertices(&mut self, _: &VertexLayout, _: &mut Vertices) -> Result<u64, Fault> {
        Ok(0)
    }

    /// Reads the first faces as long as they refer only to the first `vertices` vertices, and
    /// returns their number, possibly 0. An invalid face is left to be read again.
    fn faces(
        &mut self,
        _element: &Element,
        _layout: ListLayout,
        _vertices: usize,
        _into: &mut Faces,
    ) -> Result<u64, Fault> {
        Ok(0)
    }

    /// The smallest number of bytes of a row of these properties, with empty lists.
    fn least_row(&self, properties: &[Property]) -> u64 {
        use super::header::Shape;
        let least = |p: &Property| match p.shape {
            Shape::One(kind) | Shape::List { count: kind, .. } => self.least(kind, 1),
        };
        properties.iter().map(least).sum()
    }
}

/// The faces so far.
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub(super) triangles: Vec<[u32; 3]>,
    /// The faces with more than three corners.
    pub(super) polygons: Vec<Polygon>,
}

/// The vertices while they are read. All rows exist from the start, as zeros.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    /// Relative to the origin.
    pub(super) positions: Vec<Vec3>,
    pub(super) origin: DVec3,
    /// Empty if the file has none.
    pub(super) normals: Vec<Vec3>,
    /// Empty if the file has none.
    pub(super) uvs: Vec<Vec2>,
    /// Empty if the file has none.
    pub(super) colors: Vec<Vec3>,
}

impl Vertices {
    /// Room for `count` vertices. The caller has checked the count against the size of the file.
    pub(super) fn new(count: usize, layout: &VertexLayout) -> Self {
        Self {
            // The system provides zeroed pages, first touched by the thread that fills them: `vec!`
            // would write each vector twice.
            positions: bytemuck::zeroed_vec(count),
            origin: DVec3::ZERO,
            normals: bytemuck::zeroed_vec(if layout.normals { count } else { 0 }),
            uvs: bytemuck::zeroed_vec(if layout.uvs { count } else { 0 }),
            colors: bytemuck::zeroed_vec(if layout.colors { count } else { 0 }),
        }
    }

    /// Makes the position among the values of vertex `index` relative to the origin, which the first
    /// vertex sets.
    pub(super) fn relate(&mut self, index: u64, values: &mut [f64; SLOTS]) {
        let point = DVec3::new(values[0], values[1], values[2]);
        if index == 0 {
            self.origin = origin(point);
        }
        values[..3].copy_from_slice(&(point - self.origin).to_array());
    }

    /// Sets slot `slot` of the vertex `row`.
    pub(super) fn set(&mut self, row: usize, slot: usize, value: f32) {
        match slot {
            0..3 => self.positions[row][slot] = value,
            3..6 => self.normals[row][slot - 3] = value,
            6..8 => self.uvs[row][slot - 6] = value,
            _ => self.colors[row][slot - 8] = value,
        }
    }
}
