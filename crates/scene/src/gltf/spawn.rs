//! The entities that primitives with triangles become.

use std::path::Path;

use glam::{DAffine3, DVec3};
use hecs::{EntityBuilder, World};

use super::material::MaterialElement;
use crate::components::{
    AreaLight, CutOut, Falloff, Hidden, InstanceOf, JsonPath, Maps, Mesh, Name, Order, Sampling,
    Shading, TextureRef, Transform,
};
use crate::mesh::MeshData;
use crate::staging::VisibleMesh;
use crate::systems::cutouts::Masks;

/// Points along each side of the grid on a mesh light; each pixel has several rays.
const LIGHT_SAMPLES: u32 = 3;

/// A primitive with triangles, and the nodes that show it.
pub(super) struct Spawned {
    pub(super) path: String,
    pub(super) name: Option<String>,
    pub(super) mesh: MeshData,
    /// Where each place of the mesh has its origin.
    pub(super) origin: DVec3,
    pub(super) surface: MaterialElement,
    pub(super) texture: Option<TextureRef>,
    pub(super) cutout: Option<CutOut>,
    pub(super) maps: Maps,
    pub(super) uses: Vec<NodeUse>,
}

/// A node that shows a primitive.
pub(super) struct NodeUse {
    pub(super) path: String,
    pub(super) name: Option<String>,
    pub(super) world: DAffine3,
}

impl Spawned {
    /// What is visible of it.
    pub(super) fn visible(&self, images: &mut Masks<'_>) -> VisibleMesh<'_> {
        let surface = (self.cutout.as_ref(), &self.maps);
        VisibleMesh::of_uses(&self.mesh, surface, self.uses.len(), images)
    }

    /// Adds a shape of the `file` if one node shows the primitive, otherwise a hidden shape and an
    /// instance for each node.
    pub(super) fn add_shapes(
        self,
        file: &Path,
        order: &mut impl Iterator<Item = Order>,
        world: &mut World,
    ) {
        let is_smooth = self.mesh.normals.is_some();
        let shading = if is_smooth { Shading::Smooth } else { Shading::Flat };
        let material = self.surface.material(self.maps.emission.as_ref());
        let varies = self.texture.is_some() || self.mesh.colors.is_some();
        let mut transparency = self.surface.transparency(varies);
        transparency.vertex_alpha = self.cutout.is_none() && self.mesh.alphas.is_some();
        let mesh = Mesh { data: self.mesh, points: None, file: Some(file.to_owned()) };
        let mut shape = EntityBuilder::new();
        shape.add_bundle((self.surface.sides, shading, material, mesh));
        if transparency.has_effect() {
            shape.add(transparency);
        }
        self.texture.map(|texture| shape.add(texture));
        self.cutout.map(|cutout| shape.add(cutout));
        if self.maps != Maps::default() {
            shape.add(self.maps);
        }
        order.next().map(|order| shape.add(order));
        let name = |entity: &mut EntityBuilder, name: Option<String>| {
            name.map(|name| entity.add(Name(name)));
        };
        match <[NodeUse; 1]>::try_from(self.uses) {
            Ok([one]) => {
                name(&mut shape, one.name);
                shape.add_bundle((JsonPath(one.path), Transform(one.world)));
                world.spawn(shape.build());
            }
            Err(uses) => {
                name(&mut shape, self.name);
                shape.add_bundle((JsonPath(self.path), Hidden));
                let of = InstanceOf(world.spawn(shape.build()));
                for (one, order) in uses.into_iter().zip(order) {
                    let mut instance = EntityBuilder::new();
                    name(&mut instance, one.name);
                    instance.add_bundle((order, of, JsonPath(one.path), Transform(one.world)));
                    world.spawn(instance.build());
                }
            }
        }
    }

    /// Adds a light for each node that shows the primitive, unless it has no area.
    pub(super) fn add_lights(
        self,
        exposure: f64,
        file: &Path,
        order: &mut impl Iterator<Item = Order>,
        world: &mut World,
    ) {
        for NodeUse { path, name, world: place } in self.uses {
            let (area, _) = extent(&self.mesh, &place);
            let data = MeshData {
                positions: self.mesh.positions.clone(),
                triangles: self.mesh.triangles.clone(),
                ..MeshData::default()
            };
            let mesh = Mesh { data, points: None, file: Some(file.to_owned()) };
            if area == 0.0 || !mesh.has_area() {
                continue;
            }
            let light = AreaLight {
                intensity: area,
                color: self.surface.emission * exposure,
                falloff: Falloff::InverseSquare,
                sampling: Sampling::Jittered,
                samples: LIGHT_SAMPLES,
            };
            let mut entity = EntityBuilder::new();
            order.next().map(|order| entity.add(order));
            name.map(|name| entity.add(Name(name)));
            entity.add_bundle((JsonPath(path), light, mesh, Transform(place)));
            world.spawn(entity.build());
        }
    }
}

/// The area of a mesh, and the centroid of its triangles weighted by area.
pub(super) fn extent(mesh: &MeshData, world: &DAffine3) -> (f64, DVec3) {
    let mut area = 0.0;
    let mut middle = DVec3::ZERO;
    for triangle in &mesh.triangles {
        let point = |i: u32| world.transform_point3(mesh.positions[i as usize].as_dvec3());
        let [a, b, c] = triangle.map(point);
        let own = (b - a).cross(c - a).length() / 2.0;
        area += own;
        middle += (a + b + c) * (own / 3.0);
    }
    (area, if area > 0.0 { middle / area } else { world.translation })
}
