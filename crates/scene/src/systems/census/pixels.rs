//! Several rays for a pixel: by a lens, and by antialiasing.

use super::{Census, Found, absent, present};
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

    pub(super) fn depth_of_field(&self) -> Found {
        match self.world.query::<&ThinLens>().iter().next() {
            Some(_) if !self.sees_any() => absent(NOTHING),
            None => absent("the camera is a pinhole"),
            Some(lens) if camera::radius(lens) == 0.0 => absent("the aperture is 0"),
            Some(_) if self.blur() < HALF_LEVEL.into() => {
                absent("it blurs nothing by a 510th of a pixel")
            }
            Some(ThinLens { aperture, samples_x: x, samples_y: y, .. }) => {
                present(format!("aperture {aperture}, {x} x {y} points"))
            }
        }
    }

    pub(super) fn antialiasing(&self) -> Found {
        let n = self.world.query::<&View>().iter().next().map_or(1, |view| view.antialias);
        match n {
            1 => absent("antialias is 1"),
            _ if !self.sees_any() => absent(NOTHING),
            n => present(format!("{n} x {n} rays per pixel")),
        }
    }
}
