//! What shadow rays pass: shapes of lights, and transparent shapes, which take some of their light.

use hecs::World;

use super::visibility::Visibility;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::prepared::Shape;

pub(super) fn run(world: &World, geometry: &mut Geometry) {
    for (shape, visibility) in world.query::<(&Shape, &Visibility)>().iter() {
        let is_transparent = visibility.lets_light_through();
        if shape.primitives.is_empty() || !is_transparent && shape.light.is_none() {
            continue;
        }
        if shape.light.is_none() {
            geometry.transparent.push(shape.primitives.clone());
        }
        geometry.passed.push(shape.primitives.clone());
    }
}
