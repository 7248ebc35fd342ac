//! Ambient light, and what is around the scene.

use glam::Vec3;

use super::{Census, Found, ShapeFacts, absent, present};
use crate::components::Environment;
use crate::systems::environment::EvenColor;
use crate::systems::lights;
use crate::systems::sky::hemisphere;
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::light::EmitterKind;

impl Census<'_> {
    pub(super) fn has_hemisphere(&self) -> bool {
        hemisphere(self.world).is_some_and(|light| !light.is_black())
    }

    pub(super) fn has_ambient(&self) -> bool {
        self.has_hemisphere() || lights::ambient(self.world, self.frame) > 0.0
    }

    /// Whether any surface in view shows ambient light.
    pub(super) fn shows_ambient(&self) -> bool {
        let is_scattered = |ShapeFacts { bound, surface, .. }: &ShapeFacts<'_>| {
            let Material { color, ambient, .. } = bound;
            *ambient != 0.0 && (surface.texture.is_some() || *color != Vec3::ZERO)
        };
        let is_seen = |shape: &ShapeFacts<'_>| shape.visibility.is_in_view();
        self.has_ambient() && self.any(|shape| is_seen(shape) && is_scattered(shape))
    }

    pub(super) fn hemisphere(&self) -> Found {
        match hemisphere(self.world) {
            None => absent("ambient light is the same from all sides"),
            Some(light) if light.is_black() => absent("ambient light is black"),
            Some(_) if !self.shows_ambient() && !self.mirrors().0 && !self.transparency().0 => {
                absent("no surface in view shows it")
            }
            Some(_) => present("ambient light by the normal"),
        }
    }

    pub(super) fn occlusion(&self) -> Found {
        match (hemisphere(self.world), self.lights(EmitterKind::Sky)) {
            (Some(light), _) if !light.traced => absent("nothing is in the way of ambient light"),
            (Some(_), (true, _)) => present("rays look for what is in its way"),
            (_, found) => found,
        }
    }

    pub(super) fn environment(&self) -> Found {
        let mut found = self.world.query::<(&Environment, Option<&EvenColor>)>();
        match found.iter().next() {
            None => absent("the scene has no environment"),
            Some((around, _)) if !around.is_bright() => absent("the environment is black"),
            // Mirrors do not show the background.
            Some((_, Some(_))) if !self.mirrors().0 && !self.transparency().0 => {
                absent("the environment is of one colour, as a background is")
            }
            Some((around, _)) if around.image.is_some() => present("an image all around"),
            Some(_) => present("a gradient all around"),
        }
    }
}
