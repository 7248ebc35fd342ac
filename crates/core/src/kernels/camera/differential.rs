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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::kernels::camera::{FovAxis, Placement};
    use crate::math::random::Stream;
    use crate::math::sampling::Sampling;

    fn camera(fov_degrees: f64, size: [u32; 2], antialias: u32) -> Camera {
        let placement = Placement {
            location: DVec3::new(1.0, 2.0, 3.0),
            look: DVec3::new(-4.0, 1.0, 0.5),
            up: DVec3::Y,
            fov_degrees,
            fov_axis: FovAxis::X,
            size,
        };
        Camera::new(&placement, antialias, Sampling::Jittered, None)
    }

    #[test]
    fn the_middle_of_the_image_changes_by_the_width_of_a_pixel() {
        for (fov, antialias) in [(90.0, 1), (90.0, 4), (20.0, 1)] {
            let camera = camera(fov, [100, 50], antialias);
            let [right, up, forward] = camera.basis();
            let Differential { origin, direction } = camera.differential(forward);
            let half = (f64::from(fov as f32) / 2.0).to_radians().tan() as f32;
            let pixel = half / 50.0 / antialias as f32;
            assert_eq!(origin, [Vec3::ZERO; 2]);
            assert!(direction[0].distance(right * pixel) < 1e-6 * pixel, "{direction:?}");
            assert!(direction[1].distance(-up * pixel) < 1e-6 * pixel, "{direction:?}");
        }
    }

    /// As the rays themselves have it, which are rounded.
    #[test]
    fn the_next_pixel_is_a_step_away() {
        let camera = camera(110.0, [640, 480], 1);
        let at = |x, y| {
            let stream = Stream { seed: 0, pixel: 0, sample: 0, bounce: 0 };
            camera.ray(x, y, &stream).direction
        };
        for (x, y) in [(1, 1), (1, 478), (638, 1), (320, 240), (500, 77)] {
            let [right, down] = camera.differential(at(x, y)).direction;
            let across = (at(x + 1, y) - at(x - 1, y)) / 2.0;
            let along = (at(x, y + 1) - at(x, y - 1)) / 2.0;
            let error = right.distance(across).max(down.distance(along));
            assert!(error < 1e-3 * right.length().min(down.length()), "({x}, {y}): {error}");
        }
    }
}
