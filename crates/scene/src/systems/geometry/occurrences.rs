//! The occurrences of shapes: with their own prototype, or as instances of another's.
//!
//! A mesh with two places or more is stored once, in its own space, and becomes a prototype with
//! instances. Other prototypes are a few numbers, and a mesh with one place is best stored there:
//! these become primitives of the scene's own. So do shapes of lights, whose triangles are sampled,
//! and transparent ones, all of which a shadow ray must find.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};
use hecs::{Entity, Query, Satisfies, View, World};

use super::occurrence::{Form, Occurrence};
use crate::components::{
    AreaLight, Channels, CutOut, Disk, Facing, Hidden, InstanceOf, JsonPath, Map, Maps, Mesh,
    Order, Quad, Shading, Sides, Sphere, TextureRef, Transform, Transparency, Triangle,
};
use crate::image_file::has_alpha;

/// What a shape or an instance has of its own.
pub(super) type Shown<'w> = (
    Entity,
    Option<&'w Order>,
    Option<&'w JsonPath>,
    Option<&'w InstanceOf>,
    Satisfies<&'w Hidden>,
    Option<&'w AreaLight>,
    Option<&'w Transform>,
    Option<&'w Sides>,
    Option<&'w Shading>,
    (Satisfies<&'w TextureRef>, Satisfies<&'w CutOut>, Option<&'w Maps>, Option<&'w Transparency>),
);

/// The geometry of a prototype.
pub(super) type Geometries<'w> = (
    Option<&'w Sphere>,
    Option<&'w Disk>,
    Option<&'w Quad>,
    Option<&'w Triangle>,
    Satisfies<&'w Mesh>,
    Option<&'w Transform>,
    Option<&'w Facing>,
);

/// Everything to render, shapes before lights, in the order of the file.
#[derive(Debug)]
pub(super) struct Occurrences<'w> {
    pub(super) all: Vec<Occurrence<'w>>,
    uses: HashMap<Entity, MeshUses>,
    /// Meshes with several instances, in the order of each one's second instance.
    pub(super) shared: Vec<Entity>,
}

/// The uses of a mesh.
#[derive(Debug, Default)]
pub(super) struct MeshUses {
    /// How many more times it will be taken.
    left: usize,
    /// Number of its instances, without those that shadow rays pass.
    instances: usize,
    is_shared: bool,
    /// Whether any of them asks for normals, for texture coordinates, and has a normal map.
    pub(super) smooth: bool,
    pub(super) textured: bool,
    pub(super) normal_mapped: bool,
}

/// The occurrences of what is `shown`, in the order of the file, shapes before lights, moved by `-origin`.
/// Instances name their prototypes, which are looked up. Of what has no opacity nothing is shown.
pub(super) fn of<'w>(
    shown: impl Iterator<Item = <Shown<'w> as Query>::Item<'w>>,
    geometries: &'w View<'_, Geometries<'_>>,
    origin: DVec3,
) -> Vec<Occurrence<'w>> {
    let mut all: Vec<(Order, Occurrence<'_>)> = shown
        .filter_map(
            |(entity, order, place, instance, is_hidden, light, own, sides, shading, worn)| {
                let prototype = instance.map_or(entity, |InstanceOf(prototype)| *prototype);
                let (has_texture, is_cut_out, maps, transparency) = worn;
                let is_clear = transparency.is_some_and(Transparency::is_clear);
                if is_clear || is_hidden && instance.is_none() {
                    return None;
                }
                let (sphere, disk, quad, triangle, is_mesh, of_prototype, facing) =
                    geometries.get(prototype)?;
                let form = (sphere.map(Form::Sphere))
                    .or(disk.map(Form::Disk))
                    .or(quad.map(Form::Quad))
                    .or(triangle.map(Form::Triangle))
                    .or(is_mesh.then_some(Form::Mesh))?;
                let matrix =
                    |transform: Option<&Transform>| transform.map_or(DAffine3::IDENTITY, |t| t.0);
                let mut transform = matrix(own);
                if instance.is_some() {
                    transform *= matrix(of_prototype);
                }
                transform.translation -= origin;
                let is_surface = light.is_none();
                let normal = maps.and_then(|maps| maps.normal.as_ref());
                let occurrence = Occurrence {
                    entity,
                    prototype,
                    form,
                    light: light.map(|light| light.color.as_vec3()),
                    is_transparent: is_surface && is_transparent(transparency, maps),
                    is_cut_out,
                    is_mirror: true,
                    is_seen: true,
                    is_met: true,
                    transform,
                    facing: facing.copied(),
                    sides: sides.copied().unwrap_or(Sides::Both),
                    smooth: is_surface && shading == Some(&Shading::Smooth),
                    textured: is_surface && (has_texture || is_cut_out || maps.is_some()),
                    normal_mapped: is_surface && normal.is_some_and(Map::has_effect),
                    place: place.map_or("", |path| &path.0),
                };
                Some((order.copied().unwrap_or(Order(u32::MAX)), occurrence))
            },
        )
        .collect();
    all.sort_by_key(|(order, occurrence)| (occurrence.light.is_some(), *order));
    all.into_iter().map(|(_, occurrence)| occurrence).collect()
}

impl<'w> Occurrences<'w> {
    /// Counts the uses of meshes; `flatten` turns instances into primitives of the scene's own.
    pub(super) fn new(all: Vec<Occurrence<'w>>, flatten: bool) -> Self {
        let mut uses: HashMap<Entity, MeshUses> = HashMap::new();
        let mut shared = Vec::new();
        for occurrence in all.iter().filter(|occurrence| occurrence.is_mesh()) {
            let of = uses.entry(occurrence.prototype).or_default();
            of.smooth |= occurrence.smooth;
            of.textured |= occurrence.textured;
            of.normal_mapped |= occurrence.normal_mapped;
            of.instances += usize::from(!occurrence.is_passed());
            if of.instances < 2 || occurrence.is_passed() || flatten {
                of.left += 1;
            } else if !of.is_shared {
                of.is_shared = true;
                shared.push(occurrence.prototype);
            }
        }
        Self { all, uses, shared }
    }

    /// Whether the occurrence is an instance of a mesh that is stored once.
    pub(super) fn is_instance(&self, occurrence: &Occurrence<'_>) -> bool {
        !occurrence.is_passed()
            && self.uses.get(&occurrence.prototype).is_some_and(|of| of.is_shared)
    }

    /// The mesh of `prototype` and its uses: moved out at its last use, copied before.
    pub(super) fn take(&mut self, world: &World, prototype: Entity) -> (Mesh, &MeshUses) {
        let of = self.uses.entry(prototype).or_default();
        let Ok(mut mesh) = world.get::<&mut Mesh>(prototype) else { return (Mesh::default(), of) };
        of.left = of.left.saturating_sub(1);
        let mesh = if of.left > 0 { Mesh::clone(&mesh) } else { std::mem::take(&mut *mesh) };
        (mesh, of)
    }
}

/// Whether light may go through a surface, as far as the headers of images tell.
fn is_transparent(transparency: Option<&Transparency>, maps: Option<&Maps>) -> bool {
    let may_vary = |texture: &TextureRef| {
        texture.channels == Channels::Color || has_alpha(&texture.look_up.source)
    };
    let opacity = maps.and_then(|maps| maps.opacity.as_ref()?.texture.as_ref());
    transparency.is_some_and(Transparency::has_effect) || opacity.is_some_and(may_vary)
}
