//! Materials: one row of numbers for each shape, and bounds on it.

use glam::Vec3;
use hecs::World;

use super::frame::Frame;
use super::surface::{SurfaceColumns, SurfaceComponents};
use super::visibility::{MaterialBound, Source, Visibility};
use crate::components::{self, Maps, Transparency};
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::metal::{self, MetalParameters};
use wavecrest_core::prepared::Shape;

/// Leaves out what other parts of a surface replace: nothing is left of an unlit one but its base colour and what goes
/// through it, which normals may bend, and metal maps give all that is mirrored.
pub(crate) fn strip(world: &mut World) {
    type Parts<'w> = (&'w mut components::Material, Option<&'w mut Maps>, Option<&'w Transparency>);
    for (material, maps, through) in world.query_mut::<Parts<'_>>() {
        if maps.as_ref().is_some_and(|maps| maps.metal.is_some()) {
            material.kr = 0.0;
        }
        if !material.unlit {
            continue;
        }
        let components::Material { diffuse_color, unlit, .. } = *material;
        let none = components::Material { kd: 0.0, ambient: 0.0, ..components::Material::MATTE };
        *material = components::Material { diffuse_color, unlit, ..none };
        if let Some(maps) = maps {
            let normal = maps.normal.take().filter(|_| through.is_some());
            *maps = Maps { normal, opacity: maps.opacity.take(), ..Maps::NONE };
        }
    }
}

/// Finds the material of each shape, and its bounds. Shapes of lights keep an unused one.
pub(crate) fn run(world: &World, frame: &Frame) {
    let surfaces = world.view::<SurfaceColumns<'_>>();
    let mut shapes =
        world.query::<(&Source, &Shape, &Visibility, &mut Material, &mut MaterialBound)>();
    for (source, shape, visibility, material, bound) in shapes.iter() {
        let surface = SurfaceComponents::of(&surfaces, source.0);
        if let Some(own) = surface.material {
            // Beside what else a transparent surface mirrors, no weight is too small.
            let kr = if visibility.is_transparent { own.kr as f32 } else { mirrored(own, frame) };
            let kr = if visibility.is_mirror { kr } else { 0.0 };
            *material = constants(own, kr, &surface, shape.colored);
        }
        bound.0 = largest(*material, &surface);
    }
}

/// The constants of a material with this weight of the mirror ray. Metal maps whose texels do not count give
/// theirs here, and so do unlit surfaces whose base colour is the same everywhere.
fn constants(
    m: &components::Material,
    kr: f32,
    surface: &SurfaceComponents<'_>,
    is_colored: bool,
) -> Material {
    let mut material = Material {
        ks: m.ks as f32,
        kd: m.kd as f32,
        exponent: m.specular_exponent as f32,
        color: m.diffuse_color.as_vec3(),
        kr,
        tint: m.specular_color.as_vec3(),
        emission: m.emission.as_vec3(),
        ambient: m.ambient as f32,
    };
    if let Some(map) = &surface.maps.metal {
        material.ambient = 1.0;
        if map.is_constant() {
            material = looked(material, material.color, [0.0; 2]);
        }
    }
    if m.unlit && surface.texture.is_none() && !is_colored {
        material.emission = material.color;
        material.color = Vec3::ZERO;
    }
    material
}

/// The material with each weight as large as a metal map can make it.
fn largest(material: Material, surface: &SurfaceComponents<'_>) -> Material {
    match &surface.maps.metal {
        // The brighter a base colour, the larger are its weights.
        Some(map) if map.texture.is_none() => {
            looked(material, Vec3::ONE, [map.metallic, map.roughness])
        }
        Some(map) if !map.is_constant() => {
            let kr = if map.metallic > 0.0 { 1.0 } else { 0.0 };
            Material { ks: 1.0, kd: 1.0, kr, ..material }
        }
        _ => material,
    }
}

/// The weight of the mirror ray; 0 if that could show nothing.
pub(super) fn mirrored(material: &components::Material, frame: &Frame) -> f32 {
    if frame.visible.goes_on::<f32>(material.mirrors().into()) { material.kr as f32 } else { 0.0 }
}

/// The material with the weights of a base colour, metalness and roughness.
fn looked(material: Material, color: Vec3, [metallic, roughness]: [f64; 2]) -> Material {
    let MetalParameters { ks, kd, exponent, kr, .. } =
        metal::look(color.into(), metallic as f32, roughness as f32);
    Material { ks, kd, exponent, kr, ..material }
}
