//! Other values for what a scene file says of a whole scene, for those who compare them.

use hecs::World;

use crate::components::{Filter, Settings, TextureRef};

/// What takes the place of the file's values; `None` leaves them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Overrides {
    /// The greatest number of mirror bounces.
    pub bounces: Option<u32>,
    /// How every texture is filtered.
    pub filter: Option<Filter>,
}

/// Puts `overrides` into the world, before the systems run.
pub fn apply(world: &mut World, overrides: &Overrides) {
    if let Some(bounces) = overrides.bounces {
        world.query_mut::<&mut Settings>().into_iter().for_each(|s| s.bounces = bounces);
    }
    if let Some(filter) = overrides.filter {
        world.query_mut::<&mut TextureRef>().into_iter().for_each(|t| t.filter = filter);
    }
}
