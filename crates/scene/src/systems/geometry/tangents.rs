//! Tangents of meshes, by the convention of baked normal maps: Mikkelsen, *Simulation of Wrinkled
//! Surfaces Revisited* (2008).
//!
//! They are computed in the mesh's own space, like those in files with baked textures, and only for
//! meshes with a visible normal map.

use std::panic::{AssertUnwindSafe, catch_unwind};

use bevy_mikktspace::{Ops, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};

use crate::mesh::{Attribute, MeshData};
use wavecrest_core::math::float::normalize;
use wavecrest_core::prepared::CornerValues;

/// Mathematical functions with the same results on every machine.
struct Libm;

impl Ops for Libm {
    fn sqrt(x: f32) -> f32 {
        libm::sqrtf(x)
    }

    fn acos(x: f32) -> f32 {
        libm::acosf(x)
    }
}

/// A mesh, and the tangents at the corners of its triangles.
struct CornerTangents<'a> {
    mesh: &'a MeshData,
    uvs: &'a Attribute<Vec2>,
    found: Vec<[Vec4; 3]>,
}

/// The tangents of a mesh, with its own normals or those of its triangles; `None` without texture
/// coordinates. Zero where texture coordinates span no area.
pub(super) fn tangents(mesh: &MeshData) -> Option<CornerValues<Vec4>> {
    let uvs = mesh.uvs.as_ref()?;
    let found = vec![[Vec4::ZERO; 3]; mesh.triangles.len()];
    let mut corners = CornerTangents { mesh, uvs, found };
    // The crate should not panic, but an odd mesh must not end the program.
    let result = catch_unwind(AssertUnwindSafe(|| generate_tangents(&mut corners)));
    result.ok()?.ok()?;
    Some(shared(corners.found, mesh))
}

/// By vertex, if all corners at each have the same tangent; else by corner.
fn shared(found: Vec<[Vec4; 3]>, mesh: &MeshData) -> CornerValues<Vec4> {
    let mut values = vec![Vec4::ZERO; mesh.positions.len()];
    let mut is_known = vec![false; mesh.positions.len()];
    let mut corners = mesh.triangles.iter().flatten().zip(found.iter().flatten());
    let is_shared = corners.all(|(&vertex, &tangent)| {
        let vertex = vertex as usize;
        let agrees = !is_known[vertex] || values[vertex] == tangent;
        (values[vertex], is_known[vertex]) = (tangent, true);
        agrees
    });
    if is_shared {
        return values.into();
    }
    let indices = (0..found.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    CornerValues { values: found.into_iter().flatten().collect(), indices: Some(indices) }
}

/// The value of a corner.
fn value<T: Copy>(
    attribute: &Attribute<T>,
    mesh: &MeshData,
    face: usize,
    corner: usize,
) -> Option<T> {
    let indices = attribute.indices.as_ref().unwrap_or(&mesh.triangles);
    attribute.values.get(indices.get(face)?[corner] as usize).copied()
}

impl bevy_mikktspace::Geometry<Libm> for CornerTangents<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.mesh.triangles[face][corner] as usize].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let own = self.mesh.normals.as_ref();
        let own = own.and_then(|normals| value(normals, self.mesh, face, corner)).map(normalize);
        let normal = own.filter(|normal| *normal != Vec3::ZERO).unwrap_or_else(|| {
            let [a, b, c] = self.mesh.triangles[face].map(|i| self.mesh.positions[i as usize]);
            normalize((b - a).cross(c - a))
        });
        normal.to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        value(self.uvs, self.mesh, face, corner).unwrap_or(Vec2::ZERO).to_array()
    }

    fn set_tangent(&mut self, found: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(found) = found {
            let tangent = Vec4::from(found.tangent_encoded());
            self.found[face][corner] = if tangent.is_finite() { tangent } else { Vec4::ZERO };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles of a square in the plane z = 0, with these coordinates.
    fn square(uvs: [[f32; 2]; 4]) -> MeshData {
        let positions = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        MeshData {
            positions: positions.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec().into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
            uvs: Some(Attribute { values: uvs.map(Vec2::from).to_vec().into(), indices: None }),
            ..MeshData::default()
        }
    }

    #[test]
    fn coordinates_without_area_and_meshes_without_any_are_no_fault() {
        for uvs in [[[0.5, 0.5]; 4], [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]] {
            let found = tangents(&square(uvs)).expect("tangents");
            assert!(found.values.iter().all(|tangent| tangent.is_finite()));
        }
        let mut mesh = square([[f32::MAX, 0.0], [-f32::MAX, 1e-40], [0.0, 1.0], [1.0, 1.0]]);
        let found = tangents(&mesh).expect("tangents");
        assert!(found.values.iter().all(|tangent| tangent.is_finite()));
        mesh.positions[1] = mesh.positions[0];
        assert!(tangents(&mesh).expect("tangents").values.iter().all(|t| t.is_finite()));
        mesh.uvs = None;
        assert!(tangents(&mesh).is_none());
        assert!(
            tangents(&MeshData { uvs: Some(Attribute::default()), ..MeshData::default() })
                .is_some()
        );
    }

    #[test]
    fn a_seam_between_mirrored_halves_has_tangents_by_corner() {
        let mut mesh = square([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        mesh.uvs = Some(Attribute {
            values: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 0.0]]
                .map(Vec2::from)
                .to_vec()
                .into(),
            indices: Some(vec![[0, 1, 2], [0, 2, 3]].into()),
        });
        let found = tangents(&mesh).expect("tangents");
        assert!(found.indices.is_some());
        let signs = [0, 1].map(|t| found.corners(t, mesh.triangles[t]).expect("corners")[0].w);
        assert_eq!(signs, [1.0, -1.0]);
    }
}
