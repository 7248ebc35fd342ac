//! The recursive tracer: one path at a time, depth first, over the same kernels as the wavefront.
//! It is the wavefront's competitor and its reference.
//!
//! The recursion of Whitted (1980) is a loop over the rays of a path, each with its throughput: those into which a path
//! scatters at a transparent surface wait on a stack. Light is added in the wavefront's order: by ray, light and sample.

use std::marker::PhantomData;

use glam::Vec3;

use crate::accel::{Hit, Traversal};
use crate::counters::{Counters, Sample, TestCounts, each};
use crate::kernels::{
    Arithmetic, Hemisphere, Light, LightPoint, ShadingPoint, ShadowRequest, shade,
};
use crate::math::{Line, Ray, Stream};
use crate::prepared::{
    Branch, Class, Interaction, MOST_RAYS, MediumStack, PathState, PreparedScene, ShadowCrossings,
};
use crate::tile::{Tracer, Unit, add_sample};

/// The tracer.
#[derive(Debug)]
pub struct Recursive<P> {
    seed: u64,
    traversal: Traversal,
    /// What camera rays are inside of, as at the camera's position.
    start: MediumStack,
    /// The rays of the path that wait.
    waiting: Vec<Branch>,
    /// Memory for the transparent surfaces on a shadow ray.
    crossings: ShadowCrossings,
    counters: Counters,
    /// Rays and points on lights so far.
    steps: u32,
    /// Whether the render was cancelled.
    ended: bool,
    precision: PhantomData<P>,
}

impl<P: Arithmetic> Recursive<P> {
    /// The tracer for `scene`, with the seed of random numbers.
    pub fn new(scene: &PreparedScene, seed: u64) -> Self {
        let mut traversal = scene.accel.traversal();
        Self {
            seed,
            start: scene.media_at_camera::<P>(&mut traversal),
            traversal,
            waiting: Vec::new(),
            crossings: ShadowCrossings::default(),
            counters: Counters::default(),
            steps: 0,
            ended: false,
            precision: PhantomData,
        }
    }
}

impl<P: Arithmetic> Tracer for Recursive<P> {
    fn render(
        &mut self,
        scene: &PreparedScene,
        unit: &Unit,
        sums: &mut [[f64; 3]],
        cancelled: &dyn Fn() -> bool,
    ) -> bool {
        self.traversal.without_t = !scene.needs_t();
        self.ended = false;
        let width = scene.camera.size()[0];
        for (index, sum) in sums.iter_mut().enumerate() {
            let (x, y) = unit.tile.pixel(index as u32);
            for sample in unit.samples.clone() {
                let stream = Stream { seed: self.seed, pixel: y * width + x, sample, bounce: 0 };
                let radiance = self.path(scene, [x, y], stream, cancelled, &mut ());
                if self.ended {
                    return false;
                }
                let sample = Sample { pixel: stream.pixel, sample };
                add_sample(sum, radiance.to_array(), sample, &mut self.counters);
            }
        }
        true
    }

    /// A path is a few numbers on the stack.
    fn bytes(&self) -> u64 {
        0
    }

    fn counters(&self) -> Counters {
        let Traversal { tests, kernels, .. } = self.traversal;
        Counters { tests, kernels, ..self.counters }
    }

    /// It has no passes.
    fn pass_seconds(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }
}

/// The contribution of a light's point, and the share of it that passes along its shadow ray, if there
/// is one: `None` if that is blocked.
pub type TracedLight<'a> = Option<(&'a ShadowRequest<f32>, Option<Vec3>)>;

/// Receives the steps of a path, for a record. A usual render has no observer.
pub trait Observer {
    /// This ray of the path was traced to this hit, with this work.
    fn ray(&mut self, _: &Branch, _: &Hit, _: TestCounts) {}

    /// It hits a surface of this class.
    fn surface(&mut self, _: &ShadingPoint<f32>, _: &Class) {}

