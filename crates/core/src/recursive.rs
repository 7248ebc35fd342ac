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
    Arithmetic, Footprint, Hemisphere, Light, LightPoint, ShadingPoint, ShadowRequest, shade,
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
    /// The radiance along the camera ray of `stream`, through the pixel (`x`, `y`), without a meaning
    /// if it is `cancelled`.
    pub fn path(
        &mut self,
        scene: &PreparedScene,
        [x, y]: [u32; 2],
        stream: Stream,
        cancelled: &dyn Fn() -> bool,
        observer: &mut impl Observer,
    ) -> Vec3 {
        let ray = scene.camera.ray(x, y, &stream);
        self.counters.rays.primary += 1;
        self.counters.samples.lens += u64::from(scene.camera.has_lens());
        let state = PathState { media: self.start, ..PathState::default() };
        let footprint = Footprint::Camera(scene.camera.footprint(stream.sample));
        let first = Branch { ray, throughput: Vec3::ONE, state, footprint };
        let radiance = Vec3::ZERO;
        Path { tracer: self, scene, stream, cancelled, observer, radiance }.follow(first)
    }
}

/// A path that is followed.
struct Path<'a, P, O> {
    tracer: &'a mut Recursive<P>,
    scene: &'a PreparedScene,
    /// That of the ray it has come to.
    stream: Stream,
    cancelled: &'a dyn Fn() -> bool,
    observer: &'a mut O,
    /// The radiance gathered so far.
    radiance: Vec3,
}

