//! What camera rays show: the first three passes, with a row for each path in place of its light.
//!
//! The rays are followed straight on, as far as they pass what they meet: to what shows first, and to the background.

use glam::Vec3;

use super::s3_shade::Shaded;
use super::{Batch, Wavefront};
use crate::accel::Hit;
use crate::kernels::Arithmetic;
use crate::math::float::dot;
use crate::math::{LANES, Mask, Ray, Single, Vector, set_bits};
use crate::prepared::{MOST_RAYS, PreparedScene, surface};
use crate::tile::Unit;
use crate::with_precision;

/// What a camera ray shows.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The ray.
    pub ray: Ray,
    /// What it meets first.
    pub first: Hit,
    /// What shows first; a miss if nothing does. Of what follows, only `passed` is known then.
    pub hit: Hit,
    /// The point.
    pub point: Vec3,
    /// The shading normal, on the side of the ray.
    pub normal: Vec3,
    /// The base colour, or the colour of a light.
    pub albedo: Vec3,
    /// The share of the background that arrives: the mean of red, green and blue.
    pub passed: f64,
}

/// Looks along camera rays, with all memory for one thread.
pub trait Sight: Send {
    /// Calls `each` with the number of the pixel within the unit's tile and what the ray shows, for each path:
    /// those of a pixel in the order of their samples. If it is not `through`, only [`Seen::first`] is found.
    fn look(
        &mut self,
        scene: &PreparedScene,
        unit: &Unit,
        through: bool,
        each: &mut dyn FnMut(usize, &Seen),
    );
}

/// What looks along the rays of a render with this seed.
pub fn sight(scene: &PreparedScene, seed: u64) -> Box<dyn Sight> {
    let batch = super::DEFAULT_BATCH;
    with_precision!(scene.accel.geometry().precision, P => {
        let mut tracer = Wavefront::<P>::new(scene, seed, batch);
        tracer.needs_points = true;
        Box::new(tracer)
    })
}

impl<P: Arithmetic> Sight for Wavefront<P> {
    fn look(
        &mut self,
        scene: &PreparedScene,
        unit: &Unit,
        through: bool,
        each: &mut dyn FnMut(usize, &Seen),
    ) {
        let mut start = 0;
        while start < unit.paths() {
            let end = unit.paths().min(start + self.batch.capacity() as u64);
            self.generate(scene, unit, start..end);
            self.intersect(scene);
            self.batch.see_first();
            for bounce in 0..if through { MOST_RAYS } else { 0 } {
                self.shade(scene, bounce);
                if !self.batch.advance() {
                    break;
                }
                self.intersect(scene);
            }
            let pixels = &self.batch.paths.pixel_of_tile;
            for (seen, &pixel) in self.batch.seen.drain(..).zip(pixels) {
                each(pixel as usize, &seen);
            }
            self.batch.waiting.clear();
            start = end;
        }
    }
}

impl Batch {
    /// Starts the rows of what the camera rays show.
    fn see_first(&mut self) {
        let Self { seen, rays, hits, .. } = self;
        seen.clear();
        seen.extend((0..rays.len()).map(|i| Seen {
            ray: rays.ray(i),
            first: hits[i],
            hit: Hit::MISS,
            point: Vec3::ZERO,
            normal: Vec3::ZERO,
            albedo: Vec3::ZERO,
            passed: 0.0,
        }));
    }

    /// Keeps what the rays meet, if it shows: if surfaces send light of these throughputs to them.
    #[inline(always)]
    pub(super) fn see<F: Single>(&mut self, shaded: &Shaded<'_, F>, own: Vector<F>) {
        let Shaded { group, numbers, path, point, .. } = shaded;
        for lane in set_bits::<LANES>(group.used & own.is_not_zero().bits()) {
            let seen = &mut self.seen[path[lane] as usize];
            if seen.hit.is_miss() {
                seen.hit = self.hits[numbers[lane] as usize];
                seen.point = point.point.lane(lane);
                seen.normal = point.shading_normal.lane(lane);
                seen.albedo = point.color.lane(lane);
            }
        }
    }

    /// As [`Self::see`], for the `i`th ray, which meets the shape of a light of this colour.
    pub(super) fn see_light<P: Arithmetic>(
        &mut self,
        scene: &PreparedScene,
        i: usize,
        color: Vec3,
    ) {
        let seen = &mut self.seen[self.rays.path[i] as usize];
        if seen.hit.is_miss() && self.rays.throughput.get(i) != Vec3::ZERO {
            let (ray, hit) = (self.rays.ray(i), self.hits[i]);
            let at = surface::<P>(scene.accel.geometry(), &ray, &hit);
            let normal: Vec3 = at.normal.into();
            let is_behind = dot(ray.direction, normal) > 0.0;
            let normal = if is_behind { -normal } else { normal };
            (seen.hit, seen.point, seen.normal, seen.albedo) =
                (hit, at.point.into(), normal, color);
        }
    }

    /// Adds the background that the `i`th ray shows.
    pub(super) fn see_nothing(&mut self, i: usize) {
        let throughput = self.rays.throughput.get(i);
        let seen = &mut self.seen[self.rays.path[i] as usize];
        seen.passed += f64::from(throughput.element_sum()) / 3.0;
    }
}
