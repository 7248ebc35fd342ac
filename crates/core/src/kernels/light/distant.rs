//! Light from infinitely far away: parallel rays, or rays from a round patch of the sky.

use glam::{DMat3, DVec3, Vec3};

use crate::math::float::normalize_f64;
use crate::math::sampling;
use crate::math::{Real, Single, Vector};

/// The direction and size of a distant light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distant {
    /// The unit vector to the centre of the patch, and two unit vectors orthogonal to it and to
    /// each other.
    axes: [DVec3; 3],
    /// 1 minus the cosine of the patch's angular radius; 0 for parallel rays.
    height: f64,
    /// Length of shadow rays: a power of two, so that scaling does not round their directions.
    reach: f64,
}

impl Distant {
    /// Light from the unit vector `towards`, from a patch of `angle` degrees in diameter, up to
    /// 180. `diameter` bounds the distance between any two points of the scene.
    pub fn new(towards: DVec3, angle: f64, diameter: f64) -> Self {
        let right = normalize_f64(towards.any_orthogonal_vector());
        let half_sine = libm::sin((angle / 4.0).to_radians());
        Self {
            axes: [towards, right, towards.cross(right)],
            height: 2.0 * half_sine * half_sine,
            reach: Self::reach(diameter),
        }
    }

    /// Turns the patch.
    pub fn turn(&mut self, by: &DMat3) {
        self.axes = self.axes.map(|axis| *by * axis);
    }

    /// The length of a vector that leaves a scene of this `diameter`: at least twice that, as a
    /// shadow ray skips the last part of its way.
    pub fn reach(diameter: f64) -> f64 {
        // A scene of one point may have any diameter.
        let (_, exponent) = libm::frexp(if diameter > 0.0 { diameter } else { 1.0 });
        libm::ldexp(1.0, exponent + 1)
    }

    /// Whether all its rays are parallel.
    #[inline(always)]
    pub fn is_parallel(&self) -> bool {
        self.height == 0.0
    }

    /// The unit vector to the centre of the patch.
    pub fn towards(&self) -> DVec3 {
        self.axes[0]
    }

    /// The sine of the patch's angular radius.
    pub fn spread(&self) -> f64 {
        (self.height * (2.0 - self.height)).sqrt()
    }

    /// The vector from any point to beyond the scene, towards the centre of the patch.
    #[inline(always)]
    pub fn middle(&self) -> Vec3 {
        (self.axes[0] * self.reach).as_vec3()
    }

    /// The same towards the patch's points for points of the unit square, which preserves areas.
    #[inline(always)]
    pub fn at<F: Single>(&self, square: [F; 2]) -> Vector<F> {
        let ([across, along], below) = sampling::cap(square, self.height);
        let [towards, right, up] = self.axes;
        let axis = |axis: DVec3| Vector::alike(below, axis);
        let direction = axis(towards).scale(below.same(1.0) - below)
            + axis(right).scale(across)
            + axis(up).scale(along);
        Vector::narrow(direction.scale(below.same(self.reach)))
    }
}
