//! Ambient light, and what is around the scene.

use glam::Vec3;

use super::{Census, ShapeFacts};
use crate::components::Environment;
use crate::environment::EvenColor;
use crate::lights::hemisphere;
use crate::systems::lights;
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

    pub(super) fn hemisphere(&self) -> (bool, String) {
        match hemisphere(self.world) {
            None => (false, "ambient light is the same from all sides".to_owned()),
            Some(light) if light.is_black() => (false, "ambient light is black".to_owned()),
            Some(_) if !self.shows_ambient() && !self.mirrors().0 && !self.transparency().0 => {
                (false, "no surface in view shows it".to_owned())
            }
            Some(_) => (true, "ambient light by the normal".to_owned()),
        }
    }

    pub(super) fn occlusion(&self) -> (bool, String) {
        match (hemisphere(self.world), self.lights(EmitterKind::Sky)) {
            (Some(light), _) if !light.traced => {
                (false, "nothing is in the way of ambient light".to_owned())
            }
            (Some(_), (true, _)) => (true, "rays look for what is in its way".to_owned()),
            (_, found) => found,
        }
    }

    pub(super) fn environment(&self) -> (bool, String) {
        let mut found = self.world.query::<(&Environment, Option<&EvenColor>)>();
        match found.iter().next() {
            None => (false, "the scene has no environment".to_owned()),
            Some((around, _)) if !around.is_bright() => {
                (false, "the environment is black".to_owned())
            }
            // Mirrors do not show the background.
            Some((_, Some(_))) if !self.mirrors().0 && !self.transparency().0 => {
                (false, "the environment is of one colour, as a background is".to_owned())
            }
            Some((around, _)) if around.image.is_some() => (true, "an image all around".to_owned()),
            Some(_) => (true, "a gradient all around".to_owned()),
        }
    }
}
