//! What surrounds a scene, infinitely far away: an image by longitude and latitude, or a gradient.
//!
//! The image's centre is in the direction -z and its upper edge at +y, so that it is seen upright
//! and not mirrored from within.

use std::f64::consts::PI;

use glam::{DVec3, Mat3, Vec2, Vec3};

use super::hemisphere::Hemisphere;
use super::texture::{Filter, Image, Wrap, sphere_uv};
use crate::math::float::normalize;

/// The surroundings of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// The rotation from world space to a space with +y up.
    pub to_own: Mat3,
    /// The colours.
    pub colors: Surrounding,
}

/// Colours by direction, linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surrounding {
    /// The colours straight up, at the horizon, and straight down; linear in the height of the
    /// direction between them.
    Gradient([Vec3; 3]),
    /// An image, by its index in [`Appearance::images`](crate::prepared::Appearance::images).
    Image(u32),
}

/// Rows of samples of a gradient.
const GRADIENT_ROWS: u32 = 128;

impl Environment {
    /// The ambient light that it gives.
    pub fn ambient<'a>(&self, image: impl Fn(u32) -> Option<&'a Image>) -> Hemisphere {
        let rows = match self.colors {
            Surrounding::Gradient(_) => GRADIENT_ROWS,
            Surrounding::Image(number) => image(number).map_or(1, |image| image.height),
        };
        let to_world = self.to_own.transpose();
        let ends = |row: u32| libm::cos(PI * f64::from(row) / f64::from(rows));
        let parts = (0..rows).flat_map(|row| {
            let [top, bottom] = [ends(row), ends(row + 1)];
            let height = (top + bottom) / 2.0;
            let angle = 2.0 * PI * (top - bottom) / f64::from(2 * rows);
            (0..2 * rows).map(move |column| {
                let turn = PI * (f64::from(column) + 0.5) / f64::from(rows);
                let (sin, cos) = libm::sincos(turn);
                let across = (1.0 - height * height).sqrt();
                (DVec3::new(across * sin, height, across * cos).as_vec3(), angle)
            })
        });
        Hemisphere::around(parts.map(|(own, angle)| {
            let direction = to_world * own;
            (direction, self.at(direction, &image).as_dvec3() * angle)
        }))
    }

    /// The colour in a direction; `image` returns the image with an index.
    pub fn at<'a>(&self, direction: Vec3, image: impl FnOnce(u32) -> Option<&'a Image>) -> Vec3 {
        let own = normalize(self.to_own * direction);
        match self.colors {
            Surrounding::Gradient([up, level, down]) => {
                let end = if own.y < 0.0 { down } else { up };
                level + (end - level) * own.y.abs().min(1.0)
            }
            Surrounding::Image(number) => image(number).map_or(Vec3::ZERO, |image| {
                let Vec2 { x, y } = sphere_uv(Vec3::new(own.x, own.y, -own.z));
                // The upper edge has no neighbour at the lower one.
                let half = 0.5 / image.height as f32;
                image.look_up(
                    Vec2::new(x, y.clamp(half, 1.0 - half)),
                    Filter::Bilinear,
                    Wrap::Repeat,
                )
            }),
        }
    }
}