    /// What arrives at the surface from the `index`th point of the `light`th light.
    fn light(&mut self, _: [usize; 2], _: &LightPoint<f32>, _: TracedLight<'_>) {}

    /// All is done at the hit: the radiance gathered so far, the rays that go on from here, the next
    /// one last, and why none does if there is none.
    fn done(&mut self, _: Vec3, _: &[Branch], _: PathEnd) {}
}

impl Observer for () {}

/// Why no ray goes on from a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PathEnd {
    /// Its ray hits nothing.
    Nothing,
    /// Its ray hits the shape of a light.
    Light,
    /// The largest number of bounces is reached.
    LastBounce,
    /// The surface is neither a mirror nor transparent, or rays from there could add nothing.
    NoMirror,
}

/// The number of steps, each a ray or a point on a light, after which to ask whether the render is
/// cancelled.
const STEPS: u32 = 1024;

impl<P: Arithmetic> Recursive<P> {
    /// Whether to end, before a step.
    #[inline]
    fn ends(&mut self, cancelled: &dyn Fn() -> bool) -> bool {
        self.steps = self.steps.wrapping_add(1);
        if self.steps.is_multiple_of(STEPS) {
            self.ended |= cancelled();
        }
        self.ended
    }

    /// The radiance along the camera ray of `stream`, through the pixel (`x`, `y`), without a meaning
    /// if it is `cancelled`.
    pub fn path(
        &mut self,
        scene: &PreparedScene,
        [x, y]: [u32; 2],
        mut stream: Stream,
        cancelled: &dyn Fn() -> bool,
        observer: &mut impl Observer,
    ) -> Vec3 {
        let ray = scene.camera.ray(x, y, &stream);
        self.counters.rays.primary += 1;
        self.counters.samples.lens += u64::from(scene.camera.has_lens());
        let schedule = scene.plan.schedule();
        let (shadows, transmits) = (schedule.has_shadows(), schedule.has_transmission());
        let bounces = if schedule.has_mirrors() { scene.bounces } else { 0 };
        let mut radiance = Vec3::ZERO;
        let state = PathState { media: self.start, ..PathState::default() };
        let mut at = Branch { ray, throughput: Vec3::ONE, state, differential: None };
        loop {
            let Branch { ray, state, .. } = at;
            let before = self.traversal.tests;
            let found = scene.accel.search::<P>().closest(&ray, &mut self.traversal);
            let hit = if state.next.is_miss() { found } else { state.next };
            observer.ray(&at, &hit, each(self.traversal.tests, before, |a, b| a - b));
            if transmits {
                at.throughput *= scene.remaining(&ray, &state.media, hit.t);
            }
            let throughput = at.throughput;
            let waiting = self.waiting.len();
            let found =
                scene.interaction::<P>(&ray, &hit, at.differential, &mut self.counters.samples);
            // By reference: a copy of a shading point takes time.
            let end = match &found {
                Interaction::Surface(point, class) => {
                    let transparency = class.transparency.as_ref().filter(|_| transmits);
                    let scattered = transparency.map(|transparency| {
                        let memory = (&mut self.traversal, &mut self.counters.samples);
                        scene.scatter::<P>(&at, &hit, transparency, point, memory)
                    });
                    let own = scattered.map_or(throughput, |(own, _)| own);
                    let own = scene.shown(&state, own, point.emission.into());
                    let local = point.local_light(scene.ambient, scene.hemisphere.as_ref());
                    radiance += own * Vec3::from(local);
                    observer.surface(point, class);
                    if shadows && point.lit {
                        let gathered = (if state.faint { Vec3::ZERO } else { own }, &mut radiance);
                        let at = (point, state.media);
                        self.direct_light(scene, at, &stream, gathered, cancelled, observer);
                    }
                    if let Some((_, branches)) = scattered {
                        self.waiting.extend(branches.into_iter().rev().flatten());
                        if state.bounces >= scene.bounces {
                            PathEnd::LastBounce
                        } else {
                            PathEnd::NoMirror
                        }
                    } else if state.bounces >= bounces {
                        PathEnd::LastBounce
                    } else {
                        if let Some((mirrored, throughput)) = mirror_ray(point, throughput) {
                            let differential = scene.carries_differentials().then(|| {
                                let found = &mut self.counters.samples;
                                scene.mirrored(at.differential, (&ray, &hit), point, found)
                            });
                            let (ray, state) = (mirrored, state.mirrored());
                            self.waiting.push(Branch { ray, throughput, state, differential });
                        }
                        PathEnd::NoMirror
                    }
                }
                Interaction::Light(color) => {
                    radiance += scene.shown(&state, throughput, *color) * *color;
                    PathEnd::Light
                }
                Interaction::Nothing => {
                    if let Some(color) = scene.escaped(ray.direction, &state) {
                        radiance += scene.shown(&state, throughput, color) * color;
                    }
                    PathEnd::Nothing
                }
            };
            observer.done(radiance, &self.waiting[waiting..], end);
            Branch::sink(&mut self.waiting, waiting);
            if stream.bounce + 1 == MOST_RAYS && !self.waiting.is_empty() {
                self.counters.cut_short += 1;
                self.waiting.clear();
            }
            if self.ends(cancelled) {
                self.waiting.clear();
            }
            let Some(next) = self.waiting.pop() else { return radiance };
            self.counters.rays.secondary += 1;
            stream.bounce += 1;
            at = next;
        }
    }

