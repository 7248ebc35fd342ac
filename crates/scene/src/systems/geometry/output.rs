//! What the geometry system makes.

use hecs::Entity;

use wavecrest_core::accel::geometry::Geometry;
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{MeshAttributes, Shape, UvMap};

/// A shape, and the entity it was.
#[derive(Debug)]
pub struct ShapeOutput {
    /// The entity.
    pub entity: Entity,
    /// The shape.
    pub shape: Shape,
    /// How its points become texture coordinates, should it wear a texture.
    pub uv_map: Option<UvMap>,
}

/// What this system makes.
#[derive(Debug)]
pub struct Output {
    /// The primitives.
    pub geometry: Geometry,
    /// The shapes, by the number of their first primitive.
    pub shapes: Vec<ShapeOutput>,
    /// Attributes of meshes.
    pub meshes: Vec<MeshAttributes>,
}

impl Output {
    /// Drops what no pass of the schedule reads: normals, and texture coordinates of shapes whose
    /// texture was not decoded.
    pub(in crate::systems) fn drop_unused(&mut self, schedule: Schedule) {
        let normals = schedule.runs(Step::Normals);
        let mut textured = vec![false; self.meshes.len()];
        for ShapeOutput { shape, .. } in &mut self.shapes {
            shape.smooth &= normals;
            if let Some(mesh) = shape.mesh.and_then(|i| textured.get_mut(i as usize)) {
                *mesh |= shape.texture.is_some();
            }
        }
        for (mesh, textured) in self.meshes.iter_mut().zip(textured) {
            mesh.normals = mesh.normals.take().filter(|_| normals);
            mesh.uvs = mesh.uvs.take().filter(|_| textured);
        }
    }
}
