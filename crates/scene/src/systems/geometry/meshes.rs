//! Adds meshes to the scene's arrays: transformed to world space in place, moved if possible, and
//! otherwise copied on all threads.

use glam::{DAffine3, DVec3, Vec3, Vec4};
use hecs::World;
use rayon::prelude::*;

use super::occurrence::{Form, Occurrence, in_range};
use super::occurrences::Occurrences;
use crate::components::Mesh;
use crate::mesh::MeshData;
use wavecrest_base::error::Result;
use wavecrest_core::math::float::normalize_f64;
use wavecrest_core::prepared::CornerValues;

/// The final length of the arrays.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ArrayLengths {
    pub(super) positions: usize,
    pub(super) triangles: usize,
}

impl ArrayLengths {
    /// For everything in the world except instances. Meshes are looked up for each occurrence.
    pub(super) fn of(world: &World, occurrences: &Occurrences<'_>) -> Self {
        let mut meshes = world.query::<&Mesh>();
        let meshes = meshes.view();
        let mut room = Self::default();
        let own = occurrences.all.iter().filter(|occurrence| !occurrences.is_instance(occurrence));
        for Occurrence { form, prototype, .. } in own {
            let [positions, triangles] = match form {
                Form::Sphere(_) | Form::Disk(_) => [0, 0],
                Form::Quad(_) => [4, 0],
                Form::Triangle(_) => [3, 1],
                Form::Mesh => meshes.get(*prototype).map_or([0, 0], |Mesh { data, .. }| {
                    [data.positions.len(), data.triangles.len()]
                }),
            };
            room.positions += positions;
            room.triangles += triangles;
        }
        room
    }
}

/// Moves `more` to the end of `all`, which will have `room` items in the end, each `shifted` by the
/// number of positions `before` it; without a copy if `all` is empty.
pub(super) fn append<T: Send>(
    all: &mut Vec<T>,
    more: Vec<T>,
    room: usize,
    before: u32,
    shifted: impl Fn(T, u32) -> T + Sync + Send,
) {
    if before == 0 {
        // There are no triangles either: they would need positions.
        *all = more;
        // Once, instead of by doubling. Large arrays are not copied for it: the system moves pages.
        all.reserve_exact(room.saturating_sub(all.len()));
    } else {
        all.par_extend(more.into_par_iter().map(|item| shifted(item, before)));
    }
}

/// Transforms positions, normals and tangents to world space, in double precision, rounding once.
/// `points` replace the positions, if given.
pub(super) fn transform_mesh(
    mesh: &mut MeshData,
    points: Option<Vec<DVec3>>,
    tangents: Option<&mut CornerValues<Vec4>>,
    occurrence: &Occurrence<'_>,
) -> Result<()> {
    let transform = occurrence.transform * DAffine3::from_translation(mesh.origin);
    if transform == DAffine3::IDENTITY {
        return Ok(());
    }
    let carry = |(to, p): (&mut Vec3, DVec3)| {
        *to = transform.transform_point3(p).as_vec3();
        in_range(to.as_dvec3())
    };
    let own = |p: &mut Vec3| {
        let point = p.as_dvec3();
        carry((p, point))
    };
    let positions = mesh.positions.par_iter_mut();
    // Transform every position, even after one out of range: `all` would stop there.
    let kept = match points {
        Some(points) => positions.zip(points).map(carry).reduce(|| true, |a, b| a & b),
        None => positions.map(own).reduce(|| true, |a, b| a & b),
    };
    if !kept && let Some(point) = mesh.positions.iter().find(|p| !in_range(p.as_dvec3())) {
        occurrence.check_point(point.as_dvec3())?;
    }
    // Normals are transformed by the cofactors: the inverse transpose without its division.
    let m = transform.matrix3;
    let sign = if occurrence.mirrors() { -1.0 } else { 1.0 };
    let cofactors = [
        m.y_axis.cross(m.z_axis) * sign,
        m.z_axis.cross(m.x_axis) * sign,
        m.x_axis.cross(m.y_axis) * sign,
    ];
    if let Some(normals) = &mut mesh.normals {
        normals.values.par_iter_mut().for_each(|n| {
            let v = n.as_dvec3();
            let turned = cofactors[0] * v.x + cofactors[1] * v.y + cofactors[2] * v.z;
            *n = normalize_f64(turned).as_vec3();
        });
    }
    if let Some(tangents) = tangents {
        tangents.values.par_iter_mut().for_each(|tangent| {
            let along = normalize_f64(m * tangent.truncate().as_dvec3());
            // A bitangent stays on its side.
            *tangent = along.as_vec3().extend(tangent.w * sign as f32);
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
