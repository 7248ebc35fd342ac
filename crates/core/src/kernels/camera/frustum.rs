//! Culling by the camera's frustum, widened by the lens and by rounding.

use std::ops::Range;

use glam::DVec3;

use super::Camera;
use crate::kernels::Aabb;
use crate::math::float::UNIT_ROUNDOFF;

/// How far outside a plane of the frustum a box must be so that no ray meets its content, relative
/// to its distance and the largest coordinate.
///
/// The direction of a ray is off by fewer than 16 roundings, as is its origin on the lens, and the
/// content of a box may be met [`PADDING`](crate::kernels::slab::PADDING), another 16 roundings,
/// beside it. This is eight times their sum.
const OUTSIDE: f64 = 256.0 * UNIT_ROUNDOFF as f64;

impl Camera {
    /// The centre of the lens and its radius; the radius is 0 for a pinhole.
    pub fn pupil(&self) -> (DVec3, f64) {
        (self.origin.as_dvec3(), self.lens.map_or(0.0, |lens| f64::from(lens.radius)))
    }

    /// The least side of a pixel, in scene units, around what is seen at least this far away; and the
    /// largest diameter, in pixels, of the disk that the lens makes of a point there.
    pub fn resolution(&self, distance: f64) -> (f64, f64) {
        let [width, height] = self.size().map(f64::from);
        let [across, up] = self.half.map(|half| half.as_dvec3().length());
        let side = (2.0 * across / width).min(2.0 * up / height);
        // At depth z a pixel is z times as large, and the disk is |1 - z / focal| times as large as the lens.
        let depth = distance / (1.0 + across * across + up * up).sqrt();
        let sharp = self.lens.map_or(f64::INFINITY, |lens| lens.focal.into());
        let most = (1.0 / sharp).max((1.0 / depth - 1.0 / sharp).abs());
        (depth * side, 2.0 * self.pupil().1 * most / side)
    }

    /// Whether any ray of the image may meet the content of the box; false only if none can. Rays
    /// may be off by `widening` times the error at a primitive's box
    /// ([`Instance::widening`](crate::geometry::instance::Instance::widening)).
    pub fn may_see(&self, bounds: &Aabb, widening: f32) -> bool {
        let [width, height] = self.size();
        self.may_see_in([0..width, 0..height], bounds, widening)
    }

    /// As [`Camera::may_see`], for the rays of the pixels in these columns and rows.
    pub fn may_see_in(
        &self,
        [columns, rows]: [Range<u32>; 2],
        bounds: &Aabb,
        widening: f32,
    ) -> bool {
        let (origin, radius) = self.pupil();
        let (low, high) = (bounds.low.as_dvec3(), bounds.high.as_dvec3());
        let (to_middle, half) = ((low + high) / 2.0 - origin, (high - low) / 2.0);
        let size = origin.abs().max(low.abs()).max(high.abs()).max_element();
        let far = size + to_middle.length() + half.length() + radius;
        let margin = OUTSIDE * f64::from(widening) * far;
        // At depth z the rays through the lens are spread by its radius r times |1 - z / focal|, at most r + z r / focal.
        let spread = self.lens.map_or(0.0, |lens| radius / f64::from(lens.focal));
        let forward = self.forward.as_dvec3();
        // A NaN is not certain.
        let is_outside = |normal: DVec3, offset: f64| {
            let reach = normal.dot(to_middle) + normal.abs().dot(half) + offset;
            reach < -margin * normal.length()
        };
        let [width, height] = self.size().map(f64::from);
        // From -1 to 1 across the image, and twice the error of such a position: in single precision it is
        // off by fewer than 4 roundings.
        let position = |pixel: u32, side: f64| f64::from(pixel) * 2.0 / side - 1.0;
        let slack = 8.0 * f64::from(UNIT_ROUNDOFF);
        let [left, right] = [columns.start, columns.end].map(|x| position(x, width));
        let [low, high] = [rows.end, rows.start].map(|y| -position(y, height));
        let sides =
            [(self.right, self.half[0], [left, right]), (self.up, self.half[1], [low, high])];
        !is_outside(forward, 0.0)
            && !sides.into_iter().any(|(axis, half, [low, high])| {
                let (axis, half) = (axis.as_dvec3(), half.as_dvec3().length());
                let slope = |end: f64| forward * ((end + slack) * half + spread);
                is_outside(slope(-low) + axis, radius) || is_outside(slope(high) - axis, radius)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::camera::{FovAxis, Lens, Placement};
    use crate::kernels::slab::SlabRay;
    use crate::math::Stream;
    use crate::math::sampling::Sampling;
    use glam::Vec3;

    fn camera(location: DVec3, fov_degrees: f64, radius: f32, focal: f32) -> Camera {
        let placement = Placement {
            location,
            look: location - DVec3::new(0.3, 0.2, 1.0),
            up: DVec3::Y,
            fov_degrees,
            fov_axis: FovAxis::Smaller,
            size: [32, 20],
        };
        let lens = Lens { radius, focal, sampling: Sampling::Random, grid: [4, 4] };
        Camera::new(&placement, 2, Sampling::Random, (radius > 0.0).then_some(lens))
    }

    /// Numbers from 0 to 1, derived from `n`.
    fn numbers(n: u32) -> [f32; 4] {
        Stream { seed: 7, pixel: n, sample: 0, bounce: 0 }.uniform(0)
    }

    #[test]
    fn a_box_that_a_ray_meets_is_never_out_of_sight() {
        let mut met = 0;
        for n in 0..20_000 {
            let [a, b, c, d] = numbers(n);
            let far = [0.0, 1.0, 1e3, 1e6][n as usize % 4];
            let fov = f64::from(1.0 + 178.0 * a);
            let radius = if b < 0.5 { 0.0 } else { b };
            let camera = camera(DVec3::splat(far * f64::from(c)), fov, radius, 0.1 + 9.0 * d);
            let stream = Stream { seed: 1, pixel: n, sample: n % 64, bounce: 0 };
            let ray = camera.ray(n % 32, n / 32 % 20, &stream);
            // A box at the end of a ray, of which only an edge is met.
            let [e, f, g, h] = numbers(n + 100_000);
            let corner = ray.origin + ray.direction * (e * e * 100.0);
            let size = Vec3::new(f - 0.5, g - 0.5, h - 0.5) * (1.0 + far as f32 * 1e-3);
            let bounds = Aabb::around([corner, corner + size]);
            let [near, far] = SlabRay::new(&ray).interval(&bounds);
            if near <= far && far >= 0.0 {
                met += 1;
                assert!(camera.may_see(&bounds, 1.0), "{n}: {bounds:?} {ray:?}");
                let pixel = [n % 32, n / 32 % 20].map(|first| first..first + 1);
                assert!(camera.may_see_in(pixel, &bounds, 1.0), "{n}: {bounds:?} {ray:?}");
            }
        }
        assert!(met > 15_000, "{met}");
    }
}
