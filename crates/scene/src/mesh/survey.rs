//! Surveys the contents of a mesh file without reading it into memory.
//!
//! For a binary PLY they follow from its header and its length. A text is scanned once, block by
//! block, and its words are counted but not parsed: they are checked when the mesh is loaded. An
//! invalid file has a survey too, limited by its size.

use super::data::MeshData;

/// The contents of a mesh, or as many as there may be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshSurvey {
    /// Positions.
    pub positions: u64,
    /// Triangles, after triangulation.
    pub triangles: u64,
    /// Bytes of normals, colours, texture coordinates, and indices of corners.
    pub attributes: u64,
}

/// Bytes of a position, a normal, a colour or the three indices of a triangle.
pub(crate) const TRIPLE: u64 = size_of::<[u32; 3]>() as u64;

/// Bytes of a pair of texture coordinates, and of the tangent there that a normal map needs.
pub(crate) const UV: u64 = size_of::<[f32; 2 + 4]>() as u64;

/// The most that is counted of anything: a file may claim more than there are numbers for.
const MOST: u64 = 1 << 44;

impl MeshSurvey {
    /// The contents of a mesh in memory.
    pub(crate) fn of(mesh: &MeshData) -> Self {
        let normals = mesh.normals.as_ref().map_or(0, |normals| normals.values.len() as u64);
        let uvs = mesh.uvs.as_ref().map_or(0, |uvs| uvs.values.len() as u64);
        let colors = mesh.colors.as_ref().map_or(0, |colors| colors.len() as u64);
        let alphas = mesh.alphas.as_ref().map_or(0, |alphas| size_of_val(alphas.as_slice()) as u64);
        let attributes = TRIPLE * (normals + colors) + UV * uvs + alphas;
        let [positions, triangles] =
            [mesh.positions.len(), mesh.triangles.len()].map(|count| count as u64);
        Self { positions, triangles, attributes }.indexed()
    }

    /// The same if corners have indices of their own for two attributes.
    pub(super) fn indexed(self) -> Self {
        let indices = if self.attributes > 0 { 2 * TRIPLE * self.triangles } else { 0 };
        Self { attributes: self.attributes + indices, ..self }
    }

    /// The contents together with so many times the `other` ones.
    pub(crate) fn plus(self, other: Self, times: u64) -> Self {
        let sum = |own: u64, each: u64| own.saturating_add(each.saturating_mul(times)).min(MOST);
        Self {
            positions: sum(self.positions, other.positions),
            triangles: sum(self.triangles, other.triangles),
            attributes: sum(self.attributes, other.attributes),
        }
    }

    /// Bytes of positions and triangles.
    pub fn geometry(&self) -> u64 {
        TRIPLE * (self.positions + self.triangles)
    }
}
