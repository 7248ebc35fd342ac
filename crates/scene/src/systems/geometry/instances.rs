//! Prototypes and their instances: meshes stored once that are shown several times.

use std::collections::HashMap;

use glam::{DAffine3, DVec3, Vec3};
use hecs::Entity;

use super::builder::{GeometryBuilder, attributes, has_any, keep_used};
use super::meshes::Meshes;
use super::tangents::tangents;
use crate::components::Mesh;
use crate::mesh::MeshData;
use crate::systems::placement::ShapeInstance;
use crate::systems::{bounds, frame};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::parallel;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::geometry::instance::Instance;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::prepared::UvMap;

/// A prototype whose centre is this many times its size away from its origin has lost two bits: its
/// origin is moved there, so that transformed rays have small coordinates.
const FAR_FROM_ORIGIN: f64 = 4.0;

/// A prototype that was taken in.
struct Prototype {
    number: u32,
    triangles: usize,
    bounds: Aabb,
    /// Its origin in the mesh's own space.
    origin: DVec3,
    /// The index of its attributes.
    mesh: Option<u32>,
}

impl GeometryBuilder {
    /// Adds the meshes with several instances, and these instances.
    pub(super) fn add_instances(
        &mut self,
        instances: &[ShapeInstance],
        mut meshes: Meshes,
    ) -> Result<()> {
        let mut prototypes: HashMap<Entity, Prototype> = HashMap::new();
        for prototype in std::mem::take(&mut meshes.shared) {
            prototypes.insert(prototype, self.add_prototype(prototype, &mut meshes));
        }
        let mut next = self.arrays.geometry.own();
        for instance in instances {
            let Some(prototype) = prototypes.get(&instance.prototype) else { continue };
            let first = next as u32;
            next += prototype.triangles;
            instance.check_count(next, "triangles")?;
            self.add_instance(instance, prototype, first)?;
        }
        Ok(())
    }

    fn add_prototype(&mut self, prototype: Entity, meshes: &mut Meshes) -> Prototype {
        let (Mesh { data: mut mesh, points, .. }, uses) = meshes.take(prototype);
        keep_used(&mut mesh, uses.smooth, uses.textured);
        let tangents = uses.normal_mapped.then(|| tangents(&mesh)).flatten();
        let origin = origin(&mesh.positions, points.as_deref().map(Vec::as_slice));
        if origin != DVec3::ZERO {
            parallel::each_mut(&mut mesh.positions, |i, p| {
                let point = points.as_ref().map_or(p.as_dvec3(), |points| points[i]);
                *p = (point - origin).as_vec3();
            });
        }
        let MeshData { origin: own_origin, .. } = mesh;
        let geometry = Geometry {
            positions: std::mem::take(&mut mesh.positions),
            triangles: std::mem::take(&mut mesh.triangles),
            ..Geometry::default()
        };
        let attributes = attributes(mesh, tangents, [0, 0]);
        let prototype = Prototype {
            number: self.arrays.geometry.prototypes.len() as u32,
            triangles: geometry.triangles.len(),
            bounds: bounds::around(&geometry.positions),
            origin: own_origin + origin,
            mesh: has_any(&attributes).then(|| self.add_attributes(attributes)),
        };
        self.arrays.geometry.prototypes.push(geometry);
        prototype
    }

    fn add_instance(
        &mut self,
        instance: &ShapeInstance,
        prototype: &Prototype,
        first: u32,
    ) -> Result<()> {
        let to_world = instance.transform * DAffine3::from_translation(prototype.origin);
        for corner in bounds::corners(bounds::wide(prototype.bounds)) {
            instance.check_point(to_world.transform_point3(corner))?;
        }
        if !to_world.inverse().is_finite() {
            let message = "the transform is singular";
            return Err(Error::new(ErrorKind::Scene, message)
                .at(format!("{}.transform", instance.place))
                .remedy("use a scale other than 0 on every axis"));
        }
        let range = first..first + prototype.triangles as u32;
        let attributes = prototype.mesh.and_then(|i| self.arrays.meshes.get(i as usize));
        let (source, visibility, mut shape, map) = instance.built(range, UvMap::Mesh);
        shape.smooth = instance.smooth && attributes.is_some_and(|mesh| mesh.normals.is_some());
        shape.colored = attributes.is_some_and(|mesh| mesh.colors.is_some());
        shape.mesh = prototype.mesh;
        self.shapes.push((source, visibility, shape, map));
        let instanced = Instance::new(prototype.number, first, to_world, &prototype.bounds);
        self.arrays.geometry.instances.push(instanced);
        Ok(())
    }
}

/// The new origin of a prototype, in its own space: roughly its centre, if that is far away.
/// `points` replace its positions, if given.
fn origin(positions: &[Vec3], points: Option<&[DVec3]>) -> DVec3 {
    let of = |i: usize| [points.map_or_else(|| positions[i].as_dvec3(), |points| points[i]); 2];
    let [low, high] = parallel::reduce(positions.len(), bounds::EMPTY, of, bounds::joined);
    let (middle, size) = ((low + high) / 2.0, (high - low).max_element());
    let is_far = size > 0.0 && middle.abs().max_element() > FAR_FROM_ORIGIN * size;
    if is_far { frame::nearest(middle, size) } else { DVec3::ZERO }
}
