//! The arrays that a mesh is.

use glam::{Vec2, Vec3};

use wavecrest_base::error::{Error, Warning};

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

/// The greatest number of vertices, of faces or of triangles, so that each has an index and
/// [`NO_VALUE`] is none of them.
pub const MAX_COUNT: u64 = NO_VALUE as u64 - 1;

/// A mesh as arrays. Every index is in range and every position finite; degenerate triangles are
/// still there (the geometry system counts them and leaves them out), so that the number of a
/// triangle is its number in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Vertex positions, in the mesh's own space.
    pub positions: Vec<Vec3>,
    /// Three positions a triangle, counter-clockwise as seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Shading normals, not necessarily of unit length; a zero vector is a normal not known.
    pub normals: Option<Attribute<Vec3>>,
    /// Texture coordinates, v upward.
    pub uvs: Option<Attribute<Vec2>>,
    /// A colour for each position, none of it negative: linear, or as the file has it until it is decoded.
    pub colors: Option<Vec<Vec3>>,
}

/// A mesh from a file, and what the user should know about that file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadedMesh {
    /// The arrays, already checked.
    pub mesh: MeshData,
    /// Oddities that did not stop the reading.
    pub warnings: Vec<Warning>,
    /// What its triangles are made of, by name.
    pub materials: NamedMaterials,
}

/// Materials that an OBJ file names, and where they are to be found. None of it has been looked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NamedMaterials {
    /// What follows each `mtllib`, the names of one file or of several.
    pub libraries: Vec<String>,
    /// The first triangle that has a material, and its name; it holds up to the next.
    pub runs: Vec<(u32, String)>,
}

impl NamedMaterials {
    /// Adds what follows a `mtllib`, the first time.
    pub(super) fn add_library(&mut self, statement: String) {
        if !statement.is_empty() && self.libraries.last() != Some(&statement) {
            self.libraries.push(statement);
        }
    }

    /// Has the triangles from `first` on be of a material.
    pub(super) fn begin(&mut self, first: u32, name: String) {
        // A material without a triangle is not kept.
        self.runs.pop_if(|(begun, _)| *begun == first);
        if self.runs.last().is_none_or(|(_, last)| *last != name) {
            self.runs.push((first, name));
        }
    }
}

/// What a reader returns: the arrays, and warnings that do not name the file yet.
pub(super) type Read = (MeshData, Vec<Error>);
