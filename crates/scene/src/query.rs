//! Queries of the world shared by several systems.

use std::path::{Path, PathBuf};

use hecs::{Component, Entity, EntityRef, Or, World};

use crate::components::{
    AreaLight, CutOut, DirectionalLight, Disk, Environment, InstanceOf, JsonPath, Maps, Mesh,
    MeshFile, Order, PointLight, Quad, Settings, Sphere, TextureRef, Triangle, View,
};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The entities that have what `Q` takes, in the order of the file.
pub(crate) fn ordered<Q: hecs::Query>(world: &World) -> Vec<EntityRef<'_>> {
    let those = world.iter().filter(EntityRef::satisfies::<(&Order, Q)>);
    let mut those: Vec<EntityRef<'_>> = those.collect();
    those.sort_by_key(|entity| entity.get::<&Order>().map(|order| *order));
    those
}

type AnyLight<'w> = Or<Or<&'w PointLight, &'w DirectionalLight>, &'w AreaLight>;

/// Any geometry of a shape.
type AnyGeometry<'w> =
    Or<Or<Or<&'w Sphere, &'w Disk>, &'w Quad>, Or<&'w Triangle, Or<&'w Mesh, &'w MeshFile>>>;

/// The lights, in the order of the file.
pub(crate) fn lights(world: &World) -> Vec<EntityRef<'_>> {
    ordered::<AnyLight<'_>>(world)
}

/// The shapes, without those of lights and without instances, in the order of the file.
pub(crate) fn shapes(world: &World) -> Vec<EntityRef<'_>> {
    ordered::<hecs::Without<AnyGeometry<'_>, Or<&AreaLight, &InstanceOf>>>(world)
}

/// The settings of the whole scene.
pub(crate) fn settings(world: &World) -> Result<Settings> {
    world.query::<&Settings>().iter().next().cloned().ok_or_else(|| missing("Settings"))
}

/// The view of the camera.
pub(crate) fn view(world: &World) -> Result<View> {
    world.query::<&View>().iter().next().copied().ok_or_else(|| missing("View"))
}

/// Changes every `C`.
pub(crate) fn change<C: Component>(world: &mut World, change: impl FnMut(&mut C)) {
    world.query_mut::<&mut C>().into_iter().for_each(change);
}

/// Removes every `C`.
pub(crate) fn remove<C: Component>(world: &mut World) {
    let those = world.query_mut::<(Entity, &C)>().into_iter().map(|(entity, _)| entity);
    let those: Vec<Entity> = those.collect();
    those.into_iter().for_each(|entity| drop(world.remove_one::<C>(entity)));
}

/// The place of the entity in the scene file; empty if unknown.
pub(crate) fn json_path(world: &World, entity: Entity) -> String {
    world.get::<&JsonPath>(entity).map_or_else(|_| String::new(), |path| path.0.clone())
}

/// What names images: a surface, or the environment.
pub(crate) type Pictured<'w> =
    (Option<&'w TextureRef>, Option<&'w Maps>, Option<&'w Environment>, Option<&'w CutOut>);

/// The files of all images that an entity names.
pub(crate) fn images_of<'w>(
    (texture, maps, around, cutout): Pictured<'w>,
) -> impl Iterator<Item = &'w Path> + use<'w> {
    let maps = maps.into_iter().flat_map(Maps::all).filter_map(|(_, map)| map.texture.as_ref());
    let around = around.and_then(|around| around.image.as_ref());
    let look_ups = texture.into_iter().chain(maps).chain(around).map(|texture| &texture.look_up);
    let all = look_ups.chain(cutout.and_then(|cutout| cutout.look_up.as_ref()));
    all.filter_map(|look_up| look_up.source.file())
}

/// The files of all images that a world names.
pub(crate) fn images(world: &World) -> Vec<PathBuf> {
    let mut query = world.query::<Pictured<'_>>();
    let mut files: Vec<PathBuf> = query.iter().flat_map(images_of).map(Path::to_owned).collect();
    files.sort_unstable();
    files.dedup();
    files
}

/// The error of a world without this component, which was not made by [`load`](crate::load).
pub(crate) fn missing(component: &str) -> Error {
    Error::new(ErrorKind::Scene, format!("the world has no entity with {component}"))
        .remedy("spawn one, as wavecrest_scene::load::load does")
}
