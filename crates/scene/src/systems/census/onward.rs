//! Rays that go on from surfaces.

use super::{Faces, Facts, or_in_the_way};

impl Facts<'_> {
    pub(super) fn is_transparent(&self, i: usize) -> bool {
        self.solid[i] && self.census.extracted.shapes[i].is_transparent
    }

    pub(super) fn transparency(&self) -> (bool, String) {
        let none = "no material lets light through";
        let found = self.surfaces(|i| self.is_transparent(i), "transparent shape", none);
        let is_met = (0..self.solid.len()).any(|i| self.is_transparent(i) && self.is_met(i));
        or_in_the_way(found, is_met)
    }

    pub(super) fn mirrors(&self) -> (bool, String) {
        let reflects = |i: usize| self.census.materials[i].kr > 0.0;
        let solid = || (0..self.solid.len()).filter(|&i| self.solid[i]);
        let none = match solid().any(reflects) {
            true => "mirrors are seen from behind only",
            false if solid().all(|i| self.census.extracted.shapes[i].is_mirror) => {
                "no material has kr above 0"
            }
            false => "mirrors show nothing but a background",
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
