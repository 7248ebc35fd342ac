//! Ambient light by the normal: from a sky of one colour and a ground of another.
//!
//! With n the normal, the sky's share is (1 + n . up) / 2: what a matte surface reflects of both where nothing is in
//! the way. A mirror ray that leaves the scene shows the same colours, with n its direction.

use glam::{DVec3, Vec3};

use crate::math::real::Single;
use crate::math::vector::Vector;

/// The light of a sky and of the ground below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hemisphere {
    /// Where the sky is, of unit length.
    up: Vec3,
    /// The mean of both colours.
    middle: Vec3,
    /// What the sky's colour has more than the mean.
    more: Vec3,
}

impl Hemisphere {
    /// Light of these linear colours, where `up`, of unit length, points to the sky.
    pub fn new(sky: DVec3, ground: DVec3, up: DVec3) -> Self {
        let [middle, more] = [(sky + ground) / 2.0, (sky - ground) / 2.0].map(|v| v.as_vec3());
        Self { up: up.as_vec3(), middle, more }
    }

    /// Whether it adds nothing anywhere.
    pub fn is_black(&self) -> bool {
        self.middle == Vec3::ZERO
    }

    /// What arrives at a surface with this normal, or along a mirror ray in this direction, of unit length.
    #[inline(always)]
    pub fn at<F: Single>(&self, normal: Vector<F>) -> Vector<F> {
        let token = normal.x.token();
        let [up, middle, more] = [
            Vector::splat(token, self.up),
            Vector::splat(token, self.middle),
            Vector::splat(token, self.more),
        ];
        // Within what exact arithmetic gives, so that no light is below 0.
        let one = normal.x.same(1.0);
        let height = normal.dot(up).min(one).max(-one);
        middle + more.scale(height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_colour_goes_from_the_grounds_to_the_skys() {
        let (sky, ground) = (DVec3::new(0.5, 0.75, 1.0), DVec3::new(0.25, 0.125, 0.0));
        let light = Hemisphere::new(sky, ground, DVec3::Z);
        let at = |normal: Vec3| Vec3::from(light.at::<f32>(normal.into()));
        assert_eq!(at(Vec3::Z), sky.as_vec3());
        assert_eq!(at(Vec3::NEG_Z), ground.as_vec3());
        assert_eq!(at(Vec3::X), ((sky + ground) / 2.0).as_vec3());
        // A normal that rounding made a little too long.
        assert!(at(Vec3::NEG_Z * 1.000_000_2).min_element() >= 0.0);
    }
}
