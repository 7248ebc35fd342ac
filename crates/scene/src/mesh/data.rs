//! The arrays of a mesh.

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::crease;
use crate::components::VertexColors;
use wavecrest_base::error::{Error, Warning};
use wavecrest_core::math::srgb::srgb_decode;

/// Values for the corners of a mesh's triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribute<T> {
    /// The distinct values.
    pub values: Vec<T>,
    /// For each triangle, the index of the value of each corner ([`NO_VALUE`] for none). With
    /// `None`, values belong to positions: corner `c` has the value of position `c`.
    pub indices: Option<Vec<[u32; 3]>>,
}

/// In [`Attribute::indices`]: this corner has no value.
pub const NO_VALUE: u32 = u32::MAX;

/// The largest number of vertices, faces or triangles, so that each has an index other than
/// [`NO_VALUE`].
pub const MAX_COUNT: u64 = NO_VALUE as u64 - 1;

/// A mesh as arrays. Every index is in range and every position finite. Degenerate triangles are
/// kept (the geometry system counts and drops them), so that the number of a triangle is its number
/// in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Vertex positions, relative to the origin.
    pub positions: Vec<Vec3>,
    /// The origin of the positions in the mesh's own space: zero unless the mesh is far away.
    pub origin: DVec3,
    /// Three positions a triangle, counter-clockwise as seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Shading normals, of any length; a zero vector is an unknown normal.
    pub normals: Option<Attribute<Vec3>>,
    /// Texture coordinates, v upward.
    pub uvs: Option<Attribute<Vec2>>,
    /// A colour for each position, not negative: linear, or encoded as in the file until it is
    /// decoded.
    pub colors: Option<Vec<Vec3>>,
    /// An alpha for each position, 0 to 1, which opacity or a cut-out uses; `None` if all are 1.
    pub alphas: Option<Vec<f32>>,
}

impl MeshData {
    /// Decodes the colours of a file to linear ones, or drops them.
    pub(crate) fn decode_colors(&mut self, encoding: VertexColors) {
        match (encoding, &mut self.colors) {
            (VertexColors::Srgb, Some(colors)) => {
                colors.par_iter_mut().for_each(|color| *color = color.map(srgb_decode));
            }
            (VertexColors::None, colors) => *colors = None,
            _ => {}
        }
    }

    /// Completes a mesh like those of mesh files: its colours have the sRGB curve, and edges of fewer `degrees` are smooth
    /// if it has no normals; where textures meet too, if `joins_seams`.
    pub(crate) fn complete(&mut self, degrees: f64, joins_seams: bool) {
        self.decode_colors(VertexColors::Srgb);
        if self.normals.is_none() && degrees > 0.0 {
            let joins = joins_seams && self.uvs.is_some();
            let (positions, triangles) = (&self.positions, &self.triangles);
            self.normals = Some(crease::normals(positions, triangles, degrees, joins));
        }
    }
}

/// A mesh from a file, with warnings about the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadedMesh {
    /// The arrays, already checked.
    pub mesh: MeshData,
    /// Warnings about faults that did not stop the reading.
    pub warnings: Vec<Warning>,
    /// The names of its triangles' materials.
    pub materials: NamedMaterials,
}

/// Names of materials in an OBJ file, and of the files that define them, or of images in a PLY file;
/// nothing has been looked up.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NamedMaterials {
    /// The arguments of each `mtllib`, the names of one or several files.
    pub libraries: Vec<String>,
    /// Images, each of which is a material of its name.
    pub textures: Vec<String>,
    /// The first triangle with a material, and its name; it applies up to the next entry.
    pub runs: Vec<(u32, String)>,
}

impl NamedMaterials {
    /// Adds the argument of a `mtllib`, once.
    pub(super) fn add_library(&mut self, statement: String) {
        if !statement.is_empty() && self.libraries.last() != Some(&statement) {
            self.libraries.push(statement);
        }
    }

    /// Sets the material of the triangles from `first` on.
    pub(super) fn begin(&mut self, first: u32, name: String) {
        // A material without a triangle is dropped.
        self.runs.pop_if(|(begun, _)| *begun == first);
        if self.runs.last().is_none_or(|(_, last)| *last != name) {
            self.runs.push((first, name));
        }
    }
}

/// The result of a reader: the arrays, and warnings that do not name the file yet.
pub(super) type Read = (MeshData, Vec<Error>);
