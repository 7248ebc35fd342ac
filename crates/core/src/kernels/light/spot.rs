//! The cone of a spot light.

use glam::DVec3;

use crate::math::real::{Real, Single};
use crate::math::vector::Vector;

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
        let axis =
            Vector::new(zero.same(self.axis.x), zero.same(self.axis.y), zero.same(self.axis.z));
        let above = -wide.dot(axis) - zero.same(self.edge);
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
