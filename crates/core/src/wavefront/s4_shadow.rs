//! Pass 4: light at the lit points.
//!
//! For each light and sample, every point sends a shadow ray into a queue, which is traced when it
//! is full. A path thus receives its contributions in the order of lights and samples for any size
//! of the queue, and neighbouring rays in the queue go from neighbouring points to one part of the
//! light.

use super::batch::{Batch, ShadowRays};
use super::count;
use crate::accel::{Rays, Traversal};
use crate::counters::Counters;
use crate::kernels::hemisphere::Hemisphere;
use crate::kernels::light::Light;
use crate::kernels::precision::Arithmetic;
use crate::kernels::shade::shadow_request;
use crate::math::random::Stream;
use crate::math::real::{Mask, Single};
use crate::math::simd::{LANES, Pass, dispatch_pass};
use crate::plan::schedule::Step;
use crate::prepared::{LookUps, PreparedScene};

/// Adds every light's contributions to the paths. Returns whether it added all: it was not `cancelled`.
pub(super) fn run<P: Arithmetic>(
    scene: &PreparedScene,
    (seed, bounce): (u64, u32),
    batch: &mut Batch,
    traversal: &mut Traversal,
    counters: &mut Counters,
    cancelled: &dyn Fn() -> bool,
) -> bool {
    let tinted = scene.plan.schedule().runs(Step::Tints);
    for light in &scene.lights {
        let mut next = NextRequest::default();
        while next.index < light.samples() && !batch.lit.is_empty() {
            let request = ShadowRequests {
                light,
                ambient: scene.hemisphere.as_ref(),
                seed,
                bounce,
                tinted,
                batch,
                counters: &mut *counters,
                next,
            };
            next = dispatch_pass(scene.accel.level, request);
            trace::<P>(scene, batch, traversal, counters);
            if cancelled() {
                return false;
            }
        }
    }
    true
}

/// Most pairs of lit points and points of a light until the queue is traced: where light reaches none, it does
/// not fill.
const MOST_POINTS: usize = 1 << 20;

/// The place to continue the requests for a light: its sample point, and the first of a group of
/// lit points.
#[derive(Clone, Copy, Default)]
struct NextRequest {
    index: u32,
    point: usize,
}

/// Queues shadow rays to a light until the queue is full. Returns the place to continue, which is
/// past the light's last point once all are queued.
struct ShadowRequests<'a> {
    light: &'a Light,
    ambient: Option<&'a Hemisphere>,
    seed: u64,
    bounce: u32,
    /// Whether highlights are coloured.
    tinted: bool,
    batch: &'a mut Batch,
    counters: &'a mut Counters,
    next: NextRequest,
}

impl Pass for ShadowRequests<'_> {
    type Output = NextRequest;

    #[inline(always)]
    fn run<F: Single>(self, token: F::Token) -> NextRequest {
        let Self { light, ambient, counters, batch, mut next, .. } = self;
        let capacity = batch.capacity();
        let Batch { lit, tints, paths, shadows, .. } = batch;
        let (samples, sampled) = (light.samples(), light.is_sampled());
        let mut seen = 0;
        while next.index < samples {
            while next.point < lit.len() {
                if shadows.len() >= capacity || seen >= MOST_POINTS {
                    return next;
                }
                seen += F::LANES;
                let count = F::LANES.min(lit.len() - next.point);
                let used = (1_u64 << count) - 1;
                let (mut points, throughput) = lit.load::<F>(token, next.point, used as u32);
                if self.tinted {
                    points.reflection.tint = tints.tint.load(token, next.point);
                }
                let path = &lit.path[next.point..next.point + F::LANES];
                let mut places = [[0; LANES]; 2];
                for lane in 0..if sampled { count } else { 0 } {
                    let path = path[lane] as usize;
                    (places[0][lane], places[1][lane]) = (paths.pixel[path], paths.sample[path]);
                }
                let stream = Stream { seed: self.seed, pixel: 0, sample: 0, bounce: self.bounce };
                let targets =
                    light.points::<F>(token, next.index, stream, [&places[0], &places[1]]);
                counters.light_samples += if sampled { count as u64 } else { 0 };
                next.point += F::LANES;
                let request = shadow_request(&points, throughput, light, &targets, ambient);
                let Some(request) = request else { continue };
                shadows.provide();
                counters.shadow_rays += shadows.push_lanes(&request, path) as u64;
                let at_light = (request.at_light & request.asked).bits();
                counters.lights_at_surface += u64::from(at_light.count_ones());
            }
            next = NextRequest { index: next.index + 1, point: 0 };
        }
        next
    }
}

/// Traces the queue and adds the unoccluded contributions.
fn trace<P: Arithmetic>(
    scene: &PreparedScene,
    batch: &mut Batch,
    traversal: &mut Traversal,
    counters: &mut Counters,
) {
    let mut occluded = std::mem::take(&mut batch.shadows.occluded);
    let answers = &mut occluded[..batch.shadows.len()];
    scene.accel.search::<P>().occluded_of(&batch.shadows, answers, traversal);
    if scene.plan.schedule().has_transmission() {
        weaken::<P>(scene, &mut batch.shadows, answers, traversal, counters);
    }
    let shadows: &ShadowRays = &batch.shadows;
    for (i, _) in answers.iter().enumerate().filter(|(_, occluded)| !**occluded) {
        batch.paths.radiance.add(shadows.path[i] as usize, shadows.contribution.get(i));
    }
    batch.shadows.occluded = occluded;
    batch.shadows.clear();
}

/// Takes the light from unoccluded shadow rays that transparent surfaces keep.
#[inline(never)]
fn weaken<P: Arithmetic>(
    scene: &PreparedScene,
    shadows: &mut ShadowRays,
    occluded: &[bool],
    traversal: &mut Traversal,
    counters: &mut Counters,
) {
    let (mut hits, mut look_ups) = (Vec::new(), LookUps::default());
    for (i, _) in occluded.iter().enumerate().filter(|(_, occluded)| !**occluded) {
        let ray = Rays::from(&*shadows).ray(i);
        let passed = scene.passed::<P>(&ray, &mut hits, traversal, &mut look_ups);
        shadows.contribution.set(i, shadows.contribution.get(i) * passed);
    }
    count(look_ups, counters);
}
