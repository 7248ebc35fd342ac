//! Light from infinitely far away: parallel rays, or all that come from a round patch of the sky.

use glam::{DVec3, Vec2, Vec3};

use crate::math::float::normalize_f64;
use crate::math::sampling;

/// Where such light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distant {
    /// To the middle of the patch, of unit length, and two directions at right angles to it and to each other.
    axes: [DVec3; 3],
    /// One less the cosine of the patch's angular radius; 0 for parallel rays.
    height: f64,
    /// How far shadow rays go: a power of two, so that their directions are not rounded by it.
    reach: f64,
}

impl Distant {
    /// Light from `towards`, of unit length, from a patch of this angular diameter in degrees, up to 180, in a
    /// scene of which no two points are farther from each other than `diameter`.
    pub fn new(towards: DVec3, angle: f64, diameter: f64) -> Self {
        let right = normalize_f64(towards.any_orthogonal_vector());
        let half_sine = libm::sin((angle / 4.0).to_radians());
        // A scene of one point is as good as any.
        let (_, exponent) = libm::frexp(if diameter > 0.0 { diameter } else { 1.0 });
        Self {
            axes: [towards, right, towards.cross(right)],
            height: 2.0 * half_sine * half_sine,
            // At least twice the diameter: the last part of a shadow ray is not looked at.
            reach: libm::ldexp(1.0, exponent + 1),
        }
    }

    /// Whether all its rays are parallel.
    #[inline(always)]
    pub fn is_parallel(&self) -> bool {
        self.height == 0.0
    }

    /// To the middle of the patch, of unit length.
    pub fn towards(&self) -> DVec3 {
        self.axes[0]
    }

    /// The sine of the patch's angular radius.
    pub fn spread(&self) -> f64 {
        (self.height * (2.0 - self.height)).sqrt()
    }

    /// From any point to beyond the scene, to the middle of the patch.
    #[inline(always)]
    pub fn middle(&self) -> Vec3 {
        (self.axes[0] * self.reach).as_vec3()
    }

    /// The same to the point of the patch that is at `square`: equal areas of one are equal areas of the other.
    #[inline(always)]
    pub fn at(&self, square: Vec2) -> Vec3 {
        let (sideways, below) = sampling::cap(square, self.height);
        let [towards, right, up] = self.axes;
        let direction = towards * (1.0 - below) + right * sideways.x + up * sideways.y;
        (direction * self.reach).as_vec3()
    }
}
