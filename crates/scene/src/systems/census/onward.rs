//! Rays that go on from surfaces.

use super::{Faces, Facts};

impl Facts<'_> {
    pub(super) fn is_transparent(&self, i: usize) -> bool {
        self.solid[i] && self.census.transparent[i]
    }

    pub(super) fn transparency(&self) -> (bool, String) {
        let none = "no material lets light through";
        let found = self.surfaces(|i| self.is_transparent(i), "transparent shape", none);
        match found.0 || !(0..self.met.len()).any(|i| self.is_transparent(i) && self.met[i]) {
            true => found,
            // Shadow rays may meet it.
            false => (true, format!("{}, but in the way of light", found.1)),
        }
    }

    pub(super) fn mirrors(&self) -> (bool, String) {
        let reflects = |i: usize| self.census.materials[i].kr > 0.0;
        let none = match (0..self.solid.len()).any(|i| self.solid[i] && reflects(i)) {
            true => "mirrors are seen from behind only",
            false => "no material has kr above 0",
        };
        let is_mirror = |i: usize| reflects(i) && self.census.in_view[i].is_none_or(Faces::any);
        let (found, reason) = self.surfaces(is_mirror, "mirror", none);
        match self.census.settings.bounces {
            _ if !found => (false, reason),
            0 => (false, "nbounces is 0".to_owned()),
            _ if !self.shines => (false, "mirrors show nothing but black".to_owned()),
            bounces => (true, format!("{reason}, nbounces {bounces}")),
        }
    }
}
