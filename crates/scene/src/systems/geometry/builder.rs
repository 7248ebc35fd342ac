//! Collects shapes in the scene's own arrays, kind by kind.

use std::sync::Arc;

use glam::{DVec3, Vec3, Vec4};
use rayon::prelude::*;

use super::meshes::{ArrayLengths, Meshes, append, transform_mesh};
use super::tangents::tangents;
use super::{Arrays, BuiltShape, built};
use crate::components::{Mesh, Quad, Triangle};
use crate::mesh::{Attribute, MeshData};
use crate::systems::placement::{ShapeGeometry, ShapeInstance};
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Quadric;
use wavecrest_core::kernels::texture::PlanarMap;
use wavecrest_core::prepared::{CornerValues, MeshAttributes, Shape, UvMap};

#[derive(Default)]
pub(super) struct GeometryBuilder {
    pub(super) room: ArrayLengths,
    pub(super) arrays: Arrays,
    pub(super) shapes: Vec<BuiltShape>,
}

impl GeometryBuilder {
    /// Adds a shape to the arrays. Numbers of primitives follow their kinds, and so must the shapes.
    pub(super) fn add(&mut self, instance: &ShapeInstance, meshes: &mut Meshes) -> Result<()> {
        let (shape, uv_map) = match &instance.geometry {
            ShapeGeometry::Triangle(Triangle { points }) => {
                let (first, built) = self.flat(instance, points)?;
                self.arrays.geometry.triangles.push([first, first + 1, first + 2]);
                built
            }
            ShapeGeometry::Mesh => {
                let (mesh, _) = meshes.take(instance.prototype);
                (self.mesh(instance, mesh)?, UvMap::Mesh)
            }
            ShapeGeometry::Quad(Quad { points }) => {
                let (first, built) = self.flat(instance, points)?;
                let turn = first_of_diagonal(points);
                self.arrays.geometry.quads.push([0, 1, 2, 3].map(|k| first + (k + turn) % 4));
                built
            }
            ShapeGeometry::Sphere(sphere) => self.quadric(instance, sphere.in_world(instance)?),
            ShapeGeometry::Disk(disk) => self.quadric(instance, disk.in_world(instance)?),
        };
        self.shapes.push(built(instance, shape, uv_map));
        Ok(())
    }

    /// Adds the corners of a flat shape. Returns the number of the first, and the shape as the next primitive.
    fn flat(
        &mut self,
        instance: &ShapeInstance,
        corners: &[DVec3],
    ) -> Result<(u32, (Shape, UvMap))> {
        let geometry = &mut self.arrays.geometry;
        let first = geometry.positions.len();
        instance.check_count(first + corners.len(), "vertices")?;
        for &corner in corners {
            let corner = instance.transform.transform_point3(corner);
            instance.check_point(corner)?;
            geometry.positions.push(corner.as_vec3());
        }
        let number = (geometry.triangles.len() + geometry.quads.len()) as u32;
        let shape = instance.shape(number..number + 1);
        let [origin, up] = [0, 1].map(|i| geometry.positions[first + i]);
        let right = geometry.positions[first + corners.len() - 1];
        let map = PlanarMap::new(origin, right - origin, up - origin);
        Ok((first as u32, (shape, UvMap::Planar(map))))
    }

    fn quadric(
        &mut self,
        instance: &ShapeInstance,
        (quadric, uv_map): (Quadric, UvMap),
    ) -> (Shape, UvMap) {
        let geometry = &mut self.arrays.geometry;
        let number = geometry.own() as u32;
        geometry.quadrics.push(quadric);
        (instance.shape(number..number + 1), uv_map)
    }

