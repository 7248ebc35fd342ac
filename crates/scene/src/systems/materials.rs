//! Materials: one row of numbers for each shape.

use glam::Vec3;
use hecs::World;

use super::geometry::ShapeOutput;
use crate::components;
use wavecrest_core::kernels::blinn_phong::Material;

/// The material of each of `shapes`, in order. Shapes of lights get an unused one.
pub fn run(world: &World, shapes: &[ShapeOutput]) -> Vec<Material> {
    shapes
        .iter()
        .map(|shape| {
            world.get::<&components::Material>(shape.entity).map_or(BLACK, |m| Material {
                ks: m.ks as f32,
                kd: m.kd as f32,
                exponent: m.specular_exponent as f32,
                color: m.diffuse_color.as_vec3(),
                kr: m.kr as f32,
            })
        })
        .collect()
}

/// Bounds on the materials of shapes in any texel: each weight as large as a metal map can make it.
pub fn possible(world: &World, shapes: &[ShapeOutput], materials: &[Material]) -> Vec<Material> {
    let may = |(shape, material): (&ShapeOutput, &Material)| {
        let maps = world.get::<&components::Maps>(shape.entity).ok();
        match maps.as_ref().and_then(|maps| maps.metal.as_ref()) {
            Some(map) => {
                let kr = if map.metallic > 0.0 { 1.0 } else { 0.0 };
                Material { ks: 1.0, kd: 1.0, kr, ..*material }
            }
            None => *material,
        }
    };
    shapes.iter().zip(materials).map(may).collect()
}

/// Reflects nothing.
const BLACK: Material = Material { ks: 0.0, kd: 0.0, exponent: 0.0, color: Vec3::ZERO, kr: 0.0 };
