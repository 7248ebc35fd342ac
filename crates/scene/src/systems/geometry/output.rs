//! The output of the geometry system.

use std::ops::Range;

use hecs::Entity;
use rayon::prelude::*;

use wavecrest_core::geometry::{Geometry, Primitive};
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
    /// Its own positions, in the order of shapes.
    pub positions: Range<u32>,
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
    /// Drops the primitives of shapes that no ray can meet. Their shapes stay, without any, so that
    /// the others keep their numbers.
    pub(in crate::systems) fn drop_unmet(&mut self, met: &[bool]) {
        if !met.contains(&false) {
            return;
        }
        let Self { geometry, shapes, meshes } = self;
        let mut kept = Geometry::default();
        let (mut positions, mut triangles, mut next) = (0, 0, 0);
        for (ShapeOutput { shape, positions: own, .. }, met) in shapes.iter_mut().zip(met) {
            let range = shape.primitives.clone();
            let Some(first) = range.clone().next().filter(|_| *met) else {
                (shape.primitives, shape.mesh, *own) = (next..next, None, 0..0);
                continue;
            };
            let count = range.len();
            // Quadrics and instances have no positions.
            let before = positions;
            let by = own.start.saturating_sub(before);
            geometry.positions.copy_within(own.start as usize..own.end as usize, before as usize);
            positions += own.len() as u32;
            *own = before..positions;
            match geometry.primitive(first) {
                // In place: they may be many.
                Primitive::Triangle(i) => {
                    geometry.triangles.copy_within(i..i + count, triangles);
                    let moved = geometry.triangles[triangles..][..count].par_iter_mut();
                    moved.for_each(|corners| *corners = corners.map(|vertex| vertex - by));
                    if let Some(mesh) = shape.mesh.and_then(|i| meshes.get_mut(i as usize)) {
                        (mesh.first_triangle, mesh.first_position) = (next, before);
                    }
                    triangles += count;
                }
                Primitive::Quad(i) => {
                    kept.quads.push(geometry.quads[i].map(|vertex| vertex - by));
                }
                Primitive::Quadric(i) => kept.quadrics.push(geometry.quadrics[i]),
                Primitive::Instanced(instanced) => {
                    kept.instances.push(geometry.instance(instanced).0.numbered_from(next));
                }
            }
            shape.primitives = next..next + count as u32;
            next = shape.primitives.end;
        }
        geometry.positions.truncate(positions as usize);
        geometry.triangles.truncate(triangles);
        geometry.positions.shrink_to_fit();
        geometry.triangles.shrink_to_fit();
        (geometry.quads, geometry.quadrics) = (kept.quads, kept.quadrics);
        geometry.instances = kept.instances;
        let is_shown = |number| geometry.instances.iter().any(|of| of.prototype() == number);
        let unused = (0..geometry.prototypes.len()).filter(|&number| !is_shown(number));
        for number in unused.collect::<Vec<_>>() {
            let precision = geometry.precision;
            geometry.prototypes[number] = Geometry { precision, ..Geometry::default() };
        }
    }

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
