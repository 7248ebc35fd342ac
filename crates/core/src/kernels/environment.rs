//! What surrounds a scene, infinitely far away: an image by longitude and latitude, or a gradient.
//!
//! The image's centre is in the direction -z and its upper edge at +y, so that it is seen upright
//! and not mirrored from within.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Mat3, Vec3};

use super::texture::sphere_uv;
use super::{Filter, Hemisphere, Image, Wrap};
use crate::math::float::normalize;
use wavecrest_base::parallel;

/// The surroundings of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// The rotation from world space to a space with +y up.
    pub to_own: Mat3,
    /// The colours.
    pub colors: EnvironmentColors,
    /// Whether rays that go straight on from the camera do not see it.
    pub hidden: bool,
}

/// Colours by direction, linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EnvironmentColors {
    /// The colours straight up, at the horizon, and straight down; linear in the height of the
    /// direction between them.
    Gradient([Vec3; 3]),
    /// An image, by its index in [`Appearance::images`](crate::prepared::Appearance::images).
    Image(u32),
}

/// The least number of rows of its parts that give the ambient light, with twice as many columns.
const ROWS: u32 = 128;

impl Environment {
    /// The colour in a direction; `image` returns the image with an index.
    pub fn at<'a>(&self, direction: Vec3, image: impl FnOnce(u32) -> Option<&'a Image>) -> Vec3 {
        let own = normalize(self.to_own * direction);
        self.color(own.y, || sphere_uv(Vec3::new(own.x, own.y, -own.z).into()), image)
    }

    /// The colour in a direction of this height, which is at `uv` of an image.
    fn color<'a>(
        &self,
        height: f32,
        uv: impl FnOnce() -> [f32; 2],
        image: impl FnOnce(u32) -> Option<&'a Image>,
    ) -> Vec3 {
        match self.colors {
            EnvironmentColors::Gradient([up, level, down]) => {
                let end = if height < 0.0 { down } else { up };
                level + (end - level) * height.abs().min(1.0)
            }
            EnvironmentColors::Image(number) => image(number).map_or(Vec3::ZERO, |image| {
                let [x, y] = uv();
                // The upper edge has no neighbour at the lower one.
                let half = 0.5 / image.height as f32;
                let uv = [x, y.clamp(half, 1.0 - half)];
                image.look_up(uv, Filter::Bilinear, Wrap::Repeat).into()
            }),
        }
    }

    /// The ambient light that it gives, `traced` or not, with its `image` if it has one.
    pub fn ambient(&self, image: Option<&Image>, traced: bool) -> Hemisphere {
        let [width, height] = image.map_or([0, 0], |image| [image.width, image.height]);
        let (rows, columns) = (height.max(ROWS), width.max(2 * ROWS));
        let to_world = self.to_own.transpose();
        let turns = (0..columns).map(|column| {
            let u = (f64::from(column) + 0.5) / f64::from(columns);
            (u as f32, libm::sincos(TAU * (u - 0.5)))
        });
        let turns: Vec<(f32, (f64, f64))> = turns.collect();
        let end = |row: u32| libm::cos(PI * f64::from(row) / f64::from(rows));
        let row = |row: u32| {
            let (top, bottom) = (end(row), end(row + 1));
            let (height, angle) = ((top + bottom) / 2.0, TAU * (top - bottom) / f64::from(columns));
            let v = 1.0 - (f64::from(row) + 0.5) / f64::from(rows);
            let across = (1.0 - height * height).sqrt();
            Hemisphere::sums(turns.iter().map(|&(u, (sin, cos))| {
                let own = DVec3::new(across * sin, height, -across * cos).as_vec3();
                let color = self.color(own.y, || [u, v as f32], |_| image);
                (to_world * own, color.as_dvec3() * angle)
            }))
        };
        let sums: Vec<[DVec3; 9]> = parallel::map(0..rows, row);
        Hemisphere::around(&sums, traced)
    }
}
