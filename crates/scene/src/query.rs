//! Queries of the world shared by several systems.

use std::path::PathBuf;

use hecs::{Entity, World};

use crate::components::{CutOut, JsonPath, Maps, Settings, TextureRef, TextureSource, View};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The settings of the whole scene.
pub(crate) fn settings(world: &World) -> Result<Settings> {
    world.query::<&Settings>().iter().next().cloned().ok_or_else(|| missing("Settings"))
}

/// The view of the camera.
pub(crate) fn view(world: &World) -> Result<View> {
    world.query::<&View>().iter().next().copied().ok_or_else(|| missing("View"))
}

/// The place of the entity in the scene file; empty if unknown.
pub(crate) fn json_path(world: &World, entity: Entity) -> String {
    world.get::<&JsonPath>(entity).map_or_else(|_| String::new(), |path| path.0.clone())
}

/// The files of all images that surfaces name.
pub(crate) fn images(world: &World) -> Vec<PathBuf> {
    let mut query = world.query::<(Option<&TextureRef>, Option<&Maps>, Option<&CutOut>)>();
    let sources = query.iter().flat_map(|(texture, maps, cutout)| {
        let maps = maps.into_iter().flat_map(Maps::all).map(|(_, map)| map);
        let textures = texture.into_iter().chain(maps).map(|texture| &texture.source);
        textures.chain(cutout.map(|cutout| &cutout.source))
    });
    let mut files: Vec<PathBuf> = sources
        .filter_map(|source| match source {
            TextureSource::File(path) => Some(path.clone()),
            TextureSource::Embedded { .. } => None,
        })
        .collect();
    files.sort_unstable();
    files.dedup();
    files
}

/// The error of a world without this component, which was not made by [`load`](crate::load).
pub(crate) fn missing(component: &str) -> Error {
    Error::new(ErrorKind::Scene, format!("the world has no entity with {component}"))
        .remedy("spawn one, as wavecrest_scene::load::load does")
}
