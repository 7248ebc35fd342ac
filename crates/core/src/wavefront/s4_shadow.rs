//! Pass 4: light at the lit points.
//!
//! For each light, block of points and sample, every point sends a shadow ray into a queue, which is
//! traced when it is full. A path thus receives its contributions in the order of lights and samples
//! for any size of the queue and of the blocks, and neighbouring rays in the queue go from
//! neighbouring points to one part of the light.

use std::marker::PhantomData;
use std::ops::Range;

use super::batch::room;
use super::{Batch, SortedHits, Wavefront};
use crate::counters::Counters;
use crate::kernels::shade::{SHADOW_END, shadow_request};
use crate::kernels::{Arithmetic, Light, ShadowRequest};
use crate::math::{AnyWidth, Mask, Single, Stream, dispatch_any_width};
use crate::plan::schedule::Step;
use crate::prepared::{Group, PreparedScene, SampleCounts, ShadowCrossings};

impl<P: Arithmetic> Wavefront<P> {
    /// Adds every light's contributions to the paths. Returns whether it added all: it was not `cancelled`.
    pub(super) fn shadow(
        &mut self,
        scene: &PreparedScene,
        bounce: u32,
        cancelled: &dyn Fn() -> bool,
    ) -> bool {
        for light in &scene.lights {
            let mut next = NextRequest::default();
            while next.block < self.batch.lit.len() {
                let Self { seed, batch, counters, .. } = self;
                let requests =
                    ShadowRequests { scene, light, seed: *seed, bounce, batch, counters, next };
                next = dispatch_any_width(scene.accel.level, requests);
                self.trace(scene);
                if cancelled() {
                    return false;
                }
            }
        }
        true
    }

    /// Traces the queue and adds the unoccluded contributions.
    fn trace(&mut self, scene: &PreparedScene) {
        if self.batch.shadows.is_empty() {
            return;
        }
        let mut occluded = std::mem::take(&mut self.batch.occluded);
        occluded.resize(room(self.batch.capacity()), false);
        let answers = &mut occluded[..self.batch.shadows.len()];
        let rays = self.batch.shadows.all(None, SHADOW_END);
        scene.accel.search::<P>().occluded_of(rays, answers, &mut self.traversal);
        if scene.plan.schedule().has_transmission() {
            self.weaken(scene, answers);
        }
        let Batch { shadows, paths, .. } = &mut self.batch;
        for (i, _) in answers.iter().enumerate().filter(|(_, occluded)| !**occluded) {
            paths.radiance.add(shadows.path[i] as usize, shadows.throughput.get(i));
        }
        shadows.clear();
        self.batch.occluded = occluded;
    }

    /// Takes the light from unoccluded shadow rays that transparent surfaces keep.
    #[inline(never)]
    fn weaken(&mut self, scene: &PreparedScene, occluded: &mut [bool]) {
        let Self { batch, traversal, counters, .. } = self;
        let Batch { shadows, crossings, sorted, media, .. } = batch;
        let mut next = 0;
        while next < occluded.len() {
            let rays = (shadows.all(None, SHADOW_END), next);
            let path = &shadows.path;
            let inside = |ray: usize| media[path[ray] as usize];
            next = scene.collect_crossings::<P>(rays, occluded, &inside, crossings, traversal);
            let precision = PhantomData::<P>;
            let look_ups = &mut counters.samples;
            let evaluated = EvaluatedCrossings { scene, crossings, sorted, look_ups, precision };
            dispatch_any_width(scene.accel.level, evaluated);
            crossings.transmittances(scene, traversal, |ray, transmittance| {
                shadows.throughput.set(ray, shadows.throughput.get(ray) * transmittance);
            });
        }
    }
}

/// Most pairs of lit points and points of a light until the queue is traced: where light reaches none, it does
/// not fill.
const MOST_POINTS: usize = 1 << 20;

/// Lit points that send rays to all points of a light before the next ones do: few enough that they stay in
/// the nearest cache, and enough that neighbouring rays in the queue go to one part of the light: with 16,
/// rays of ambient light took half as long again; with 64 to 256, the same.
const BLOCK: usize = 128;

/// Where to continue the requests for a light: the first lit point of a block, the light's sample
/// point, and the first of a group of lit points in the block.
#[derive(Clone, Copy, Default)]
struct NextRequest {
    block: usize,
    index: u32,
    point: usize,
}

