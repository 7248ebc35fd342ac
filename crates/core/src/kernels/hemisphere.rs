//! Hemispheric ambient light: a sky of one colour and a ground of another.
//!
//! For a normal n, the sky's share is (1 + n . up) / 2, the unoccluded diffuse reflection of both.
//! Mirror rays that leave the scene show the same colours, with n their direction. If it is traced,
//! shadow rays tell how much of it arrives.

use glam::{DVec3, Vec3};

use crate::math::real::Single;
use crate::math::vector::Vector;

/// The light of a sky and of the ground below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hemisphere {
    /// Direction of the sky, of unit length.
    up: Vec3,
    /// The mean of both colours.
    middle: Vec3,
    /// The sky's colour minus the mean.
    more: Vec3,
    /// Whether lit sides receive it along shadow rays, from a light of its own.
    pub traced: bool,
}

impl Hemisphere {
    /// Light with these linear colours; the unit vector `up` points to the sky.
    pub fn new(sky: DVec3, ground: DVec3, up: DVec3) -> Self {
        let [middle, more] = [(sky + ground) / 2.0, (sky - ground) / 2.0].map(|v| v.as_vec3());
        Self { up: up.as_vec3(), middle, more, traced: false }
    }

    /// Whether it adds nothing anywhere.
    pub fn is_black(&self) -> bool {
        self.middle == Vec3::ZERO
    }

    /// The light that arrives at a surface with this unit normal, or along a mirror ray in this
    /// direction.
    #[inline(always)]
    pub fn at<F: Single>(&self, normal: Vector<F>) -> Vector<F> {
        let token = normal.x.token();
        let [up, middle, more] = [
            Vector::splat(token, self.up),
            Vector::splat(token, self.middle),
            Vector::splat(token, self.more),
        ];
        // Clamped to the range of exact arithmetic, so that no light is negative.
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
        // A normal that is slightly too long from rounding.
        assert!(at(Vec3::NEG_Z * 1.000_000_2).min_element() >= 0.0);
    }
}
