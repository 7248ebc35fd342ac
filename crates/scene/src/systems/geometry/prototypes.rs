//! What is shown where: shapes that have a prototype of their own, and instances, which show another's.
//!
//! A mesh that shapes show in two places or more is held once, in its own space, and becomes a prototype with
//! instances. Other prototypes are a few numbers, and a mesh that is shown once is best held where it is shown:
//! these become primitives of the scene's own. So do shapes of lights, whose triangles are sampled.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};
use hecs::{Entity, World};
use rayon::prelude::*;

use super::{Builder, Common, ShapeOutput, check_count, check_point, corner_values};
use crate::components::{AreaLight, Hidden, InstanceOf, Mesh, Order, Quad, Sphere, Triangle};
use crate::mesh::MeshData;
use crate::systems::frame;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::accel::geometry::Geometry;
use wavecrest_core::accel::instance::Instance;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::prepared::{MeshAttributes, Shape, UvMap};

/// A prototype whose middle is this many times as far from its origin as it is large has lost two bits: it is
/// moved there, so that rays are carried to small coordinates.
const FAR: f64 = 4.0;

/// A shape, or a light's, and what it shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Occurrence {
    /// The shape, or the instance.
    pub(super) entity: Entity,
    /// The entity that has the prototype: the same but for instances.
    pub(super) prototype: Entity,
    is_light: bool,
}

/// Everything that is shown, shapes before lights, in the order of the file.
#[derive(Debug)]
pub(super) struct Occurrences {
    all: Vec<Occurrence>,
    /// How often each mesh is still to be taken.
    uses: HashMap<Entity, usize>,
    /// Meshes that instances show, in the order in which they are first shown.
    shared: Vec<Entity>,
}

impl Occurrences {
    /// What the world shows; `flatten` has instances become primitives of the scene's own.
    pub(super) fn of(world: &World, flatten: bool) -> Self {
        let mut all: Vec<(bool, Order, Occurrence)> = world
            .query::<(Entity, Option<&Order>, Option<&AreaLight>, Option<&InstanceOf>)>()
            .iter()
            .filter(|(entity, .., instance)| {
                instance.is_some() || world.get::<&Hidden>(*entity).is_err()
            })
            .map(|(entity, order, light, instance)| {
                let prototype = instance.map_or(entity, |InstanceOf(prototype)| *prototype);
                let occurrence = Occurrence { entity, prototype, is_light: light.is_some() };
                (light.is_some(), order.copied().unwrap_or(Order(u32::MAX)), occurrence)
            })
            .collect();
        all.sort_by_key(|&(light, order, _)| (light, order));
        let all: Vec<Occurrence> = all.into_iter().map(|(.., occurrence)| occurrence).collect();
        let mut uses: HashMap<Entity, usize> = HashMap::new();
        let mut shown: HashMap<Entity, usize> = HashMap::new();
        let mut shared = Vec::new();
        for occurrence in all.iter().filter(|occurrence| has::<Mesh>(world, occurrence.prototype)) {
            *uses.entry(occurrence.prototype).or_default() += 1;
            let shown = shown.entry(occurrence.prototype).or_default();
            *shown += usize::from(!occurrence.is_light);
            if *shown == 2 && !occurrence.is_light && !flatten {
                shared.push(occurrence.prototype);
            }
        }
        Self { all, uses, shared }
    }

    /// Those that become triangles of the scene's own, as do those that become quads and spheres.
    pub(super) fn triangles(&self, world: &World) -> Vec<Occurrence> {
        let is_own = |occurrence: &Occurrence| {
            occurrence.is_light || !self.shared.contains(&occurrence.prototype)
        };
        self.pick(|occurrence| {
            has::<Triangle>(world, occurrence.prototype)
                || has::<Mesh>(world, occurrence.prototype) && is_own(occurrence)
        })
    }

    pub(super) fn quads(&self, world: &World) -> Vec<Occurrence> {
        self.pick(|occurrence| has::<Quad>(world, occurrence.prototype))
    }

    pub(super) fn spheres(&self, world: &World) -> Vec<Occurrence> {
        self.pick(|occurrence| has::<Sphere>(world, occurrence.prototype))
    }

    fn pick(&self, is: impl Fn(&Occurrence) -> bool) -> Vec<Occurrence> {
        self.all.iter().copied().filter(is).collect()
    }

    /// The mesh of `prototype`: moved out when nobody else will ask for it, copied before.
    pub(super) fn take(&mut self, world: &World, prototype: Entity) -> MeshData {
        let Ok(mut mesh) = world.get::<&mut Mesh>(prototype) else { return MeshData::default() };
        match self.uses.get_mut(&prototype) {
            Some(uses) if *uses > 1 => {
                *uses -= 1;
                mesh.data.clone()
            }
            _ => std::mem::take(&mut mesh.data),
        }
    }

    /// Meshes that become the scene's own triangles, as often as they do.
    pub(super) fn own_meshes(&self, world: &World) -> Vec<Entity> {
        let own = self.triangles(world).into_iter().map(|occurrence| occurrence.prototype);
        own.filter(|&prototype| has::<Mesh>(world, prototype)).collect()
    }
}

