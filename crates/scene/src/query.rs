//! What several systems ask the world for.

use hecs::{Entity, World};

use crate::components::{JsonPath, Settings, View};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// What holds for the whole scene.
pub(crate) fn settings(world: &World) -> Result<Settings> {
    world.query::<&Settings>().iter().next().cloned().ok_or_else(|| missing("Settings"))
}

/// The view of the camera.
pub(crate) fn view(world: &World) -> Result<View> {
    world.query::<&View>().iter().next().copied().ok_or_else(|| missing("View"))
}

/// Where in the scene file the entity stands; empty where that is not known.
pub(crate) fn json_path(world: &World, entity: Entity) -> String {
    world.get::<&JsonPath>(entity).map_or_else(|_| String::new(), |path| path.0.clone())
}

/// A world that was not made by [`load`](crate::load) lacks something.
pub(crate) fn missing(component: &str) -> Error {
    Error::new(ErrorKind::Scene, format!("the world has no entity with {component}"))
        .remedy("spawn one, as wavecrest_scene::load::load does")
}
