//! Pass 4: light that reaches the lit points.
//!
//! Light by light, a shadow ray for each of its samples from each point, traced whenever the queue
//! is full. A path thus gets its contributions in the order of lights and samples, whatever the
//! size of the queue.

use fearless_simd::prelude::*;
use fearless_simd::{mask32x8, u32x8};

use super::batch::{Batch, ShadowRays};
use crate::accel::Traversal;
use crate::counters::Counters;
use crate::kernels::light::{Emitter, Light};
use crate::kernels::precision::Arithmetic;
use crate::kernels::shade::lanes::{LightPoints, LitPoints, shadow_requests};
use crate::math::lanes::Vec3x8;
use crate::math::random::Stream;
use crate::math::simd::{Kernel, LANES, Lanes, dispatch};
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
            next = dispatch(scene.accel.level, request);
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

impl Kernel for Request<'_> {
    type Output = Next;

    #[inline(always)]
    fn run<S: Lanes>(self, simd: S) -> Next {
        let Self { light, counters, batch, mut next, .. } = self;
        let capacity = batch.capacity();
        let Batch { lit, paths, shadows, .. } = batch;
        let (samples, sampled) = (light.samples(), light.is_sampled());
        while next.point < lit.len() {
            let count = LANES.min(lit.len() - next.point);
            let used = mask32x8::from_bitmask(simd, (1 << count) - 1);
            let points: LitPoints<S> = lit.load(simd, next.point);
            let rows = next.point..next.point + LANES;
            let path = u32x8::from_slice(simd, &lit.path[rows]);
            let stream = |lane: usize| {
                let path = lit.path[next.point + lane] as usize;
                let (pixel, sample) = (paths.pixel[path], paths.sample[path]);
                Stream { seed: self.seed, pixel, sample, bounce: self.bounce }
            };
            while next.index < samples {
                if shadows.len() >= capacity {
                    return next;
                }
                let targets = targets(simd, light, next.index, count, stream);
                counters.light_samples += if sampled { count as u64 } else { 0 };
                let requests = shadow_requests(&points, light, &targets);
                let asked = requests.asked & used;
                counters.shadow_rays += shadows.push_lanes(&requests, path, asked) as u64;
                let at_light = (requests.at_light & asked).to_bitmask() & 0xFF;
                counters.lights_at_surface += u64::from(at_light.count_ones());
                next.index += 1;
            }
            next = Next { point: next.point + LANES, index: 0 };
        }
        next
    }
}

/// The light's `index`th point for each of `count` lanes.
#[inline(always)]
fn targets<S: Lanes>(
    simd: S,
    light: &Light,
    index: u32,
    count: usize,
    stream: impl Fn(usize) -> Stream,
) -> LightPoints<S> {
    if let Emitter::Point(position) = light.emitter {
        return LightPoints::same(simd, position);
    }
    let mut rows = [[[0.0; LANES]; 3]; 3];
    for lane in 0..count {
        let target = light.point(index, &stream(lane));
        let values = [target.position, target.error, target.normal];
        for (rows, value) in rows.iter_mut().zip(values) {
            for (row, value) in rows.iter_mut().zip(value.to_array()) {
                row[lane] = value;
            }
        }
    }
    let [position, error, normal] = &rows;
    LightPoints {
        position: Vec3x8::load(simd, position),
        error: Vec3x8::load(simd, error),
        normal: Vec3x8::load(simd, normal),
    }
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
