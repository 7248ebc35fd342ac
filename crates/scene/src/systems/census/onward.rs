//! Rays that go on from surfaces.

use glam::Vec3;

use super::{Census, Found, ShapeFacts, absent, or_in_the_way, present};
use crate::systems::environment;
use crate::systems::visibility::Faces;

impl Census<'_> {
    pub(super) fn transparency(&self) -> Found {
        let none = "no material lets light through";
        let found =
            self.surfaces(|shape| shape.visibility.is_transparent, "transparent shape", none);
        or_in_the_way(found, self.any(|shape| shape.visibility.lets_light_through()))
    }

    pub(super) fn mirrors(&self) -> Found {
        let reflects = |shape: &ShapeFacts<'_>| shape.bound.kr > 0.0;
        let none = if self.any(|shape| shape.visibility.is_surface && reflects(shape)) {
            "mirrors are seen from behind only"
        } else if self.any(|shape| shape.visibility.is_surface && !shape.visibility.is_mirror) {
            "mirrors show nothing but a background"
        } else {
            "no material has kr above 0"
        };
        let is_mirror = |shape: &ShapeFacts<'_>| {
            reflects(shape) && shape.visibility.faces.is_none_or(Faces::any)
        };
        let (found, reason) = self.surfaces(is_mirror, "mirror", none);
        match self.frame.settings.bounces {
            _ if !found => absent(reason),
            0 => absent("nbounces is 0"),
            _ if !self.shines() => absent("mirrors show nothing but black"),
            bounces => present(format!("{reason}, nbounces {bounces}")),
        }
    }

    /// Whether a mirror could show anything but black.
    fn shines(&self) -> bool {
        let is_bright = |shape: &ShapeFacts<'_>| {
            shape.visibility.shows.emission
                || shape.shape.light.is_some_and(|color| color != Vec3::ZERO)
        };
        let has_sky = self.has_hemisphere() || environment::is_bright(self.world);
        self.is_lit() || self.any(is_bright) || self.shows_ambient() || has_sky
    }
}
