//! Overrides of a scene file's global settings, for comparisons.

use hecs::World;

use crate::components::{Filter, Maps, Settings, TextureRef};
use crate::query::change;

/// Overrides of the file's values; `None` keeps them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Overrides {
    /// Largest number of bounces.
    pub bounces: Option<u32>,
    /// The filter of every texture.
    pub filter: Option<Filter>,
}

/// Applies `overrides` to the world, before the systems run.
pub fn apply(world: &mut World, overrides: &Overrides) {
    if let Some(bounces) = overrides.bounces {
        change(world, |settings: &mut Settings| settings.bounces = bounces);
    }
    if let Some(filter) = overrides.filter {
        change(world, |texture: &mut TextureRef| texture.look_up.filter = filter);
        change(world, |maps: &mut Maps| {
            let textures = maps.all_mut().filter_map(|map| map.texture.as_mut());
            textures.for_each(|texture| texture.look_up.filter = filter);
        });
    }
}
