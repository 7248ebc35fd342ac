//! Ray differentials of camera rays.

use glam::Vec3;

use super::Camera;
use crate::kernels::differential::Differential;
use crate::math::float::dot_f64;

impl Camera {
    /// The differential of the camera ray in this direction, for a step to the right and one down
    /// to the next sample. With an antialias of n, a step is an n-th of a pixel.
    ///
    /// The differential of a lens ray is taken at a fixed point of the lens. The ray's direction is
    /// w / |w|, where w goes from that point to the focus at depth f along the view. A step moves
    /// the focus by f times its movement at depth 1, and |w| is f over the forward component of the
    /// direction. So f cancels: the derivative is that of a pinhole's ray in the same direction,
    /// and the origin does not change.
    pub fn differential(&self, direction: Vec3) -> Differential {
        let direction = direction.as_dvec3();
        let ahead = dot_f64(direction, self.forward.as_dvec3());
        let [width, height] = self.size.map(f64::from);
        let [right, up] = self.half.map(|half| half.as_dvec3());
        let samples = f64::from(self.antialias);
        let steps = [right * (2.0 / width / samples), up * (-2.0 / height / samples)];
        let changes = steps.map(|step| {
            let across = step - direction * dot_f64(direction, step);
            (across * ahead).as_vec3()
        });
        Differential { origin: [Vec3::ZERO; 2], direction: changes }
    }
}
