//! Meshes: moved out of the world, and added to the scene's arrays, transformed to world space in place, moved
//! if possible, and otherwise copied on all threads.

use std::collections::HashMap;

use glam::{DAffine3, DVec3, Vec4};
use hecs::{Entity, World};

use crate::components::Mesh;
use crate::mesh::MeshData;
use crate::systems::placement::{ShapeGeometry, ShapeInstance, in_range};
use wavecrest_base::error::Result;
use wavecrest_base::parallel;
use wavecrest_base::shared::Shared;
use wavecrest_core::math::float::normalize_f64;
use wavecrest_core::prepared::CornerValues;

/// The meshes of some shapes.
#[derive(Default)]
pub(crate) struct Meshes {
    all: HashMap<Entity, UsedMesh>,
    /// Meshes with several instances, in the order of each one's second instance.
    pub(super) shared: Vec<Entity>,
}

/// A mesh and its uses.
#[derive(Default)]
pub(super) struct UsedMesh {
    mesh: Mesh,
    /// How many more times it will be taken.
    left: usize,
    /// Number of its instances, without those that shadow rays pass.
    instances: usize,
    is_shared: bool,
    /// Whether any of them asks for normals, for texture coordinates, and has a normal map.
    pub(super) smooth: bool,
    pub(super) textured: bool,
    pub(super) normal_mapped: bool,
}

impl Meshes {
    /// Moves the meshes of these shapes out of the world; `flatten` turns instances into primitives of the
    /// scene's own.
    pub(super) fn moved_out_of(world: &World, shapes: &[ShapeInstance], flatten: bool) -> Self {
        let mut meshes = Self::default();
        for instance in shapes.iter().filter(|instance| instance.is_mesh()) {
            let moved = || {
                let mesh = world.get::<&mut Mesh>(instance.prototype);
                let mesh =
                    mesh.map_or_else(|_| Mesh::default(), |mut mesh| std::mem::take(&mut *mesh));
                UsedMesh { mesh, ..UsedMesh::default() }
            };
            let of = meshes.all.entry(instance.prototype).or_insert_with(moved);
            of.smooth |= instance.smooth;
            of.textured |= instance.textured;
            of.normal_mapped |= instance.normal_mapped;
            of.instances += usize::from(!instance.is_passed());
            if of.instances < 2 || instance.is_passed() || flatten {
                of.left += 1;
            } else if !of.is_shared {
                of.is_shared = true;
                meshes.shared.push(instance.prototype);
            }
        }
        meshes
    }

    /// Whether the shape is an instance of a mesh that is stored once.
    pub(super) fn is_shared(&self, instance: &ShapeInstance) -> bool {
        let is_shared = || self.all.get(&instance.prototype).is_some_and(|of| of.is_shared);
        !instance.is_passed() && is_shared()
    }

    /// The mesh of `prototype` and its uses: moved out at its last use, copied before.
    pub(super) fn take(&mut self, prototype: Entity) -> (Mesh, &UsedMesh) {
        let of = self.all.entry(prototype).or_default();
        of.left = of.left.saturating_sub(1);
        let mesh = if of.left > 0 { of.mesh.clone() } else { std::mem::take(&mut of.mesh) };
        (mesh, of)
    }

    /// The numbers of positions and of triangles of all these shapes but instances.
    pub(super) fn room(&self, shapes: &[ShapeInstance]) -> [usize; 2] {
        let mut room = [0, 0];
        for instance in shapes.iter().filter(|instance| !self.is_shared(instance)) {
            let [positions, triangles] = match instance.geometry {
                ShapeGeometry::Sphere(_) | ShapeGeometry::Disk(_) => [0, 0],
                ShapeGeometry::Quad(_) => [4, 0],
                ShapeGeometry::Triangle(_) => [3, 1],
                ShapeGeometry::Mesh => self.all.get(&instance.prototype).map_or([0, 0], |of| {
                    [of.mesh.data.positions.len(), of.mesh.data.triangles.len()]
                }),
            };
            room = [room[0] + positions, room[1] + triangles];
        }
        room
    }
}

/// Moves `more` to the end of `all`, which will have `room` items in the end, each `shifted` by the
/// number of positions `before` it. If `all` is empty it takes `more`,
/// which is copied only if it is shared and has to grow.
pub(super) fn append<T: Copy + Send + Sync>(
    all: &mut Shared<T>,
    more: Shared<T>,
    room: usize,
    before: u32,
    shifted: impl Fn(T, u32) -> T + Sync + Send,
) {
    if before == 0 {
        // There are no triangles either: they would need positions.
        *all = more;
        all.make_room(room);
    } else {
        let own = all.len();
        all.extend_from_slice(&more);
        parallel::each_mut(&mut all[own..], |_, item| *item = shifted(*item, before));
    }
}

/// Transforms positions, normals and tangents to world space, in double precision, rounding once.
/// `points` replace the positions, if given.
pub(super) fn transform_mesh(
    mesh: &mut MeshData,
    points: Option<Shared<DVec3>>,
    tangents: Option<&mut CornerValues<Vec4>>,
    instance: &ShapeInstance,
) -> Result<()> {
    let transform = instance.transform * DAffine3::from_translation(mesh.origin);
    if transform == DAffine3::IDENTITY {
        return Ok(());
    }
    parallel::each_mut(&mut mesh.positions, |i, p| {
        let point = points.as_ref().map_or(p.as_dvec3(), |points| points[i]);
        *p = transform.transform_point3(point).as_vec3();
    });
    if let Some(bad) = parallel::find_first(&mesh.positions, |p| !in_range(p.as_dvec3())) {
        instance.check_point(mesh.positions[bad].as_dvec3())?;
    }
    // Normals are transformed by the cofactors: the inverse transpose without its division.
    let m = transform.matrix3;
    let sign = if instance.shape.flipped { -1.0 } else { 1.0 };
    let cofactors = [
        m.y_axis.cross(m.z_axis) * sign,
        m.z_axis.cross(m.x_axis) * sign,
        m.x_axis.cross(m.y_axis) * sign,
    ];
    if let Some(normals) = &mut mesh.normals {
        parallel::each_mut(&mut normals.values, |_, n| {
            let v = n.as_dvec3();
            let turned = cofactors[0] * v.x + cofactors[1] * v.y + cofactors[2] * v.z;
            *n = normalize_f64(turned).as_vec3();
        });
    }
    if let Some(tangents) = tangents {
        parallel::each_mut(&mut tangents.values, |_, tangent| {
            let along = normalize_f64(m * tangent.truncate().as_dvec3());
            // A bitangent stays on its side.
            *tangent = along.as_vec3().extend(tangent.w * sign as f32);
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
