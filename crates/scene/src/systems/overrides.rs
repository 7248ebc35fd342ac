//! Overrides of a scene file's global settings, for comparisons.

use hecs::{Entity, World};

use crate::components::{
    AreaLight, DirectionalLight, Filter, Maps, PointLight, Settings, Sky, TextureRef, ThinLens,
    Transparency, View,
};

/// Overrides of the file's values; `None` keeps them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Overrides {
    /// Largest number of bounces.
    pub bounces: Option<u32>,
    /// The filter of every texture.
    pub filter: Option<Filter>,
    /// The scene is rendered without this layer, and without all before it in [`Layer::ALL`].
    pub without: Option<Layer>,
}

wavecrest_base::choices! {
    /// The effects of a scene beyond one ray through the centre of each pixel, in the order of
    /// their removal.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Layer {
        /// Light through surfaces, which become opaque.
        Transparency = "transparency",
        /// Mirror rays.
        Mirrors = "mirrors",
        /// Textures: the diffuse colour takes their place.
        Textures = "textures",
        /// What is in the way of ambient light.
        Occlusion = "ambient occlusion",
        /// Points on area lights: all but one.
        SoftShadows = "soft shadows",
        /// Lights and their shadows. What shines is still seen, and ambient light stays.
        Lights = "lights and shadows",
        /// The extent of the lens, and all its rays.
        Lens = "depth of field",
        /// Rays in a pixel: all but the one through its middle.
        Antialiasing = "antialiasing",
    }
}

/// Applies `overrides` to the world, before the systems run.
pub fn apply(world: &mut World, overrides: &Overrides) {
    if let Some(bounces) = overrides.bounces {
        world.query_mut::<&mut Settings>().into_iter().for_each(|s| s.bounces = bounces);
    }
    if let Some(filter) = overrides.filter {
        world.query_mut::<&mut TextureRef>().into_iter().for_each(|t| t.look_up.filter = filter);
        let all = world.query_mut::<&mut Maps>().into_iter().flat_map(Maps::all_mut);
        all.for_each(|texture| texture.look_up.filter = filter);
    }
    let last = overrides.without;
    Layer::ALL.into_iter().filter(|layer| Some(*layer) <= last).for_each(|l| l.leave(world));
}

impl Layer {
    /// Removes the layer from the world.
    fn leave(self, world: &mut World) {
        match self {
            Self::Transparency => remove::<Transparency>(world),
            Self::Mirrors => {
                world.query_mut::<&mut Settings>().into_iter().for_each(|s| s.bounces = 0);
            }
            Self::Textures => remove::<TextureRef>(world),
            Self::Occlusion => {
                world.query_mut::<&mut Sky>().into_iter().for_each(|sky| sky.samples = 0);
            }
            Self::SoftShadows => {
                world.query_mut::<&mut AreaLight>().into_iter().for_each(|l| l.samples = 1);
                let distant = world.query_mut::<&mut DirectionalLight>();
                distant.into_iter().for_each(|l| l.samples = 1);
            }
            Self::Lights => {
                world.query_mut::<&mut AreaLight>().into_iter().for_each(|l| l.intensity = 0.0);
                world.query_mut::<&mut PointLight>().into_iter().for_each(|l| l.intensity = 0.0);
                let distant = world.query_mut::<&mut DirectionalLight>();
                distant.into_iter().for_each(|l| l.intensity = 0.0);
            }
            Self::Lens => remove::<ThinLens>(world),
            Self::Antialiasing => {
                world.query_mut::<&mut View>().into_iter().for_each(|v| v.antialias = 1);
            }
        }
    }
}

/// Removes every `T`.
fn remove<T: hecs::Component>(world: &mut World) {
    let those = world.query_mut::<(Entity, &T)>().into_iter().map(|(entity, _)| entity);
    let those: Vec<Entity> = those.collect();
    those.into_iter().for_each(|entity| drop(world.remove_one::<T>(entity)));
}
