//! Prototypes and their instances: meshes stored once for several places.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3, Vec4};
use hecs::{Entity, World};
use rayon::prelude::*;

use super::builder::{GeometryBuilder, by_position, corner_values, is_varied};
use super::occurrence::Occurrence;
use super::occurrences::Occurrences;
use super::tangents::tangents;
use crate::components::Mesh;
use crate::mesh::MeshData;
use crate::systems::{bounds, frame};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::geometry::instance::Instance;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::prepared::{CornerValues, MeshAttributes, Shape, UvMap};

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
        world: &World,
        occurrences: &mut Occurrences<'_>,
    ) -> Result<()> {
        let mut prototypes: HashMap<Entity, Prototype> = HashMap::new();
        for prototype in std::mem::take(&mut occurrences.shared) {
            let (Mesh { data: mut mesh, points, .. }, of) = occurrences.take(world, prototype);
            mesh.normals = mesh.normals.filter(|_| of.smooth);
            mesh.uvs = mesh.uvs.filter(|_| of.textured);
            let tangents = of.normal_mapped.then(|| tangents(&mesh)).flatten();
            prototypes.insert(prototype, self.add_prototype(mesh, points, tangents));
        }
        let mut next = self.geometry.own();
        let instances =
            occurrences.all.iter().filter(|occurrence| occurrences.is_instance(occurrence));
        for occurrence in instances {
            let Some(prototype) = prototypes.get(&occurrence.prototype) else { continue };
            let first = next as u32;
            next += prototype.triangles;
            occurrence.check_count(next, "triangles")?;
            self.add_instance(occurrence, prototype, first)?;
        }
        Ok(())
    }

    fn add_prototype(
        &mut self,
        mut mesh: MeshData,
        points: Option<Vec<DVec3>>,
        tangents: Option<CornerValues<Vec4>>,
    ) -> Prototype {
        let origin = origin(&mesh.positions, points.as_deref());
        if origin != DVec3::ZERO {
            let positions = mesh.positions.par_iter_mut();
            match points {
                Some(points) => {
                    positions.zip(points).for_each(|(to, p)| *to = (p - origin).as_vec3())
                }
                None => positions.for_each(|p| *p = (p.as_dvec3() - origin).as_vec3()),
            }
        }
        mesh.colors = mesh.colors.filter(|colors| is_varied(colors, &Vec3::ONE));
        mesh.alphas = mesh.alphas.filter(|alphas| is_varied(alphas, &1.0));
        let colors = mesh.colors.is_some() || mesh.alphas.is_some();
        let attributes = mesh.normals.is_some() || mesh.uvs.is_some() || colors;
        let prototype = Prototype {
            number: self.geometry.prototypes.len() as u32,
            triangles: mesh.triangles.len(),
            bounds: bounds::around(&mesh.positions),
            origin: mesh.origin + origin,
            mesh: attributes.then_some(self.meshes.len() as u32),
        };
        if attributes {
            self.meshes.push(MeshAttributes {
                normals: mesh.normals.map(corner_values),
                uvs: mesh.uvs.map(corner_values).map(Arc::new),
                colors: mesh.colors.map(by_position),
                alphas: mesh.alphas.map(by_position).map(Arc::new),
                tangents,
                ..MeshAttributes::default()
            });
        }
        let MeshData { positions, triangles, .. } = mesh;
        self.geometry.prototypes.push(Geometry { positions, triangles, ..Geometry::default() });
        prototype
    }

    fn add_instance(
        &mut self,
        occurrence: &Occurrence<'_>,
        prototype: &Prototype,
        first: u32,
    ) -> Result<()> {
        let to_world = occurrence.transform * DAffine3::from_translation(prototype.origin);
        for corner in 0..8 {
            let pick = |k: usize| {
                if corner >> k & 1 == 0 { prototype.bounds.low } else { prototype.bounds.high }
            };
            let corner = DVec3::new(pick(0).x.into(), pick(1).y.into(), pick(2).z.into());
            occurrence.check_point(to_world.transform_point3(corner))?;
        }
        if !to_world.inverse().is_finite() {
            let message = "the transform is singular";
            return Err(Error::new(ErrorKind::Scene, message)
                .at(format!("{}.transform", occurrence.place))
                .remedy("use a scale other than 0 on every axis"));
        }
        let range = first..first + prototype.triangles as u32;
        let attributes = prototype.mesh.and_then(|i| self.meshes.get(i as usize));
        let shape = Shape {
            smooth: occurrence.smooth && attributes.is_some_and(|mesh| mesh.normals.is_some()),
            colored: attributes.is_some_and(|mesh| mesh.colors.is_some()),
            mesh: prototype.mesh,
            ..occurrence.shape(range, occurrence.mirrors())
        };
        self.geometry.instances.push(Instance::new(
            prototype.number,
            first,
            to_world,
            &prototype.bounds,
        ));
        self.shapes.push(occurrence.output(shape, UvMap::Mesh));
        Ok(())
    }
}

/// The new origin of a prototype, in its own space: roughly its centre, if that is far away.
/// `points` replace its positions, if given.
fn origin(positions: &[Vec3], points: Option<&[DVec3]>) -> DVec3 {
    let merge = |a: [DVec3; 2], b: [DVec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let none = || [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let [low, high] = match points {
        Some(points) => points.par_iter().map(|p| [*p; 2]).reduce(none, merge),
        None => positions.par_iter().map(|p| [p.as_dvec3(); 2]).reduce(none, merge),
    };
    let (middle, size) = ((low + high) / 2.0, (high - low).max_element());
    let is_far = size > 0.0 && middle.abs().max_element() > FAR_FROM_ORIGIN * size;
    if is_far { frame::nearest(middle, size) } else { DVec3::ZERO }
}