impl<P: Arithmetic, O: Observer> Path<'_, P, O> {
    /// Follows a ray, and those that wait, to their ends. Returns the radiance.
    #[inline]
    fn follow(mut self, mut ray: Branch) -> Vec3 {
        loop {
            let before = self.tracer.waiting.len();
            let end = self.trace(ray);
            let waiting = &mut self.tracer.waiting;
            self.observer.done(self.radiance, &waiting[before..], end);
            Branch::sink(waiting, before);
            if self.stream.bounce + 1 == MOST_RAYS && !waiting.is_empty() {
                self.tracer.counters.cut_short += 1;
                waiting.clear();
            }
            if self.ends() {
                self.tracer.waiting.clear();
            }
            let Some(next) = self.tracer.waiting.pop() else { return self.radiance };
            self.tracer.counters.rays.secondary += 1;
            self.stream.bounce += 1;
            ray = next;
        }
    }

    /// Whether to end, before a step.
    #[inline]
    fn ends(&mut self) -> bool {
        let Recursive { steps, ended, .. } = &mut *self.tracer;
        *steps = steps.wrapping_add(1);
        if steps.is_multiple_of(STEPS) {
            *ended |= (self.cancelled)();
        }
        *ended
    }

    /// Adds the light of a ray's hit. Rays that go on from there wait; returns why none does if there is none.
    #[inline]
    fn trace(&mut self, mut at: Branch) -> PathEnd {
        let Self { tracer, scene, observer, radiance, .. } = &mut *self;
        let Branch { ray, state, .. } = at;
        let before = tracer.traversal.tests;
        let found = scene.accel.search::<P>().closest(&ray, &mut tracer.traversal);
        let hit = if state.next.is_miss() { found } else { state.next };
        observer.ray(&at, &hit, each(tracer.traversal.tests, before, |a, b| a - b));
        if scene.plan.schedule().has_transmission() {
            at.throughput *= scene.remaining(&ray, &state.media, hit.t);
        }
        let look_ups = &mut tracer.counters.samples;
        // By reference: a copy of a shading point takes time.
        let (end, color) = match &scene.interaction::<P>(&ray, &hit, at.footprint, look_ups) {
            Interaction::Surface(point, class) => return self.shade((&at, &hit), point, class),
            Interaction::Light(color) => (PathEnd::Light, Some(*color)),
            Interaction::Nothing => (PathEnd::Nothing, scene.escaped(ray.direction, &state)),
        };
        if let Some(color) = color {
            *radiance += scene.shown(&state, at.throughput, color) * color;
        }
        end
    }

    /// As [`Self::trace`], of a hit on a surface.
    #[inline]
    fn shade(
        &mut self,
        (at, hit): (&Branch, &Hit),
        point: &ShadingPoint<f32>,
        class: &Class,
    ) -> PathEnd {
        let (scene, state, schedule) = (self.scene, at.state, self.scene.plan.schedule());
        let transparency = class.transparency.as_ref().filter(|_| schedule.has_transmission());
        let scattered = transparency.map(|transparency| {
            let memory = (&mut self.tracer.traversal, &mut self.tracer.counters.samples);
            scene.scatter::<P>(at, hit, transparency, point, memory)
        });
        let own = scattered.map_or(at.throughput, |(own, _)| own);
        let own = scene.shown(&state, own, point.emission.into());
        let local = point.local_light(scene.ambient, scene.hemisphere.as_ref());
        self.radiance += own * Vec3::from(local);
        self.observer.surface(point, class);
        if schedule.has_shadows() && point.lit {
            self.direct_light(point, state.media, if state.faint { Vec3::ZERO } else { own });
        }
        let goes_on = scattered.is_some() || schedule.has_mirrors();
        let is_last = state.bounces >= if goes_on { scene.bounces } else { 0 };
        match scattered {
            Some((_, branches)) => self.tracer.waiting.extend(branches.into_iter().rev().flatten()),
            None if is_last => {}
            None => self.mirror((at, hit), point),
        }
        if is_last { PathEnd::LastBounce } else { PathEnd::NoMirror }
    }

    /// Lets the mirror ray of an opaque surface wait, if there is one.
    #[inline]
    fn mirror(&mut self, (at, hit): (&Branch, &Hit), point: &ShadingPoint<f32>) {
        let (scene, look_ups) = (self.scene, &mut self.tracer.counters.samples);
        let Some((ray, throughput)) = mirror_ray(point, at.throughput) else { return };
        let mut footprint = at.footprint;
        if scene.carries_differentials() {
            let mirrored = scene.mirrored(footprint, (&at.ray, hit), point, look_ups);
            footprint = Footprint::Carried(mirrored);
        }
        let state = at.state.mirrored();
        self.tracer.waiting.push(Branch { ray, throughput, state, footprint });
    }

    /// Adds the unoccluded contribution of each point of each light, to a path of this throughput that is inside of
    /// `media` there.
    #[inline]
    fn direct_light(&mut self, point: &ShadingPoint<f32>, media: MediumStack, throughput: Vec3) {
        let (scene, ambient) = (self.scene, self.scene.hemisphere.as_ref());
        for (number, light) in scene.lights.iter().enumerate() {
            for index in 0..light.samples() {
                if self.ends() {
                    return;
                }
                let point_of_light = [number, index as usize];
                let target = light.point(index, &self.stream);
                self.tracer.counters.samples.light += u64::from(light.is_sampled());
                let request = shadow_request(point, throughput, light, &target, ambient);
                let Some(request) = request else {
                    self.observer.light(point_of_light, &target, None);
                    continue;
                };
                let transmittance = self.transmittance(&request, media);
                self.observer.light(point_of_light, &target, Some((&request, transmittance)));
                if let Some(transmittance) = transmittance {
                    self.radiance += Vec3::from(request.contribution) * transmittance;
                }
            }
        }
    }

    /// The share of light that passes along a shadow ray; `None` if it is blocked.
    #[inline]
    fn transmittance(&mut self, request: &ShadowRequest<f32>, media: MediumStack) -> Option<Vec3> {
        let (scene, ray) = (self.scene, request.ray());
        let Recursive { crossings, traversal, counters, .. } = &mut *self.tracer;
        counters.rays.shadow += 1;
        counters.lights_at_surface += u64::from(request.at_light);
        if scene.accel.search::<P>().occluded(&ray, traversal) {
            return None;
        }
        if !scene.plan.schedule().has_transmission() {
            return Some(Vec3::ONE);
        }
        let look_ups = &mut counters.samples;
        Some(scene.transmittance::<P>((&ray, media), crossings, traversal, look_ups))
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
