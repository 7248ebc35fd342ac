//! The cone of a spot light.

use glam::DVec3;

use crate::math::{Real, Single, Vector};

/// A cone of light with its tip at the light: full strength within the inner angle, none beyond the
/// outer one, and in between the square of a linear ramp of the cosine, as in glTF's
/// `KHR_lights_punctual`.
///
/// Cosines are in double precision: single precision cannot resolve those of narrow cones from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Unit direction of the light.
    axis: DVec3,
    /// The cosine of the outer half angle.
    edge: f64,
    /// The cosine of the inner half angle minus that of the outer; 0 for a hard edge.
    rise: f64,
}

impl Cone {
    /// The cone around the unit vector `axis`, with these half angles in degrees, 0 <= inner <=
    /// outer <= 90.
    pub fn new(axis: DVec3, inner: f64, outer: f64) -> Self {
        let [inner, edge] = [inner, outer].map(cosine);
        Self { axis, edge, rise: inner - edge }
    }

    /// Its unit axis, and the sine and the cosine of its outer half angle.
    pub fn shape(&self) -> (DVec3, [f64; 2]) {
        (self.axis, [(1.0 - self.edge * self.edge).max(0.0).sqrt(), self.edge])
    }

    /// The share of the light that arrives if `towards`, of any length, points to the light.
    #[inline(always)]
    pub fn at<F: Single>(&self, towards: Vector<F>) -> F {
        let wide = towards.widen().normalize_wide();
        let zero = wide.x.zero();
        let above = -wide.dot(Vector::alike(zero, self.axis)) - zero.same(self.edge);
        let one = zero.same(1.0);
        // A hard edge has no ramp: everything inside has full strength.
        let part = if self.rise > 0.0 { (above / zero.same(self.rise)).min(one) } else { one };
        F::narrow(F::Double::select(above.gt(zero), part * part, zero))
    }
}

/// The cosine of an angle in degrees; exact for half spaces.
fn cosine(degrees: f64) -> f64 {
    if degrees == 90.0 { 0.0 } else { libm::cos(degrees.to_radians()) }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// The share that arrives at `degrees` off the axis.
    fn at(inner: f64, outer: f64, degrees: f64) -> f32 {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        let from = DVec3::new(sin, -cos, 0.0).as_vec3();
        Cone::new(DVec3::NEG_Y, inner, outer).at((-from * 7.0).into())
    }

    #[test]
    fn a_hard_edge_is_at_its_angle_even_where_the_cone_is_a_needle() {
        for outer in [1e-4, 0.01, 1.0, 45.0, 89.0] {
            assert_eq!(
                [at(outer, outer, outer * 0.999), at(outer, outer, outer * 1.001)],
                [1.0, 0.0],
                "{outer}"
            );
        }
    }

    #[test]
    fn a_cone_of_90_degrees_ends_at_the_plane_and_one_of_0_is_dark() {
        let half = Cone::new(DVec3::NEG_Y, 90.0, 90.0);
        for (height, part) in [(1e-30, 1.0), (0.0, 0.0), (-1e-30, 0.0)] {
            assert_eq!(half.at::<f32>(Vec3::new(1.0, height, 3.0).into()), part, "{height}");
        }
        assert_eq!(Cone::new(DVec3::NEG_Y, 0.0, 0.0).at::<f32>(Vec3::Y.into()), 0.0);
    }

    #[test]
    fn a_light_in_the_point_itself_gives_a_number() {
        for outer in [0.0, 30.0, 90.0] {
            assert_eq!(Cone::new(DVec3::X, 0.0, outer).at::<f32>(Vec3::ZERO.into()), 0.0);
        }
    }
}
