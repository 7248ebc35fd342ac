//! Materials: one row of numbers for each shape.

use glam::Vec3;
use hecs::World;

use super::geometry::ShapeOutput;
use crate::components;
use wavecrest_core::kernels::blinn_phong::Material;

/// The material of each of `shapes`, in their order. Shapes of lights have none that matters.
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

/// Reflects nothing.
const BLACK: Material = Material { ks: 0.0, kd: 0.0, exponent: 0.0, color: Vec3::ZERO, kr: 0.0 };
