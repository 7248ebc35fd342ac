//! Overrides of a scene file's global settings, for comparisons.

use hecs::World;

use crate::components::{
    AreaLight, DirectionalLight, Filter, Maps, PointLight, Settings, Sky, TextureRef, ThinLens,
    Transparency, View,
};
use crate::query::{change, remove};

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
        change(world, |settings: &mut Settings| settings.bounces = bounces);
    }
    if let Some(filter) = overrides.filter {
        change(world, |texture: &mut TextureRef| texture.look_up.filter = filter);
        change(world, |maps: &mut Maps| {
            maps.all_mut().for_each(|map| map.texture.look_up.filter = filter);
        });
    }
    let last = overrides.without;
    Layer::ALL.into_iter().filter(|layer| Some(*layer) <= last).for_each(|l| l.leave(world));
}

impl Layer {
    /// Removes the layer from the world.
    fn leave(self, world: &mut World) {
        match self {
            Self::Transparency => remove::<Transparency>(world),
            Self::Mirrors => change(world, |settings: &mut Settings| settings.bounces = 0),
            Self::Textures => remove::<TextureRef>(world),
            Self::Occlusion => change(world, |sky: &mut Sky| sky.samples = 0),
            Self::SoftShadows => {
                change(world, |light: &mut AreaLight| light.samples = 1);
                change(world, |light: &mut DirectionalLight| light.samples = 1);
            }
            Self::Lights => {
                change(world, |light: &mut AreaLight| light.intensity = 0.0);
                change(world, |light: &mut PointLight| light.intensity = 0.0);
                change(world, |light: &mut DirectionalLight| light.intensity = 0.0);
            }
            Self::Lens => remove::<ThinLens>(world),
            Self::Antialiasing => change(world, |view: &mut View| view.antialias = 1),
        }
    }
}