    fn mesh(&mut self, instance: &ShapeInstance, mesh: Mesh) -> Result<Shape> {
        let Mesh { data: mut mesh, points, .. } = mesh;
        // Drop unused attributes before allocating more.
        mesh.colors = mesh.colors.filter(|_| !instance.is_of_light());
        keep_used(&mut mesh, instance.smooth, instance.textured);
        let mut tangents = instance.normal_mapped.then(|| tangents(&mesh)).flatten();
        transform_mesh(&mut mesh, points, tangents.as_mut(), instance)?;
        let geometry = &mut self.arrays.geometry;
        let first_position = geometry.positions.len();
        let first_triangle = geometry.triangles.len();
        instance.check_count(first_position + mesh.positions.len(), "vertices")?;
        instance.check_count(first_triangle + mesh.triangles.len(), "triangles")?;
        // All numbers were just checked to fit.
        let before = first_position as u32;
        let ArrayLengths { positions, triangles } = self.room;
        let (new_positions, new_triangles) =
            (std::mem::take(&mut mesh.positions), std::mem::take(&mut mesh.triangles));
        append(&mut geometry.positions, new_positions, positions, before, |p, _| p);
        append(&mut geometry.triangles, new_triangles, triangles, before, |t, before| {
            t.map(|v| v + before)
        });
        let range = first_triangle as u32..geometry.triangles.len() as u32;
        let (smooth, colored) = (mesh.normals.is_some(), mesh.colors.is_some());
        let shape = Shape { smooth, colored, ..instance.shape(range) };
        let firsts = [first_triangle as u32, first_position as u32];
        let attributes = attributes(mesh, tangents, firsts);
        let is_used = has_any(&attributes) || instance.textured;
        Ok(Shape { mesh: is_used.then(|| self.add_attributes(attributes)), ..shape })
    }

    /// Adds attributes of a mesh; returns their number.
    pub(super) fn add_attributes(&mut self, attributes: MeshAttributes) -> u32 {
        self.arrays.meshes.push(attributes);
        self.arrays.meshes.len() as u32 - 1
    }
}

/// 0 if the diagonal from the first corner to the third lies inside the quad, else 1. They differ
/// only in quads with a reflex corner.
fn first_of_diagonal(&[a, b, c, d]: &[DVec3; 4]) -> u32 {
    let normal = (c - a).cross(d - b);
    let within = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).dot(normal) > 0.0;
    u32::from(!(within(a, b, c) && within(a, c, d)))
}

/// Drops the attributes of a mesh that nothing reads, and those that change nothing.
pub(super) fn keep_used(mesh: &mut MeshData, smooth: bool, textured: bool) {
    mesh.normals = mesh.normals.take().filter(|_| smooth);
    mesh.uvs = mesh.uvs.take().filter(|_| textured);
    mesh.colors = mesh.colors.take().filter(|colors| is_varied(colors, &Vec3::ONE));
    mesh.alphas = mesh.alphas.take().filter(|alphas| is_varied(alphas, &1.0));
}

/// Whether any of the factors is not `one`.
pub(crate) fn is_varied<T: PartialEq + Sync>(factors: &[T], one: &T) -> bool {
    factors.par_iter().any(|factor| factor != one)
}

/// The attributes of a mesh whose first triangle and first position these are.
pub(super) fn attributes(
    mesh: MeshData,
    tangents: Option<CornerValues<Vec4>>,
    [first_triangle, first_position]: [u32; 2],
) -> MeshAttributes {
    MeshAttributes {
        first_triangle,
        first_position,
        normals: mesh.normals.map(corner_values),
        uvs: mesh.uvs.map(corner_values).map(Arc::new),
        colors: mesh.colors.map(by_position),
        alphas: mesh.alphas.map(by_position).map(Arc::new),
        tangents,
    }
}

/// Whether any attribute is left; without texture coordinates, tangents are none.
pub(super) fn has_any(mesh: &MeshAttributes) -> bool {
    let by_vertex = mesh.colors.is_some() || mesh.alphas.is_some();
    mesh.normals.is_some() || mesh.uvs.is_some() || by_vertex
}

/// Values indexed like positions.
fn by_position<T>(values: Vec<T>) -> CornerValues<T> {
    CornerValues { values, indices: None }
}

fn corner_values<T>(attribute: Attribute<T>) -> CornerValues<T> {
    CornerValues { values: attribute.values, indices: attribute.indices }
}
