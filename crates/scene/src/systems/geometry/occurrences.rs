//! The occurrences of shapes: with their own prototype, or as instances of another's.
//!
//! A mesh with two places or more is stored once, in its own space, and becomes a prototype with
//! instances. Other prototypes are a few numbers, and a mesh with one place is best stored there:
//! these become primitives of the scene's own. So do shapes of lights, whose triangles are sampled.

use std::collections::HashMap;

use hecs::{Entity, World};

use crate::components::{AreaLight, Disk, Hidden, InstanceOf, Mesh, Order, Quad, Sphere, Triangle};

/// A shape, possibly of a light, and its prototype.
#[derive(Clone, Copy, Debug)]
pub(super) struct Occurrence {
    /// The shape, or the instance.
    pub(super) entity: Entity,
    /// The entity with the prototype: the same except for instances.
    pub(super) prototype: Entity,
    pub(super) is_light: bool,
}

/// Everything to render, shapes before lights, in the order of the file.
#[derive(Debug)]
pub(super) struct Occurrences {
    pub(super) all: Vec<Occurrence>,
    /// How many more times each mesh will be taken.
    uses: HashMap<Entity, usize>,
    /// Meshes with several instances, in the order of each one's second instance.
    pub(super) shared: Vec<Entity>,
}

impl Occurrences {
    /// The occurrences in the world; `flatten` turns instances into primitives of the scene's own.
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
        let mut instances: HashMap<Entity, usize> = HashMap::new();
        let mut shared = Vec::new();
        for occurrence in all.iter().filter(|occurrence| has::<Mesh>(world, occurrence.prototype)) {
            *uses.entry(occurrence.prototype).or_default() += 1;
            let count = instances.entry(occurrence.prototype).or_default();
            *count += usize::from(!occurrence.is_light);
            if *count == 2 && !occurrence.is_light && !flatten {
                shared.push(occurrence.prototype);
            }
        }
        Self { all, uses, shared }
    }

    /// Those that become triangles of the scene's own; likewise for quads and quadrics below.
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

    pub(super) fn quadrics(&self, world: &World) -> Vec<Occurrence> {
        self.pick(|&Occurrence { prototype, .. }| {
            has::<Sphere>(world, prototype) || has::<Disk>(world, prototype)
        })
    }

    fn pick(&self, is: impl Fn(&Occurrence) -> bool) -> Vec<Occurrence> {
        self.all.iter().copied().filter(is).collect()
    }

    /// The mesh of `prototype`: moved out at its last use, copied before.
    pub(super) fn take(&mut self, world: &World, prototype: Entity) -> Mesh {
        let Ok(mut mesh) = world.get::<&mut Mesh>(prototype) else { return Mesh::default() };
        match self.uses.get_mut(&prototype) {
            Some(uses) if *uses > 1 => {
                *uses -= 1;
                Mesh::clone(&mesh)
            }
            _ => std::mem::take(&mut mesh),
        }
    }

    /// Meshes that become the scene's own triangles, once for each occurrence.
    pub(super) fn own_meshes(&self, world: &World) -> Vec<Entity> {
        let own = self.triangles(world).into_iter().map(|occurrence| occurrence.prototype);
        own.filter(|&prototype| has::<Mesh>(world, prototype)).collect()
    }
}

fn has<C: hecs::Component>(world: &World, entity: Entity) -> bool {
    world.get::<&C>(entity).is_ok()
}
