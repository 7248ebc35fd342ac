//! Collects shapes in the scene's own arrays, kind by kind.

use glam::{DVec3, Vec3, Vec4};

use super::meshes::{Meshes, append, transform_mesh};
use super::tangents::tangents;
use super::{Arrays, BuiltShape};
use crate::components::{Disk, Mesh, Quad, Sphere, Triangle};
use crate::mesh::MeshData;
use crate::systems::placement::{Circle, ShapeGeometry, ShapeInstance};
use wavecrest_base::error::Result;
use wavecrest_base::parallel;
use wavecrest_core::geometry::Quadric;
use wavecrest_core::kernels::disk;
use wavecrest_core::kernels::texture::PlanarMap;
use wavecrest_core::prepared::{CornerValues, MeshAttributes, UvMap};

#[derive(Default)]
pub(super) struct GeometryBuilder {
    /// The final numbers of positions and triangles.
    pub(super) room: [usize; 2],
    pub(super) arrays: Arrays,
    pub(super) shapes: Vec<BuiltShape>,
}

impl GeometryBuilder {
    /// Adds a shape to the arrays. Numbers of primitives follow their kinds, and so must the shapes.
    pub(super) fn add(&mut self, instance: &ShapeInstance, meshes: &mut Meshes) -> Result<()> {
        let number = self.arrays.geometry.own() as u32;
        let map = match &instance.geometry {
            ShapeGeometry::Mesh => {
                let (mesh, _) = meshes.take(instance.prototype);
                return self.add_mesh(instance, mesh);
            }
            ShapeGeometry::Triangle(Triangle { points }) => {
                let (first, map) = self.add_corners(instance, points)?;
                self.arrays.geometry.triangles.push([first, first + 1, first + 2]);
                map
            }
            ShapeGeometry::Quad(Quad { points }) => {
                let (first, map) = self.add_corners(instance, points)?;
                let turn = first_of_diagonal(points);
                self.arrays.geometry.quads.push([0, 1, 2, 3].map(|k| first + (k + turn) % 4));
                map
            }
            ShapeGeometry::Sphere(Sphere { center, radius }) => {
                let Circle { center, radius, turn } =
                    instance.circle("sphere", *center, *radius)?;
                self.arrays.geometry.quadrics.push(Quadric::Sphere(center, radius));
                UvMap::Sphere(turn.transpose().as_mat3())
            }
            ShapeGeometry::Disk(Disk { center, normal, radius }) => {
                let Circle { center, radius, turn } = instance.circle("disk", *center, *radius)?;
                let axes = disk::Disk::axes(*normal);
                let [u, v] = axes.map(|axis| (turn * axis).as_vec3() * radius);
                let normal = (turn * *normal).normalize().as_vec3();
                let disk = disk::Disk { center, normal, radius };
                self.arrays.geometry.quadrics.push(Quadric::Disk(disk));
                UvMap::Planar(PlanarMap::new(center - u - v, 2.0 * u, 2.0 * v))
            }
        };
        self.shapes.push(instance.built(number..number + 1, map));
        Ok(())
    }

    /// Adds the corners of a flat shape. Returns the number of the first, and the map of texture coordinates.
    fn add_corners(&mut self, instance: &ShapeInstance, corners: &[DVec3]) -> Result<(u32, UvMap)> {
        let positions = &mut self.arrays.geometry.positions;
        let first = positions.len();
        instance.check_count(first + corners.len(), "vertices")?;
        for &corner in corners {
            let corner = instance.transform.transform_point3(corner);
            instance.check_point(corner)?;
            positions.push(corner.as_vec3());
        }
        let [origin, up] = [0, 1].map(|i| positions[first + i]);
        let right = positions[first + corners.len() - 1];
        let map = PlanarMap::new(origin, right - origin, up - origin);
        Ok((first as u32, UvMap::Planar(map)))
    }

    fn add_mesh(&mut self, instance: &ShapeInstance, mesh: Mesh) -> Result<()> {
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
        let [positions, triangles] = self.room;
        let new = std::mem::take(&mut mesh.positions);
        append(&mut geometry.positions, new, positions, before, |p, _| p);
        let new = std::mem::take(&mut mesh.triangles);
        append(&mut geometry.triangles, new, triangles, before, |t, before| t.map(|v| v + before));
        let range = first_triangle as u32..geometry.triangles.len() as u32;
        let (source, visibility, mut shape, map) = instance.built(range, UvMap::Mesh);
        (shape.smooth, shape.colored) = (mesh.normals.is_some(), mesh.colors.is_some());
        let attributes = attributes(mesh, tangents, [first_triangle as u32, before]);
        if has_any(&attributes) || instance.textured {
            shape.mesh = Some(self.add_attributes(attributes));
        }
        self.shapes.push((source, visibility, shape, map));
        Ok(())
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
    parallel::find_first(factors, |factor| factor != one).is_some()
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
        normals: mesh.normals,
        uvs: mesh.uvs,
        colors: mesh.colors.map(CornerValues::from),
        alphas: mesh.alphas.map(CornerValues::from),
        tangents,
    }
}

/// Whether any attribute is left; without texture coordinates, tangents are none.
pub(super) fn has_any(mesh: &MeshAttributes) -> bool {
    let by_vertex = mesh.colors.is_some() || mesh.alphas.is_some();
    mesh.normals.is_some() || mesh.uvs.is_some() || by_vertex
}
