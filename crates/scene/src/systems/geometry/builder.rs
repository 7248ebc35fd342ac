//! Collects shapes in the scene's own arrays, kind by kind.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::meshes::{ArrayLengths, append, transform_mesh};
use super::occurrence::Occurrence;
use super::output::{Output, ShapeOutput};
use super::tangents::tangents;
use crate::components::Mesh;
use crate::corners;
use crate::mesh::Attribute;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::{Geometry, Quadric};
use wavecrest_core::kernels::texture::PlanarMap;
use wavecrest_core::prepared::{CornerValues, MeshAttributes, Shape, UvMap};

#[derive(Default)]
pub(super) struct GeometryBuilder {
    pub(super) room: ArrayLengths,
    pub(super) geometry: Geometry,
    pub(super) shapes: Vec<ShapeOutput>,
    pub(super) meshes: Vec<MeshAttributes>,
}

impl GeometryBuilder {
    pub(super) fn add_triangle(
        &mut self,
        occurrence: &Occurrence<'_>,
        points: &[DVec3; 3],
    ) -> Result<()> {
        let start = self.geometry.triangles.len() as u32;
        let first = self.add_points(occurrence, points)?;
        let [p0, p1, p2] = self.geometry.positions[first as usize..] else { return Ok(()) };
        self.geometry.triangles.push([first, first + 1, first + 2]);
        let flipped = occurrence.flipped(corners::triangle_normal(points));
        let shape = occurrence.shape(start..start + 1, flipped);
        let uv_map = UvMap::Planar(PlanarMap::new(p0, p2 - p0, p1 - p0));
        self.shapes.push(occurrence.output(shape, uv_map));
        Ok(())
    }

    pub(super) fn add_mesh(&mut self, occurrence: &Occurrence<'_>, mesh: Mesh) -> Result<()> {
        let Mesh { data: mut mesh, points, .. } = mesh;
        // Drop unused attributes before allocating more.
        mesh.normals = mesh.normals.filter(|_| occurrence.smooth);
        mesh.uvs = mesh.uvs.filter(|_| occurrence.textured);
        mesh.colors = mesh
            .colors
            .filter(|colors| occurrence.light.is_none() && is_varied(colors, &Vec3::ONE));
        mesh.alphas = mesh.alphas.filter(|alphas| is_varied(alphas, &1.0));
        let mut tangents = occurrence.normal_mapped.then(|| tangents(&mesh)).flatten();
        transform_mesh(&mut mesh, points, tangents.as_mut(), occurrence)?;
        let geometry = &mut self.geometry;
        let first_position = geometry.positions.len();
        let first_triangle = geometry.triangles.len();
        occurrence.check_count(first_position + mesh.positions.len(), "vertices")?;
        occurrence.check_count(first_triangle + mesh.triangles.len(), "triangles")?;
        // All numbers were just checked to fit.
        let before = first_position as u32;
        let ArrayLengths { positions, triangles } = self.room;
        append(&mut geometry.positions, mesh.positions, positions, before, |p, _| p);
        append(&mut geometry.triangles, mesh.triangles, triangles, before, |t, before| {
            t.map(|v| v + before)
        });
        let (smooth, colored) = (mesh.normals.is_some(), mesh.colors.is_some());
        let range = first_triangle as u32..self.geometry.triangles.len() as u32;
        let mut shape = Shape { smooth, colored, ..occurrence.shape(range, occurrence.mirrors()) };
        if smooth || colored || mesh.alphas.is_some() || occurrence.textured {
            shape.mesh = Some(self.meshes.len() as u32);
            self.meshes.push(MeshAttributes {
                first_triangle: first_triangle as u32,
                first_position: first_position as u32,
                normals: mesh.normals.map(corner_values),
                uvs: mesh.uvs.map(corner_values).map(Arc::new),
                colors: mesh.colors.map(by_position),
                alphas: mesh.alphas.map(by_position).map(Arc::new),
                tangents,
            });
        }
        self.shapes.push(occurrence.output(shape, UvMap::Mesh));
        Ok(())
    }

    pub(super) fn add_quad(
        &mut self,
        occurrence: &Occurrence<'_>,
        points: &[DVec3; 4],
    ) -> Result<()> {
        let number = (self.geometry.triangles.len() + self.geometry.quads.len()) as u32;
        let first = self.add_points(occurrence, points)?;
        let [p0, p1, _, p3] = self.geometry.positions[first as usize..] else { return Ok(()) };
        let turn = first_of_diagonal(points);
        self.geometry.quads.push([0, 1, 2, 3].map(|k| first + (k + turn) % 4));
        let flipped = occurrence.flipped(corners::quad_normal(points));
        let shape = occurrence.shape(number..number + 1, flipped);
        let uv_map = UvMap::Planar(PlanarMap::new(p0, p3 - p0, p1 - p0));
        self.shapes.push(occurrence.output(shape, uv_map));
        Ok(())
    }

    pub(super) fn add_quadric(
        &mut self,
        occurrence: &Occurrence<'_>,
        (quadric, uv_map): (Quadric, UvMap),
    ) {
        let number = self.geometry.own() as u32;
        self.geometry.quadrics.push(quadric);
        let shape = occurrence.shape(number..number + 1, false);
        self.shapes.push(occurrence.output(shape, uv_map));
    }

    /// Appends the points in world space; returns the number of the first.
    fn add_points(&mut self, occurrence: &Occurrence<'_>, points: &[DVec3]) -> Result<u32> {
        let first = self.geometry.positions.len();
        occurrence.check_count(first + points.len(), "vertices")?;
        for &point in points {
            let point = occurrence.transform.transform_point3(point);
            occurrence.check_point(point)?;
            self.geometry.positions.push(point.as_vec3());
        }
        Ok(first as u32)
    }

    pub(super) fn finish(mut self) -> Output {
        self.shapes.sort_by_key(|s| s.shape.primitives.start);
        let Self { geometry, shapes, meshes, .. } = self;
        Output { geometry, shapes, meshes }
    }
}

/// 0 if the diagonal from the first corner to the third lies inside the quad, else 1. They differ
/// only in quads with a reflex corner.
fn first_of_diagonal(&[a, b, c, d]: &[DVec3; 4]) -> u32 {
    let normal = (c - a).cross(d - b);
    let within = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).dot(normal) > 0.0;
    u32::from(!(within(a, b, c) && within(a, c, d)))
}

/// Whether any of the factors is not `one`.
pub(crate) fn is_varied<T: PartialEq + Sync>(factors: &[T], one: &T) -> bool {
    factors.par_iter().any(|factor| factor != one)
}

/// Values indexed like positions.
pub(super) fn by_position<T>(values: Vec<T>) -> CornerValues<T> {
    CornerValues { values, indices: None }
}

pub(super) fn corner_values<T>(attribute: Attribute<T>) -> CornerValues<T> {
    CornerValues { values: attribute.values, indices: attribute.indices }
}
