//! Several rays for a pixel: by a lens, and by antialiasing.

use super::Census;
use crate::components::{ThinLens, View};
use crate::systems::camera;
use wavecrest_core::kernels::shade::HALF_LEVEL;

/// The reason for a lens and antialiasing to be left out: every ray sees the background.
const NOTHING: &str = "no shape is in view";

impl Census<'_> {
    /// Whether rays of a pixel may see different things: shapes, also of lights, or an environment.
    fn sees_any(&self) -> bool {
        self.any(|shape| shape.visibility.faces.is_some()) || self.environment().0
    }

    /// The widest blur by a lens, in pixels.
    fn blur(&self) -> f64 {
        camera::resolution(&self.frame.cameras, self.geometry).1
    }

    pub(super) fn depth_of_field(&self) -> (bool, String) {
        match self.world.query::<&ThinLens>().iter().next() {
            Some(_) if !self.sees_any() => (false, NOTHING.to_owned()),
            None => (false, "the camera is a pinhole".to_owned()),
            Some(lens) if camera::radius(lens) == 0.0 => (false, "the aperture is 0".to_owned()),
            Some(_) if self.blur() < HALF_LEVEL.into() => {
                (false, "it blurs nothing by a 510th of a pixel".to_owned())
            }
            Some(lens) => (
                true,
                format!(
                    "aperture {}, {} x {} points",
                    lens.aperture, lens.samples_x, lens.samples_y
                ),
            ),
        }
    }

    pub(super) fn antialiasing(&self) -> (bool, String) {
        let n = self.world.query::<&View>().iter().next().map_or(1, |view| view.antialias);
        match n {
            1 => (false, "antialias is 1".to_owned()),
            _ if !self.sees_any() => (false, NOTHING.to_owned()),
            n => (true, format!("{n} x {n} rays per pixel")),
        }
    }
}
