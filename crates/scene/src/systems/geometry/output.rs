//! The output of the geometry system.

use hecs::Entity;

use wavecrest_core::geometry::Geometry;
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{Class, MeshAttributes, Property, Shape, UvMap};

use crate::systems::reach::Faces;

/// A shape with its entity.
#[derive(Debug)]
pub(crate) struct ShapeOutput {
    /// The entity.
    pub entity: Entity,
    /// The shape.
    pub shape: Shape,
    /// The map from its points to texture coordinates.
    pub uv_map: UvMap,
    /// Whether its material lets light through.
    pub is_transparent: bool,
    /// Whether its mirror, if it is one, may show anything.
    pub is_mirror: bool,
    /// Whether camera rays may meet it, or any rays; otherwise it has no primitives.
    pub is_seen: bool,
    pub is_met: bool,
}

/// The output of this system.
#[derive(Debug)]
pub(crate) struct Output {
    /// The primitives.
    pub geometry: Geometry,
    /// The shapes, by the number of their first primitive.
    pub shapes: Vec<ShapeOutput>,
    /// Attributes of meshes.
    pub meshes: Vec<MeshAttributes>,
}

impl Output {
    /// Lets shadow rays pass these shapes, and those of lights.
    pub(in crate::systems) fn pass(&mut self, transparent: &[bool]) {
        let (mut passed, mut through) = (Vec::new(), Vec::new());
        for (ShapeOutput { shape, .. }, is_transparent) in self.shapes.iter().zip(transparent) {
            let primitives = shape.primitives.clone();
            if primitives.is_empty() || !is_transparent && shape.light.is_none() {
                continue;
            }
            if shape.light.is_none() {
                through.push(primitives.clone());
            }
            passed.push(primitives);
        }
        (self.geometry.passed, self.geometry.transparent) = (passed, through);
    }

    /// Drops data that no pass of the schedule reads: normals and colours of meshes that are not in
    /// view, unless the schedule requires them, and texture coordinates and tangents that neither
    /// maps of `classes` use.
    pub(in crate::systems) fn drop_unused(
        &mut self,
        schedule: Schedule,
        in_view: &[Option<Faces>],
        classes: &[Class],
    ) {
        // Whether the step's data of a shape is needed.
        let shows = |step, in_view: bool| {
            schedule.runs(step) && (in_view || schedule.is_unconditional(step))
        };
        let mut used = vec![[false; 5]; self.meshes.len()];
        for (ShapeOutput { shape, .. }, in_view) in self.shapes.iter_mut().zip(in_view) {
            shape.smooth &= shows(Step::Normals, in_view.is_some());
            let Class { maps, transparency, .. } = &classes[shape.class as usize];
            let is_tinted = transparency.is_some_and(|through| through.tinted);
            shape.colored &= shows(Step::Colors, in_view.is_some() || is_tinted);
            if let Some([smooth, textured, colored, turned, fades]) =
                shape.mesh.and_then(|i| used.get_mut(i as usize))
            {
                let is_normal = |property| matches!(property, Property::Normal { .. });
                *smooth |= shape.smooth;
                *textured |= maps.iter().any(|map| map.texture.is_some());
                *colored |= shape.colored;
                *fades |= maps.iter().any(|map| map.property == Property::Alpha);
                *turned |= maps.iter().any(|map| is_normal(map.property));
            }
        }
        for (mesh, [smooth, textured, colored, turned, fades]) in self.meshes.iter_mut().zip(used) {
            mesh.normals = mesh.normals.take().filter(|_| smooth);
            mesh.uvs = mesh.uvs.take().filter(|_| textured);
            mesh.colors = mesh.colors.take().filter(|_| colored);
            mesh.alphas = mesh.alphas.take().filter(|_| fades);
            mesh.tangents = mesh.tangents.take().filter(|_| turned);
        }
    }
}
