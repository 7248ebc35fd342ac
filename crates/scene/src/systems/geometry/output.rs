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
    /// Drops what no pass of the schedule reads: normals of meshes that are not in view, unless the schedule
    /// requires them, and texture coordinates of shapes without an image.
    pub(in crate::systems) fn drop_unused(&mut self, schedule: Schedule, in_view: &[bool]) {
        let (normals, all) = (schedule.runs(Step::Normals), schedule.is_needless(Step::Normals));
        let mut used = vec![[false; 2]; self.meshes.len()];
        for (ShapeOutput { shape, .. }, in_view) in self.shapes.iter_mut().zip(in_view) {
            shape.smooth &= normals && (*in_view || all);
            if let Some([smooth, textured]) = shape.mesh.and_then(|i| used.get_mut(i as usize)) {
                *smooth |= shape.smooth;
                *textured |= shape.texture.is_some();
            }
        }
        for (mesh, [smooth, textured]) in self.meshes.iter_mut().zip(used) {
            mesh.normals = mesh.normals.take().filter(|_| smooth);
            mesh.uvs = mesh.uvs.take().filter(|_| textured);
        }
    }
}
