//! Classes: materials and textures as tracers read them.

use std::collections::HashMap;

use super::census::{Findings, Shows};
use super::geometry::ShapeOutput;
use super::textures::Images;
use crate::components::{SurfaceComponents, TextureRef, Transparency};
use crate::surface::{EMISSION_MAP, METAL_MAP, OCCLUSION_MAP, OPACITY_MAP};
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{Class, Map, Property};

/// Assigns classes to shapes; shapes with equal ones share a class. Invisible properties are left out,
/// and their images not opened, unless the schedule requires them.
pub(crate) fn run(
    surfaces: &[SurfaceComponents<'_>],
    materials: &[Material],
    schedule: Schedule,
    found: &Findings,
    images: &mut Images,
    shapes: &mut [ShapeOutput],
) -> Vec<Class> {
    let mut classes = Vec::new();
    let mut known: HashMap<Key, u32> = HashMap::new();
    let is_needed = |step, is_shown| {
        let is_for_mirrors = step == Step::Tints && schedule.has_mirrors();
        (is_shown || schedule.is_unconditional(step)) && (schedule.runs(step) || is_for_mirrors)
    };
    let shows = found.shows.iter().zip(&found.transparent);
    let surfaces = surfaces.iter().zip(materials);
    for ((output, surface), (shows, transparent)) in shapes.iter_mut().zip(surfaces).zip(shows) {
        let shows = (shows.map(is_needed), *transparent);
        let class = class(surface, shows, images, output);
        let next = || {
            classes.push(class.clone());
            classes.len() as u32 - 1
        };
        output.shape.class = *known.entry(key(&class)).or_insert_with(next);
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

/// The class of a surface, as far as it is visible.
fn class(
    (SurfaceComponents { material, texture, maps, place, transparency, .. }, constants): (
        &SurfaceComponents<'_>,
        &Material,
    ),
    (shows, is_transparent): (Shows, bool),
    images: &mut Images,
    output: &ShapeOutput,
) -> Class {
    let Material { tint, emission, .. } = Material::BLACK;
    let mut constants = *constants;
    if !shows.tint {
        constants.tint = tint;
    }
    if !shows.emission {
        constants.emission = emission;
    }
    let is_unlit = material.is_some_and(|material| material.unlit);
    let mut through = transparency.unwrap_or(&Transparency::OPAQUE).in_single_precision();
    // Of an unlit surface the base colour is emitted alone.
    through.tinted &= !is_unlit;
    let mut found = Vec::new();
    let mut add = |reference: Option<&TextureRef>, key, property| {
        let texture = reference.map(|found| images.texture(found, (place, key), output.uv_map));
        found.push(Map { property, texture });
    };
    // In the order in which they are applied.
    if texture.is_some() && (shows.texture || is_transparent && through.tinted) {
        add(*texture, "texture", Property::Color);
    }
    for (key, map) in maps.all().filter(|_| material.is_some()) {
        let factors = [map.metallic, map.roughness, map.strength].map(|factor| factor as f32);
        let [metallic, roughness, strength] = factors;
        let (is_shown, property) = match key {
            EMISSION_MAP => (shows.emission, Property::Emission),
            METAL_MAP => (shows.metal, Property::Metal { metallic, roughness }),
            OCCLUSION_MAP => (shows.occlusion, Property::Occlusion { strength }),
            OPACITY_MAP => (is_transparent, Property::Opacity),
            _ => (shows.normal, Property::Normal { strength }),
        };
        if is_shown {
            add(map.texture.as_ref(), key, property);
        }
    }
    if is_transparent && transparency.is_some_and(|through| through.vertex_alpha) {
        add(None, "", Property::Alpha);
    }
    let varies = texture.is_some() || output.shape.colored;
    if shows.emission && varies && is_unlit {
        add(None, "", Property::Unlit);
    }
    Class::new(constants, is_transparent.then_some(through), found)
}
