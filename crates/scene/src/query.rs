//! Queries of the world shared by several systems.

use hecs::{Entity, World};

use crate::components::{JsonPath, Settings, View};
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

/// The error of a world without this component, which was not made by [`load`](crate::load).
pub(crate) fn missing(component: &str) -> Error {
    Error::new(ErrorKind::Scene, format!("the world has no entity with {component}"))
        .remedy("spawn one, as wavecrest_scene::load::load does")
}
