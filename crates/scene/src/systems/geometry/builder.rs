//! Collects shapes in the scene's own arrays, kind by kind.

use std::sync::Arc;

use glam::DVec3;
use hecs::{Entity, World};

use super::common::{Common, check_count, check_point};
use super::meshes::{Room, append, transform_mesh};
use super::occurrences::{Occurrence, Occurrences};
use super::output::{Output, ShapeOutput, lights};
use super::tangents::tangents;
use crate::components::{Disk, Mesh, Quad, Sphere, Triangle};
use crate::corners;
use crate::mesh::Attribute;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::texture::PlanarMap;
use wavecrest_core::prepared::{CornerValues, MeshAttributes, Shape, UvMap};

#[derive(Default)]
pub(super) struct Builder {
    pub(super) origin: DVec3,
    pub(super) room: Room,
    pub(super) geometry: Geometry,
    pub(super) shapes: Vec<ShapeOutput>,
    pub(super) meshes: Vec<MeshAttributes>,
}

impl Builder {
    pub(super) fn common(&self, world: &World, occurrence: Occurrence) -> Common {
        Common::of(world, occurrence, self.origin)
    }

    pub(super) fn add_triangles(
        &mut self,
        world: &World,
        occurrence: Occurrence,
        occurrences: &mut Occurrences,
    ) -> Result<()> {
        let common = self.common(world, occurrence);
        if let Ok(triangle) = world.get::<&Triangle>(occurrence.prototype) {
            return self.add_triangle(occurrence.entity, &common, &triangle.points);
        }
        self.add_mesh(occurrence.entity, &common, occurrences.take(world, occurrence.prototype))
    }

    fn add_triangle(&mut self, entity: Entity, common: &Common, points: &[DVec3; 3]) -> Result<()> {
        let start = self.geometry.triangles.len() as u32;
        let first = self.add_points(common, points)?;
        let [p0, p1, p2] = self.geometry.positions[first as usize..] else { return Ok(()) };
        self.geometry.triangles.push([first, first + 1, first + 2]);
        let flipped = common.flipped(corners::triangle_normal(points));
        self.shapes.push(ShapeOutput {
            entity,
            shape: common.shape(start..start + 1, flipped),
            uv_map: Some(UvMap::Planar(PlanarMap::new(p0, p2 - p0, p1 - p0))),
            positions: first..first + 3,
        });
        Ok(())
    }

    fn add_mesh(&mut self, entity: Entity, common: &Common, mesh: Mesh) -> Result<()> {
        let Mesh { data: mut mesh, points, .. } = mesh;
        // Drop unused attributes before allocating more.
        mesh.normals = mesh.normals.filter(|_| common.smooth);
        mesh.uvs = mesh.uvs.filter(|_| common.textured);
        mesh.colors = mesh.colors.filter(|_| common.emission.is_none());
        let mut tangents = common.normal_mapped.then(|| tangents(&mesh)).flatten();
        transform_mesh(&mut mesh, points, tangents.as_mut(), common)?;
        let geometry = &mut self.geometry;
        let first_position = geometry.positions.len();
        let first_triangle = geometry.triangles.len();
        check_count(common, first_position + mesh.positions.len(), "vertices")?;
        check_count(common, first_triangle + mesh.triangles.len(), "triangles")?;
        // All numbers were just checked to fit.
        let before = first_position as u32;
        let Room { positions, triangles } = self.room;
        append(&mut geometry.positions, mesh.positions, positions, before, |p, _| p);
        append(&mut geometry.triangles, mesh.triangles, triangles, before, |t, before| {
            t.map(|v| v + before)
        });
        let (smooth, colored) = (mesh.normals.is_some(), mesh.colors.is_some());
        let range = first_triangle as u32..self.geometry.triangles.len() as u32;
        let mut shape = Shape { smooth, colored, ..common.shape(range, common.mirrors()) };
        if smooth || colored || common.textured {
            shape.mesh = Some(self.meshes.len() as u32);
            self.meshes.push(MeshAttributes {
                first_triangle: first_triangle as u32,
                first_position: first_position as u32,
                normals: mesh.normals.map(corner_values),
                uvs: mesh.uvs.map(corner_values).map(Arc::new),
                colors: mesh.colors.map(by_position),
                tangents,
            });
        }
        let positions = before..self.geometry.positions.len() as u32;
        self.shapes.push(ShapeOutput { entity, shape, uv_map: Some(UvMap::Mesh), positions });
        Ok(())
    }

    pub(super) fn add_quad(&mut self, world: &World, occurrence: Occurrence) -> Result<()> {
        let common = self.common(world, occurrence);
        let Ok(points) = world.get::<&Quad>(occurrence.prototype).map(|q| q.points) else {
            return Ok(());
        };
        let number = (self.geometry.triangles.len() + self.geometry.quads.len()) as u32;
        let first = self.add_points(&common, &points)?;
        let [p0, p1, _, p3] = self.geometry.positions[first as usize..] else { return Ok(()) };
        let turn = first_of_diagonal(&points);
        self.geometry.quads.push([0, 1, 2, 3].map(|k| first + (k + turn) % 4));
        let flipped = common.flipped(corners::quad_normal(&points));
        self.shapes.push(ShapeOutput {
            entity: occurrence.entity,
            shape: common.shape(number..number + 1, flipped),
            uv_map: Some(UvMap::Planar(PlanarMap::new(p0, p3 - p0, p1 - p0))),
            positions: first..first + 4,
        });
        Ok(())
    }

    pub(super) fn add_quadric(&mut self, world: &World, occurrence: Occurrence) -> Result<()> {
        let common = self.common(world, occurrence);
        let sphere =
            world.get::<&Sphere>(occurrence.prototype).map(|sphere| sphere.in_world(&common));
        let disk = || world.get::<&Disk>(occurrence.prototype).map(|disk| disk.in_world(&common));
        let Ok(found) = sphere.or_else(|_| disk()) else { return Ok(()) };
        let (quadric, uv_map) = found?;
        let number = self.geometry.own() as u32;
        self.geometry.quadrics.push(quadric);
        self.shapes.push(ShapeOutput {
            entity: occurrence.entity,
            shape: common.shape(number..number + 1, false),
            uv_map: Some(uv_map),
            positions: 0..0,
        });
        Ok(())
    }

    /// Appends the points in world space; returns the number of the first.
    fn add_points(&mut self, common: &Common, points: &[DVec3]) -> Result<u32> {
        let first = self.geometry.positions.len();
        check_count(common, first + points.len(), "vertices")?;
        for &point in points {
            let point = common.transform.transform_point3(point);
            check_point(common, point)?;
            self.geometry.positions.push(point.as_vec3());
        }
        Ok(first as u32)
    }

    pub(super) fn finish(mut self) -> Output {
        self.shapes.sort_by_key(|s| s.shape.primitives.start);
        self.geometry.lights = lights(&self.shapes);
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

/// Values indexed like positions.
pub(super) fn by_position<T>(values: Vec<T>) -> CornerValues<T> {
    CornerValues { values, indices: None }
}

pub(super) fn corner_values<T>(attribute: Attribute<T>) -> CornerValues<T> {
    CornerValues { values: attribute.values, indices: attribute.indices }
}
