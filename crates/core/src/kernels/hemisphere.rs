//! Ambient light by the normal: that of a sky of one colour and a ground of another, or of an
//! environment.
//!
//! Of a sky and a ground, the sky's share is (1 + n . up) / 2 for a normal n, the unoccluded
//! diffuse reflection of both. Mirror rays that leave the scene show the same colours, with n their
//! direction. The light of an environment is that of its nine lowest spherical harmonics, which hold
//! all but a few per cent of it, though less of a small sun: Ramamoorthi and Hanrahan, *An Efficient
//! Representation for Irradiance Environment Maps* (SIGGRAPH 2001). If light is traced, shadow rays
//! tell how much of it arrives.

use std::f64::consts::PI;

use glam::{DMat3, DVec3, Vec3};

use crate::math::{Single, Vector};

/// Ambient light by the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hemisphere {
    light: Ambient,
    /// Whether lit sides receive it along shadow rays, from a light of its own.
    pub traced: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Ambient {
    Sky {
        /// Direction of the sky, of unit length.
        up: Vec3,
        /// The mean of both colours.
        middle: Vec3,
        /// The sky's colour minus the mean.
        more: Vec3,
    },
    /// The factors of [`harmonics`].
    Harmonics([Vec3; 9]),
}

/// The nine lowest spherical harmonics of a direction, up to factors.
#[inline(always)]
fn harmonics<F: Single>(Vector { x, y, z }: Vector<F>) -> [F; 9] {
    let one = x.same(1.0);
    [one, x, y, z, x * y, y * z, x * z, (z * z).times(3.0) - one, x * x - y * y]
}

/// For each of them, the square of its factor, times the share of its order that a diffuse surface
/// reflects.
const REFLECTED: [f64; 9] = {
    let (zeroth, first) = (1.0 / (4.0 * PI), 3.0 / (4.0 * PI) * (2.0 / 3.0));
    let second = 15.0 / (4.0 * PI) / 4.0;
    [zeroth, first, first, first, second, second, second, second / 12.0, second / 4.0]
};

impl Hemisphere {
    /// Turns the sky; an environment stays.
    pub fn turn(&mut self, by: &DMat3) {
        if let Ambient::Sky { up, .. } = &mut self.light {
            *up = (*by * up.as_dvec3()).as_vec3();
        }
    }

    /// Light with these linear colours, `traced` or not; the unit vector `up` points to the sky.
    pub fn new(sky: DVec3, ground: DVec3, up: DVec3, traced: bool) -> Self {
        let [middle, more] = [(sky + ground) / 2.0, (sky - ground) / 2.0].map(|v| v.as_vec3());
        Self { light: Ambient::Sky { up: up.as_vec3(), middle, more }, traced }
    }

    /// The light of surroundings, in `sums` over parts of them.
    pub fn around(sums: &[[DVec3; 9]], traced: bool) -> Self {
        let factor =
            |i: usize| (sums.iter().map(|sum| sum[i]).sum::<DVec3>() * REFLECTED[i]).as_vec3();
        Self { light: Ambient::Harmonics(std::array::from_fn(factor)), traced }
    }

    /// Sums over parts of the surroundings: for each a unit vector to it, and its colour times its
    /// solid angle.
    pub fn sums(parts: impl Iterator<Item = (Vec3, DVec3)>) -> [DVec3; 9] {
        parts.fold([DVec3::ZERO; 9], |mut sums, (direction, light)| {
            let values = harmonics::<f32>(direction.into());
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += light * f64::from(value));
            sums
        })
    }

    /// 1 in the channels that it has, 0 in the others.
    pub fn channels(&self) -> Vec3 {
        let mean = match self.light {
            Ambient::Sky { middle, .. } => middle,
            Ambient::Harmonics(factors) => factors[0],
        };
        Vec3::select(mean.cmpgt(Vec3::ZERO), Vec3::ONE, Vec3::ZERO)
    }

    /// Whether it adds nothing anywhere.
    pub fn is_black(&self) -> bool {
        self.channels() == Vec3::ZERO
    }

    /// The light that arrives at a surface with this unit normal, or of a sky and a ground along a
    /// mirror ray in this direction.
    #[inline(always)]
    pub fn at<F: Single>(&self, normal: Vector<F>) -> Vector<F> {
        let token = normal.x.token();
        match self.light {
            Ambient::Sky { up, middle, more } => {
                // Each by itself: `map` would become a call, with vectors in memory.
                let (up, middle) = (Vector::splat(token, up), Vector::splat(token, middle));
                let more = Vector::splat(token, more);
                // Clamped to the range of exact arithmetic, so that no light is negative.
                let one = normal.x.same(1.0);
                let height = normal.dot(up).min(one).max(-one);
                middle + more.scale(height)
            }
            Ambient::Harmonics(factors) => {
                let zero = Vector::splat(token, Vec3::ZERO);
                let mut sum = zero;
                // No `fold`, which would become a call.
                for (&factor, &value) in factors.iter().zip(&harmonics(normal)) {
                    sum = sum + Vector::splat(token, factor).scale(value);
                }
                Vector::new(sum.x.max(zero.x), sum.y.max(zero.x), sum.z.max(zero.x))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_that_is_too_long_from_rounding_gives_no_negative_light() {
        let light = Hemisphere::new(DVec3::ONE, DVec3::ZERO, DVec3::Z, false);
        let found = Vec3::from(light.at::<f32>((Vec3::NEG_Z * 1.000_000_2).into()));
        assert!(found.min_element() >= 0.0, "{found}");
    }
}
