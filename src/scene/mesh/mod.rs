//! Triangle meshes: the arrays that a mesh is, and the readers that make them from files.

use std::path::Path;

use glam::{Vec2, Vec3};

use crate::error::{Error, ErrorKind, Result, Warning};

/// A value for each corner of a mesh's triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribute<T> {
    /// The distinct values.
    pub values: Vec<T>,
    /// For each triangle, which value each of its corners has ([`NO_VALUE`] for none). `None`
    /// says that values go with positions: corner `c` has the value of position `c`.
    pub indices: Option<Vec<[u32; 3]>>,
}

/// In [`Attribute::indices`]: this corner has no value.
pub const NO_VALUE: u32 = u32::MAX;

/// A mesh as arrays. Every index is in range and every position finite; degenerate triangles are
/// still there (the geometry system counts them and leaves them out), so that the number of a
/// triangle is its number in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Vertex positions, in the mesh's own space.
    pub positions: Vec<Vec3>,
    /// Three positions a triangle, counter-clockwise as seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Shading normals, not necessarily of unit length.
    pub normals: Option<Attribute<Vec3>>,
    /// Texture coordinates, v upward.
    pub uvs: Option<Attribute<Vec2>>,
}

/// A mesh from a file, and what is odd about it.
#[derive(Clone, Debug, Default)]
pub struct LoadedMesh {
    /// The arrays.
    pub mesh: MeshData,
    /// What is odd about the file.
    pub warnings: Vec<Warning>,
}

/// Reads a mesh file: a stand-in until the readers are here.
///
/// # Errors
/// Always.
pub fn load(path: &Path) -> Result<LoadedMesh> {
    Err(Error::new(ErrorKind::Mesh, "mesh files cannot be read yet").in_file(path))
}
