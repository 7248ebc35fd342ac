//! The arrays of a mesh.

use glam::{DVec3, Vec2, Vec3};

use super::crease;
use wavecrest_base::error::{Error, Warning};
use wavecrest_base::parallel;
use wavecrest_base::shared::Shared;
use wavecrest_core::math::srgb::srgb_decode;
pub use wavecrest_core::prepared::{CornerValues as Attribute, NO_VALUE};

/// The largest number of vertices, faces or triangles, so that each has an index other than
/// [`NO_VALUE`].
pub const MAX_COUNT: u64 = NO_VALUE as u64 - 1;

wavecrest_base::choices! {
    /// The encoding of vertex colours in a mesh file.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum VertexColors {
        /// sRGB-encoded, as in most programs.
        #[default]
        Srgb = "srgb",
        /// Linear.
        Linear = "linear",
        /// Ignored.
        None = "none",
    }
}

/// A mesh as arrays. Every index is in range and every position finite. Degenerate triangles are
/// kept (the geometry system counts and drops them), so that the number of a triangle is its number
/// in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Vertex positions, relative to the origin.
    pub positions: Shared<Vec3>,
    /// The origin of the positions in the mesh's own space: zero unless the mesh is far away.
    pub origin: DVec3,
    /// Three positions a triangle, counter-clockwise as seen from the front.
    pub triangles: Shared<[u32; 3]>,
    /// Shading normals, of any length; a zero vector is an unknown normal.
    pub normals: Option<Attribute<Vec3>>,
    /// Texture coordinates, v upward.
    pub uvs: Option<Attribute<Vec2>>,
    /// A colour for each position, not negative: linear, or encoded as in the file until it is
    /// decoded.
    pub colors: Option<Shared<Vec3>>,
    /// An alpha for each position, 0 to 1, which opacity or a cut-out uses; `None` if all are 1.
    pub alphas: Option<Shared<f32>>,
}

