//! Pass 4: light that reaches the lit points.
//!
//! Light by light, a shadow ray for each of its samples from each point, traced whenever the queue
//! is full. A path thus gets its contributions in the order of lights and samples, whatever the
//! size of the queue.

use super::batch::{Batch, ShadowRays};
use crate::accel::Traversal;
use crate::counters::Counters;
use crate::kernels::light::{Emitter, Light, LightPoint};
use crate::kernels::precision::Arithmetic;
use crate::kernels::shade::shadow_request;
use crate::math::random::Stream;
use crate::math::real::{Mask, Single};
use crate::math::simd::{Pass, dispatch_pass};
use crate::math::vector::Vector;
use crate::prepared::PreparedScene;

/// Adds every light's contributions to the paths.
pub(super) fn run<P: Arithmetic>(
    scene: &PreparedScene,
    seed: u64,
    bounce: u32,
    batch: &mut Batch,
    traversal: &mut Traversal,
    counters: &mut Counters,
) {
    for light in &scene.lights {
        let mut next = Next::default();
        while next.point < batch.lit.len() {
            let request = Request { light, seed, bounce, batch, counters, next };
            next = dispatch_pass(scene.accel.level, request);
            trace::<P>(scene, batch, traversal);
        }
    }
}

/// Where the requests for a light go on: the first of a group of points, and the light's point.
#[derive(Clone, Copy, Default)]
struct Next {
    point: usize,
    index: u32,
}

/// Queues shadow rays to a light until the queue is full. Where it has to go on, with a point
/// beyond the last once all are queued.
struct Request<'a> {
    light: &'a Light,
    seed: u64,
    bounce: u32,
    batch: &'a mut Batch,
    counters: &'a mut Counters,
    next: Next,
}

impl Pass for Request<'_> {
    type Output = Next;

    #[inline(always)]
    fn run<F: Single>(self, token: F::Token) -> Next {
        let Self { light, counters, batch, mut next, .. } = self;
        let capacity = batch.capacity();
        let Batch { lit, paths, shadows, .. } = batch;
        let (samples, sampled) = (light.samples(), light.is_sampled());
        while next.point < lit.len() {
            let count = F::LANES.min(lit.len() - next.point);
            let used = (1_u64 << count) - 1;
            let (points, throughput) = lit.load::<F>(token, next.point, used as u32);
            let path = &lit.path[next.point..next.point + F::LANES];
            let stream = |lane: usize| {
                let path = path[lane] as usize;
                let (pixel, sample) = (paths.pixel[path], paths.sample[path]);
                Stream { seed: self.seed, pixel, sample, bounce: self.bounce }
            };
            while next.index < samples {
                if shadows.len() >= capacity {
                    return next;
                }
                let targets = targets::<F>(token, light, next.index, count, stream);
                counters.light_samples += if sampled { count as u64 } else { 0 };
                next.index += 1;
                let request = shadow_request(&points, throughput, light, &targets);
                let Some(request) = request else { continue };
                counters.shadow_rays += shadows.push_lanes(&request, path) as u64;
                let at_light = (request.at_light & request.asked).bits();
                counters.lights_at_surface += u64::from(at_light.count_ones());
            }
            next = Next { point: next.point + F::LANES, index: 0 };
        }
        next
    }
}

/// The light's `index`th point for each of `count` lanes.
#[inline(always)]
fn targets<F: Single>(
    token: F::Token,
    light: &Light,
    index: u32,
    count: usize,
    stream: impl Fn(usize) -> Stream,
) -> LightPoint<F> {
    if let Emitter::Point(position) = light.emitter {
        return LightPoint::of_point(token, position);
    }
    let mut rows = <[[F::Row; 3]; 3]>::default();
    for lane in 0..count {
        let target = light.point(index, &stream(lane));
        let values = [target.position, target.error, target.normal];
        for ([x, y, z], value) in rows.iter_mut().zip(values) {
            (x.as_mut()[lane], y.as_mut()[lane], z.as_mut()[lane]) = (value.x, value.y, value.z);
        }
    }
    let [position, error, normal] = rows.each_ref().map(|rows| Vector::load(token, rows));
    LightPoint { position, error, normal }
}

/// Traces the queue and adds what arrives.
fn trace<P: Arithmetic>(scene: &PreparedScene, batch: &mut Batch, traversal: &mut Traversal) {
    let mut occluded = std::mem::take(&mut batch.shadows.occluded);
    let answers = &mut occluded[..batch.shadows.len()];
    scene.accel.search::<P>().occluded_of(&batch.shadows, answers, traversal);
    let shadows: &ShadowRays = &batch.shadows;
    for (i, _) in answers.iter().enumerate().filter(|(_, occluded)| !**occluded) {
        batch.paths.radiance.add(shadows.path[i] as usize, shadows.contribution.get(i));
    }
    batch.shadows.occluded = occluded;
    batch.shadows.clear();
}
