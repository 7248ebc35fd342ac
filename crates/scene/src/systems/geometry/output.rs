//! The output of the geometry system.

use hecs::Entity;

use wavecrest_core::geometry::Geometry;
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{Detail, MeshAttributes, Shape, UvMap};

/// A shape with its entity.
#[derive(Debug)]
pub struct ShapeOutput {
    /// The entity.
    pub entity: Entity,
    /// The shape.
    pub shape: Shape,
    /// The map from its points to texture coordinates, for a texture.
    pub uv_map: Option<UvMap>,
}

/// The output of this system.
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
    /// Drops data that no pass of the schedule reads: normals and colours of meshes that are not in
    /// view, unless the schedule requires them, and texture coordinates and tangents that neither
    /// textures nor `details` use.
    pub(in crate::systems) fn drop_unused(
        &mut self,
        schedule: Schedule,
        in_view: &[bool],
        details: &[Detail],
    ) {
        // Whether the step's data of a shape is needed.
        let shows =
            |step, in_view: bool| schedule.runs(step) && (in_view || schedule.is_needless(step));
        let mut used = vec![[false; 4]; self.meshes.len()];
        for (ShapeOutput { shape, .. }, in_view) in self.shapes.iter_mut().zip(in_view) {
            shape.smooth &= shows(Step::Normals, *in_view);
            shape.colored &= shows(Step::Colors, *in_view);
            if let Some([smooth, textured, colored, turned]) =
                shape.mesh.and_then(|i| used.get_mut(i as usize))
            {
                let detail = shape.detail.and_then(|detail| details.get(detail as usize));
                let looks_up = detail.is_some_and(|detail| detail.textures().next().is_some());
                *smooth |= shape.smooth;
                *textured |= shape.texture.is_some() || looks_up;
                *colored |= shape.colored;
                *turned |= detail.is_some_and(|detail| detail.normal.is_some());
            }
        }
        for (mesh, [smooth, textured, colored, turned]) in self.meshes.iter_mut().zip(used) {
            mesh.normals = mesh.normals.take().filter(|_| smooth);
            mesh.uvs = mesh.uvs.take().filter(|_| textured);
            mesh.colors = mesh.colors.take().filter(|_| colored);
            mesh.tangents = mesh.tangents.take().filter(|_| turned);
        }
    }
}
