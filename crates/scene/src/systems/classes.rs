//! Classes: materials and textures as tracers read them.

use std::collections::HashMap;

use hecs::World;

use super::surface::{SurfaceColumns, SurfaceComponents};
use super::textures::Images;
use super::visibility::{Shows, Source, Visibility};
use crate::components::{TextureRef, Transparency};
use crate::surface::{EMISSION_MAP, METAL_MAP, OCCLUSION_MAP, OPACITY_MAP};
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::transmission;
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{Class, Map, Property, Shape, Texture, UvMap};

/// Assigns classes to shapes; shapes with equal ones share a class. Invisible properties are left out,
/// and their images not opened, unless the schedule requires them.
pub(crate) fn run(world: &World, schedule: Schedule, images: &mut Images) -> Vec<Class> {
    let mut classes = Vec::new();
    let mut known: HashMap<Key, u32> = HashMap::new();
    let is_needed = |step, is_shown| {
        let is_for_mirrors = step == Step::Tints && schedule.has_mirrors();
        (is_shown || schedule.is_unconditional(step)) && (schedule.runs(step) || is_for_mirrors)
    };
    let surfaces = world.view::<SurfaceColumns<'_>>();
    let mut shapes = world.query::<(&Source, &mut Shape, &UvMap, &Material, &Visibility)>();
    for (source, shape, uv_map, material, visibility) in shapes.iter() {
        let surface = SurfaceComponents::of(&surfaces, source.0);
        let shows = if visibility.is_in_view() { visibility.shows } else { Shows::default() };
        let shows = shows.map(is_needed);
        let through = visibility.lets_light_through().then(|| transparency(&surface));
        let look_up = |texture: &TextureRef, key: &str| {
            images.texture(texture, (surface.place, key), *uv_map)
        };
        let maps = maps(&surface, shows, through.as_ref(), shape.colored, look_up);
        let material = Material {
            tint: if shows.tint { material.tint } else { Material::BLACK.tint },
            emission: if shows.emission { material.emission } else { Material::BLACK.emission },
            ..*material
        };
        let class = Class::new(material, through, maps);
        shape.class = *known.entry(key(&class)).or_insert_with(|| {
            classes.push(class);
            classes.len() as u32 - 1
        });
    }
    classes
}

/// What tells classes apart: the bits of their constants, and the rest as text, of which plain classes
/// have none.
type Key = ([u32; 14], String);

fn key(Class { material, transparency, maps, .. }: &Class) -> Key {
    let Material { ks, kd, exponent, color, kr, tint, emission, ambient } = material;
    let [r, g, b] = color.to_array();
    let ([s, t, u], [e, f, h]) = (tint.to_array(), emission.to_array());
    let constants = [*ks, *kd, *exponent, r, g, b, *kr, s, t, u, e, f, h, *ambient];
    let is_plain = maps.is_empty() && transparency.is_none();
    // As text, numbers are as good as their bits.
    let rest = if is_plain { String::new() } else { format!("{transparency:?}{maps:?}") };
    (constants.map(f32::to_bits), rest)
}

fn transparency(surface: &SurfaceComponents<'_>) -> transmission::Transparency {
    let through = surface.transparency.unwrap_or(&Transparency::OPAQUE).in_single_precision();
    // Of an unlit surface the base colour is emitted alone.
    transmission::Transparency { tinted: through.tinted && !surface.is_unlit(), ..through }
}

/// The visible maps of a surface, in the order in which they are applied; `look_up` takes a texture in that is
/// under a key.
fn maps(
    surface: &SurfaceComponents<'_>,
    shows: Shows,
    through: Option<&transmission::Transparency>,
    is_colored: bool,
    mut look_up: impl FnMut(&TextureRef, &str) -> Texture,
) -> Vec<Map> {
    let SurfaceComponents { material, texture, maps, transparency, .. } = surface;
    let mut found = Vec::new();
    let mut add = |reference: Option<&TextureRef>, key, property| {
        found.push(Map { property, texture: reference.map(|texture| look_up(texture, key)) });
    };
    if texture.is_some() && (shows.texture || through.is_some_and(|through| through.tinted)) {
        add(*texture, "texture", Property::Color);
    }
    for (key, map) in maps.all().filter(|_| material.is_some()) {
        let factors = [map.metallic, map.roughness, map.strength].map(|factor| factor as f32);
        let [metallic, roughness, strength] = factors;
        let (is_shown, property) = match key {
            EMISSION_MAP => (shows.emission, Property::Emission),
            METAL_MAP => (shows.metal, Property::Metal { metallic, roughness }),
            OCCLUSION_MAP => (shows.occlusion, Property::Occlusion { strength }),
            OPACITY_MAP => (through.is_some(), Property::Opacity),
            _ => (shows.normal, Property::Normal { strength }),
        };
        if is_shown {
            add(map.texture.as_ref(), key, property);
        }
    }
    if through.is_some() && transparency.is_some_and(|through| through.vertex_alpha) {
        add(None, "", Property::Alpha);
    }
    if shows.emission && surface.is_unlit() && (texture.is_some() || is_colored) {
        add(None, "", Property::Unlit);
    }
    found
}