/// Queues shadow rays to a light.
struct ShadowRequests<'a> {
    scene: &'a PreparedScene,
    light: &'a Light,
    seed: u64,
    bounce: u32,
    batch: &'a mut Batch,
    counters: &'a mut Counters,
    next: NextRequest,
}

impl AnyWidth for ShadowRequests<'_> {
    type Output = NextRequest;

    #[inline(always)]
    fn run<F: Single>(mut self, token: F::Token) -> NextRequest {
        let capacity = self.batch.capacity();
        let mut seen = 0;
        while self.next.block < self.batch.lit.len() {
            let block = self.next.block..self.batch.lit.len().min(self.next.block + BLOCK);
            let streams = self.pixels_and_samples(block.clone());
            while self.next.index < self.light.samples() {
                while self.next.point < block.end {
                    if self.batch.shadows.len() >= capacity || seen >= MOST_POINTS {
                        return self.next;
                    }
                    seen += F::LANES;
                    let lanes = self.next.point - block.start..;
                    let streams = [&streams[0][lanes.clone()], &streams[1][lanes]];
                    self.queue::<F>(token, F::LANES.min(block.end - self.next.point), streams);
                    self.next.point += F::LANES;
                }
                self.next.index += 1;
                self.next.point = block.start;
            }
            self.next = NextRequest { block: block.end, index: 0, point: block.end };
        }
        self.next
    }
}

impl ShadowRequests<'_> {
    /// The pixels and the samples of these lit points, if the light draws numbers by them.
    #[inline(always)]
    fn pixels_and_samples(&self, points: Range<usize>) -> [[u32; BLOCK]; 2] {
        let mut streams = [[0; BLOCK]; 2];
        if self.light.is_sampled() {
            let Batch { lit, paths, .. } = &*self.batch;
            for (i, &path) in lit.path[points].iter().enumerate() {
                (streams[0][i], streams[1][i]) =
                    (paths.pixel[path as usize], paths.sample[path as usize]);
            }
        }
        streams
    }

    /// Queues the rays of the next `count` lit points, of these pixels and samples.
    #[inline(always)]
    fn queue<F: Single>(&mut self, token: F::Token, count: usize, streams: [&[u32]; 2]) {
        let NextRequest { index, point, .. } = self.next;
        let Self { scene, light, counters, batch, .. } = self;
        let Batch { lit, tints, shadows, .. } = &mut **batch;
        let used = (1_u64 << count) - 1;
        let (mut points, throughput) = lit.load::<F>(token, point, used as u32);
        if scene.plan.schedule().runs(Step::Tints) {
            points.reflection.tint = tints.tint.load(token, point);
        }
        let stream = Stream { seed: self.seed, pixel: 0, sample: 0, bounce: self.bounce };
        let targets = light.points::<F>(token, index, stream, streams);
        counters.samples.light += if light.is_sampled() { count as u64 } else { 0 };
        let ambient = scene.hemisphere.as_ref();
        let request = shadow_request(&points, throughput, light, &targets, ambient);
        let Some(request) = request else { return };
        shadows.provide();
        let ShadowRequest { line, contribution, asked, at_light } = request;
        let path = &lit.path[point..point + F::LANES];
        counters.rays.shadow += shadows.push_lanes(&line, contribution, asked, path);
        let at_light = (at_light & asked).bits();
        counters.lights_at_surface += u64::from(at_light.count_ones());
    }
}

/// Evaluates crossings, those of one class and kind of primitive together.
struct EvaluatedCrossings<'a, P> {
    scene: &'a PreparedScene,
    crossings: &'a mut ShadowCrossings,
    sorted: &'a mut SortedHits,
    look_ups: &'a mut SampleCounts,
    precision: PhantomData<P>,
}

impl<P: Arithmetic> AnyWidth for EvaluatedCrossings<'_, P> {
    type Output = ();

    #[inline(always)]
    fn run<F: Single>(self, token: F::Token) {
        let Self { scene, crossings, sorted, look_ups, .. } = self;
        for i in 0..crossings.len() {
            let (face, kind) = crossings.face(i, scene);
            sorted.push(face, scene.appearance.shapes[face.shape as usize].class, kind);
        }
        let mut group = Group::<F>::default();
        for (kind, faces) in sorted.sort() {
            for faces in faces.chunks(F::LANES) {
                crossings.evaluate::<F, P>(token, scene, (kind, faces), &mut group, look_ups);
            }
        }
    }
}
