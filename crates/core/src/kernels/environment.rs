//! What surrounds a scene, infinitely far away: an image by longitude and latitude, or a gradient.
//!
//! The image's centre is in the direction -z and its upper edge at +y, so that it is seen upright
//! and not mirrored from within.

use glam::{Mat3, Vec2, Vec3};

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

impl Environment {
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