    /// Adds the unoccluded contribution of each point of each light.
    #[inline]
    fn direct_light(
        &mut self,
        scene: &PreparedScene,
        (point, media): (&ShadingPoint<f32>, MediumStack),
        stream: &Stream,
        (throughput, radiance): (Vec3, &mut Vec3),
        cancelled: &dyn Fn() -> bool,
        observer: &mut impl Observer,
    ) {
        for (number, light) in scene.lights.iter().enumerate() {
            for index in 0..light.samples() {
                if self.ends(cancelled) {
                    return;
                }
                let point_of_light = [number, index as usize];
                let target = light.point(index, stream);
                self.counters.samples.light += u64::from(light.is_sampled());
                let ambient = scene.hemisphere.as_ref();
                let request = shadow_request(point, throughput, light, &target, ambient);
                let Some(request) = request else {
                    observer.light(point_of_light, &target, None);
                    continue;
                };
                self.counters.rays.shadow += 1;
                self.counters.lights_at_surface += u64::from(request.at_light);
                let occluded =
                    scene.accel.search::<P>().occluded(&request.ray(), &mut self.traversal);
                let transmittance =
                    (!occluded).then(|| match scene.plan.schedule().has_transmission() {
                        true => {
                            let Self { crossings, traversal, counters, .. } = &mut *self;
                            let look_ups = &mut counters.samples;
                            let ray = (&request.ray(), media);
                            scene.transmittance::<P>(ray, crossings, traversal, look_ups)
                        }
                        false => Vec3::ONE,
                    });
                observer.light(point_of_light, &target, Some((&request, transmittance)));
                if let Some(transmittance) = transmittance {
                    *radiance += Vec3::from(request.contribution) * transmittance;
                }
            }
        }
    }
}

/// See [`shade::shadow_request`]: one copy for every precision and observer.
#[inline(never)]
fn shadow_request(
    point: &ShadingPoint<f32>,
    throughput: Vec3,
    light: &Light,
    target: &LightPoint<f32>,
    ambient: Option<&Hemisphere>,
) -> Option<ShadowRequest<f32>> {
    shade::shadow_request(point, throughput.into(), light, target, ambient)
}

/// The mirror ray of a point and its throughput, if there is one.
#[inline(never)]
fn mirror_ray(point: &ShadingPoint<f32>, throughput: Vec3) -> Option<(Ray, Vec3)> {
    let request = shade::mirror_request(point, throughput.into())?;
    let Line { origin, direction } = request.line;
    Some((Ray::new(origin.into(), direction.into()), request.throughput.into()))
}
