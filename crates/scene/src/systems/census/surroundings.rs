//! What is around the scene.

use super::Facts;
use crate::components::Environment;
use wavecrest_core::kernels::light::Emitter;

impl Facts<'_> {
    pub(super) fn hemisphere(&self) -> (bool, String) {
        match self.census.hemisphere {
            None => (false, "ambient light is the same from all sides".to_owned()),
            Some(light) if light.is_black() => (false, "ambient light is black".to_owned()),
            Some(_) if !self.shows_ambient && !self.mirrors().0 && !self.transparency().0 => {
                (false, "no surface in view shows it".to_owned())
            }
            Some(_) => (true, "ambient light by the normal".to_owned()),
        }
    }

    pub(super) fn occlusion(&self) -> (bool, String) {
        let found = self.lights("sky", |emitter| matches!(emitter, Emitter::Around(..)));
        match (self.census.hemisphere, found) {
            (Some(light), _) if !light.traced => {
                (false, "nothing is in the way of ambient light".to_owned())
            }
            (Some(_), (true, _)) => (true, "rays look for what is in its way".to_owned()),
            (_, found) => found,
        }
    }

    pub(super) fn environment(&self) -> (bool, String) {
        let mut found = self.census.world.query::<&Environment>();
        match found.iter().next() {
            None => (false, "the scene has no environment".to_owned()),
            Some(around) if !around.is_bright() => (false, "the environment is black".to_owned()),
            // Mirrors do not show the background.
            Some(_) if self.census.is_even && !self.mirrors().0 && !self.transparency().0 => {
                (false, "the environment is of one colour, as a background is".to_owned())
            }
            Some(around) if around.image.is_some() => (true, "an image all around".to_owned()),
            Some(_) => (true, "a gradient all around".to_owned()),
        }
    }
}