impl MeshData {
    /// Decodes the colours of a file to linear ones, or drops them.
    pub(crate) fn decode_colors(&mut self, encoding: VertexColors) {
        match (encoding, &mut self.colors) {
            (VertexColors::Srgb, Some(colors)) => {
                parallel::each_mut(colors, |_, color| *color = color.map(srgb_decode));
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
    pub(super) fn begin(&mut self, first: u32, name: &str) {
        // A material without a triangle is dropped.
        self.runs.pop_if(|(begun, _)| *begun == first);
        if self.runs.last().is_none_or(|(_, last)| last != name) {
            self.runs.push((first, name.to_owned()));
        }
    }
}

/// The result of a reader: the arrays, warnings that do not name the file yet, and materials.
pub(super) type Read = (MeshData, Vec<Error>, NamedMaterials);

/// Splits: each triangle goes to one part with its own vertices.
impl MeshData {
    /// The parts, at most `count`, without empty ones; `part` assigns each triangle. Triangles and
    /// vertices keep their order. Each part comes with its number.
    pub(crate) fn split(self, part: &[u32], count: usize) -> Vec<(u32, Self)> {
        let mut triangles: Vec<Vec<u32>> = vec![Vec::new(); count];
        for (triangle, &part) in (0..).zip(part) {
            triangles[part as usize].push(triangle);
        }
        let whole = |of: &Vec<u32>| of.len() == self.triangles.len();
        if let Some(only) = triangles.iter().position(whole) {
            return vec![(only as u32, self)];
        }
        let mut numbers = Vec::new();
        let used = (0..).zip(&triangles).filter(|(_, of)| !of.is_empty());
        used.map(|(number, of)| (number, self.part(of, &mut numbers))).collect()
    }

    /// The part with these triangles.
    fn part(&self, which: &[u32], numbers: &mut Vec<u32>) -> Self {
        let count = self.positions.len();
        let (triangles, used) = renumbered(which, &self.triangles, count, numbers);
        Self {
            positions: picked(&self.positions, &used),
            origin: self.origin,
            colors: self.colors.as_ref().map(|colors| picked(colors, &used)),
            alphas: self.alphas.as_ref().map(|alphas| picked(alphas, &used)),
            triangles: triangles.into(),
            normals: self.normals.as_ref().map(|all| attribute(all, which, &used, numbers)),
            uvs: self.uvs.as_ref().map(|all| attribute(all, which, &used, numbers)),
        }
    }
}

/// The attribute of the triangles in `which`, given the positions that they have `used`.
fn attribute<T: Copy>(
    Attribute { values, indices }: &Attribute<T>,
    which: &[u32],
    used: &[u32],
    numbers: &mut Vec<u32>,
) -> Attribute<T> {
    let Some(indices) = indices else { return picked(values, used).into() };
    let (indices, used) = renumbered(which, indices, values.len(), numbers);
    Attribute { values: picked(values, &used), indices: Some(indices.into()) }
}

fn picked<T: Copy>(values: &[T], which: &[u32]) -> Shared<T> {
    which.iter().map(|&i| values[i as usize]).collect()
}

/// The corners of the triangles in `which` with new indices, and the old indices, of `count`, in rising
/// order. The memory for `numbers` is reused for the next part.
fn renumbered(
    which: &[u32],
    corners: &[[u32; 3]],
    count: usize,
    numbers: &mut Vec<u32>,
) -> (Vec<[u32; 3]>, Vec<u32>) {
    let of_part = || which.iter().map(|&triangle| corners[triangle as usize]);
    let mut used: Vec<u32> = of_part().flatten().filter(|&i| i != NO_VALUE).collect();
    used.sort_unstable();
    used.dedup();
    numbers.resize(numbers.len().max(count), NO_VALUE);
    for (number, &old) in (0..).zip(&used) {
        numbers[old as usize] = number;
    }
    let renumber = |i: u32| numbers.get(i as usize).copied().unwrap_or(NO_VALUE);
    (of_part().map(|corner| corner.map(renumber)).collect(), used)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::strip;

    /// A strip with a normal for each triangle, and coordinates and colours for each position.
    fn full_strip(count: u32) -> MeshData {
        let plain = strip(count);
        let values = plain.positions.iter().map(|p| Vec2::new(p.x, p.y)).collect();
        let normals = (0..count).map(|i| Vec3::new(0.0, i as f32, 1.0)).collect();
        let indices = (0..count).map(|i| [i, NO_VALUE, i]).collect();
        MeshData {
            uvs: Some(Attribute { values, indices: None }),
            colors: Some(plain.positions.iter().map(|p| *p + 1.0).collect()),
            alphas: Some(plain.positions.iter().map(|p| p.x).collect()),
            normals: Some(Attribute { values: normals, indices: Some(indices) }),
            origin: DVec3::X,
            ..plain
        }
    }

    /// The attributes of a triangle's corners.
    fn corners(mesh: &MeshData, t: usize) -> Vec<(Vec3, Option<Vec3>, Vec2, Vec3)> {
        let normals = mesh.normals.as_ref().unwrap();
        let at = |k: usize| {
            let i = mesh.triangles[t][k] as usize;
            let normal = normals.indices.as_ref().unwrap()[t][k] as usize;
            let uv = mesh.uvs.as_ref().unwrap().values[i];
            let color = mesh.colors.as_ref().unwrap()[i] + mesh.alphas.as_ref().unwrap()[i];
            (mesh.positions[i], normals.values.get(normal).copied(), uv, color)
        };
        (0..3).map(at).collect()
    }

    #[test]
    fn each_triangle_keeps_all_that_it_has_in_its_part() {
        let mesh = full_strip(7);
        let part = [3, 0, 3, 1, 1, 0, 3];
        let parts = mesh.clone().split(&part, 5);
        assert_eq!(parts.iter().map(|(number, _)| *number).collect::<Vec<_>>(), [0, 1, 3]);
        for (number, own) in &parts {
            super::super::validate(own, std::path::Path::new("m")).unwrap();
            let which = (0..7).filter(|&t| part[t] == *number);
            for (t, old) in which.enumerate() {
                assert_eq!(corners(own, t), corners(&mesh, old));
            }
        }
        assert_eq!(parts.iter().map(|(_, own)| own.triangles.len()).sum::<usize>(), 7);
        // Only the vertices of its triangles.
        assert_eq!(parts[1].1.positions.len(), 4);
        assert_eq!(parts[1].1.origin, DVec3::X);
    }

    #[test]
    fn a_mesh_of_one_part_stays_as_it_is() {
        let mesh = full_strip(3);
        assert_eq!(mesh.clone().split(&[1; 3], 2), [(1, mesh)]);
    }
}