fn has<C: hecs::Component>(world: &World, entity: Entity) -> bool {
    world.get::<&C>(entity).is_ok()
}

/// A prototype that was taken in.
struct Prototype {
    number: u32,
    triangles: usize,
    bounds: Aabb,
    /// Where its origin lies in the mesh's own space.
    origin: DVec3,
    /// The entry of its attributes.
    mesh: Option<u32>,
}

impl Builder {
    /// Takes in the meshes that are shown more than once, and shows them.
    pub(super) fn add_instances(
        &mut self,
        world: &World,
        occurrences: &mut Occurrences,
    ) -> Result<()> {
        let shared = std::mem::take(&mut occurrences.shared);
        let mut prototypes: HashMap<Entity, Prototype> = HashMap::new();
        for &prototype in &shared {
            let of_prototype = |occurrence: &&Occurrence| {
                occurrence.prototype == prototype && !occurrence.is_light
            };
            let shown: Vec<Common> = occurrences
                .all
                .iter()
                .filter(of_prototype)
                .map(|occurrence| self.common(world, *occurrence))
                .collect();
            let smooth = shown.iter().any(|common| common.smooth);
            let textured = shown.iter().any(|common| common.textured);
            let mut mesh = occurrences.take(world, prototype);
            mesh.normals = mesh.normals.filter(|_| smooth);
            mesh.uvs = mesh.uvs.filter(|_| textured);
            prototypes.insert(prototype, self.add_prototype(mesh));
        }
        let mut next = self.geometry.own();
        for occurrence in occurrences.all.iter().filter(|occurrence| !occurrence.is_light) {
            let Some(prototype) = prototypes.get(&occurrence.prototype) else { continue };
            let common = self.common(world, *occurrence);
            next += prototype.triangles;
            check_count(&common, next, "triangles")?;
            self.add_instance(
                occurrence.entity,
                &common,
                prototype,
                (next - prototype.triangles) as u32,
            )?;
        }
        occurrences.shared = shared;
        Ok(())
    }

    fn add_prototype(&mut self, mut mesh: MeshData) -> Prototype {
        let bounds = |positions: &[glam::Vec3]| {
            let point = |&p: &glam::Vec3| Aabb { low: p, high: p };
            positions.par_iter().map(point).reduce(|| Aabb::EMPTY, Aabb::union)
        };
        let found = bounds(&mesh.positions);
        let (low, high) = (found.low.as_dvec3(), found.high.as_dvec3());
        let (middle, size) = ((low + high) / 2.0, (high - low).max_element());
        let mut origin = DVec3::ZERO;
        if size > 0.0 && middle.abs().max_element() > FAR * size {
            origin = frame::nearest(middle, size);
            mesh.positions.par_iter_mut().for_each(|p| *p = (p.as_dvec3() - origin).as_vec3());
        }
        let attributes = mesh.normals.is_some() || mesh.uvs.is_some();
        let prototype = Prototype {
            number: self.geometry.prototypes.len() as u32,
            triangles: mesh.triangles.len(),
            bounds: if origin == DVec3::ZERO { found } else { bounds(&mesh.positions) },
            origin,
            mesh: attributes.then_some(self.meshes.len() as u32),
        };
        if attributes {
            self.meshes.push(MeshAttributes {
                normals: mesh.normals.map(corner_values),
                uvs: mesh.uvs.map(corner_values),
                ..MeshAttributes::default()
            });
        }
        let MeshData { positions, triangles, .. } = mesh;
        self.geometry.prototypes.push(Geometry { positions, triangles, ..Geometry::default() });
        prototype
    }

    fn add_instance(
        &mut self,
        entity: Entity,
        common: &Common,
        prototype: &Prototype,
        first: u32,
    ) -> Result<()> {
        let to_world = common.transform * DAffine3::from_translation(prototype.origin);
        for corner in 0..8 {
            let pick = |k: usize| {
                if corner >> k & 1 == 0 { prototype.bounds.low } else { prototype.bounds.high }
            };
            let corner = DVec3::new(pick(0).x.into(), pick(1).y.into(), pick(2).z.into());
            check_point(common, to_world.transform_point3(corner))?;
        }
        if !to_world.inverse().is_finite() {
            let message = "the transform flattens space, so that it cannot be undone";
            return Err(Error::new(ErrorKind::Scene, message)
                .at(format!("{}.transform", common.place))
                .remedy("give every axis a scale other than 0"));
        }
        let range = first..first + prototype.triangles as u32;
        let has_normals = prototype.mesh.is_some_and(|i| self.meshes[i as usize].normals.is_some());
        let shape = Shape {
            smooth: common.smooth && has_normals,
            mesh: prototype.mesh,
            ..common.shape(range, common.mirrors())
        };
        self.geometry.instances.push(Instance::new(
            prototype.number,
            first,
            to_world,
            &prototype.bounds,
        ));
        self.shapes.push(ShapeOutput { entity, shape, uv_map: Some(UvMap::Mesh) });
        Ok(())
    }
}
