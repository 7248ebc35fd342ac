//! Ray differentials of camera rays.

use glam::Vec3;

use super::Camera;
use crate::kernels::differential::Differential;
use crate::math::real::{Single, both};
use crate::math::vector::Vector;

impl Camera {
    /// The differentials of the camera rays in these directions, for a step to the right and one down
    /// to the next sample. With an antialias of n, a step is an n-th of a pixel.
    ///
    /// The differential of a lens ray is taken at a fixed point of the lens. The ray's direction is
    /// w / |w|, where w goes from that point to the focus at depth f along the view. A step moves
    /// the focus by f times its movement at depth 1, and |w| is f over the forward component of the
    /// direction. So f cancels: the derivative is that of a pinhole's ray in the same direction,
    /// and the origin does not change.
    #[inline(always)]
    pub fn differential<F: Single>(&self, direction: Vector<F>) -> Differential<F> {
        let direction = direction.widen();
        let ahead = direction.dot(Vector::alike(direction.x, self.forward.as_dvec3()));
        let [width, height] = self.size.map(f64::from);
        let [right, up] = self.half.map(|half| half.as_dvec3());
        let samples = f64::from(self.antialias);
        let changes = both(
            [right * (2.0 / width / samples), up * (-2.0 / height / samples)],
            #[inline(always)]
            |step| {
                let step = Vector::alike(direction.x, step);
                let across = step - direction.scale(direction.dot(step));
                Vector::<F>::narrow(across.scale(ahead))
            },
        );
        let still = Vector::splat(changes[0].x.token(), Vec3::ZERO);
        Differential { origin: [still; 2], direction: changes }
    }
}
