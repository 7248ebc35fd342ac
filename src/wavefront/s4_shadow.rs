//! Pass 4: light that reaches the lit points.
//!
//! Light by light, a shadow ray for each of its samples from each point, traced whenever the queue
//! is full. A path thus gets its contributions in the order of lights and samples, whatever the
//! size of the queue.

use super::batch::{Batch, ShadowRays};
use crate::accel::Traversal;
use crate::counters::Counters;
use crate::kernels::light::Light;
use crate::kernels::shade::{self, ShadingPoint};
use crate::math::random::Stream;
use crate::prepared::PreparedScene;

/// Adds every light's contributions to the paths.
pub(super) fn run(
    scene: &PreparedScene,
    seed: u64,
    bounce: u32,
    batch: &mut Batch,
    traversal: &mut Traversal,
    counters: &mut Counters,
) {
    if batch.lit.is_empty() {
        return;
    }
    for light in &scene.lights {
        for i in 0..batch.lit.len() {
            let path = batch.lit.path[i] as usize;
            let stream = Stream {
                seed,
                pixel: batch.paths.pixel[path],
                sample: batch.paths.sample[path],
                bounce,
            };
            let point = batch.lit.get(i);
            for index in 0..light.samples() {
                if batch.shadows.len() == batch.capacity() {
                    trace(scene, batch, traversal);
                }
                request(batch, i, &point, light, index, &stream, counters);
            }
        }
        trace(scene, batch, traversal);
    }
}

/// Queues the shadow ray to the light's `index`th point, if it could add anything.
#[inline]
fn request(
    batch: &mut Batch,
    i: usize,
    point: &ShadingPoint,
    light: &Light,
    index: u32,
    stream: &Stream,
    counters: &mut Counters,
) {
    let target = light.point(index, stream);
    counters.light_samples += u64::from(light.is_sampled());
    let throughput = batch.lit.throughput.get(i);
    if let Some(request) = shade::shadow_request(point, throughput, light, &target) {
        counters.shadow_rays += 1;
        counters.lights_at_surface += u64::from(request.at_light);
        batch.shadows.push(&request, batch.lit.path[i]);
    }
}

/// Traces the queue and adds what arrives.
fn trace(scene: &PreparedScene, batch: &mut Batch, traversal: &mut Traversal) {
    let mut occluded = std::mem::take(&mut batch.shadows.occluded);
    scene.accel.occluded_of(&batch.shadows, &mut occluded, traversal);
    let shadows: &ShadowRays = &batch.shadows;
    for (i, _) in occluded.iter().enumerate().filter(|(_, occluded)| !**occluded) {
        batch.paths.radiance.add(shadows.path[i] as usize, shadows.contribution.get(i));
    }
    batch.shadows.occluded = occluded;
    batch.shadows.clear();
}
