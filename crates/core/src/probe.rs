//! Probing a pixel: the hit of each of its rays, and the contribution of every light there.
//!
//! It is the recursive tracer that is recorded: the wavefront traces the same rays to the same hits.

mod record;

use std::cell::Cell;

use glam::Vec3;

use crate::accel::{Accel, Hit, Traversal};
use crate::counters::{Sample, TestCounts};
use crate::geometry::{Geometry, Primitive, Quadric};
use crate::kernels::{Arithmetic, LightPoint, Precision, ShadingPoint};
use crate::math::float::{UNIT_ROUNDOFF, normalize};
use crate::math::{Ray, Stream};
use crate::prepared::{Branch, Class, PreparedScene};
use crate::recursive::{Observer, PathEnd, Recursive, TracedLight};
use crate::with_precision;

pub use record::{
    Bounce, HitRecord, InvalidSample, LightRecord, PathRecord, PixelRecord, RayKind, SurfaceRecord,
    Visibility,
};

/// Finds where a sample becomes not finite, by tracing it once more.
pub fn name_invalid(scene: &PreparedScene, at: Sample, seed: u64) -> InvalidSample {
    let width = scene.camera.size()[0];
    let pixel = [at.pixel % width, at.pixel / width];
    let record = self::pixel(scene, pixel, Some(at.sample), seed, &|_| false);
    let path = &record.paths[0];
    let bounce = path.bounces.iter().position(|bounce| !bounce.radiance.is_finite());
    let bounce = bounce.unwrap_or(path.bounces.len().saturating_sub(1));
    let met = path.bounces.get(bounce).and_then(|bounce| bounce.met.as_ref());
    InvalidSample {
        x: pixel[0],
        y: pixel[1],
        sample: at.sample,
        bounce,
        primitive: met.map(|met| met.primitive),
        shape: met.map_or_else(String::new, |met| met.shape.clone()),
    }
}

/// The most paths of a record, unless one is asked for.
const MOST_PATHS: u32 = 16;

/// The number of rays and points on lights after which a record ends, soon: some hundred bytes of text each.
const MOST_RECORDS: u32 = 1 << 16;

/// Records the rays of a pixel: of a `sample`, or of the first ones. It ends early when it is long, or when `ends` says so
/// of the number of rays and points on lights so far.
pub fn pixel(
    scene: &PreparedScene,
    pixel: [u32; 2],
    sample: Option<u32>,
    seed: u64,
    ends: &dyn Fn(u32) -> bool,
) -> PixelRecord {
    with_precision!(scene.accel.geometry().precision, P => record::<P>(scene, pixel, sample, seed, ends))
}

/// Records samples of a pixel.
fn record<P: Arithmetic>(
    scene: &PreparedScene,
    [x, y]: [u32; 2],
    sample: Option<u32>,
    seed: u64,
    ends: &dyn Fn(u32) -> bool,
) -> PixelRecord {
    let samples = scene.camera.rays_per_pixel();
    let range = sample.map_or(0..samples.min(MOST_PATHS), |sample| sample..sample + 1);
    let mut tracer = Recursive::<P>::new(scene, seed);
    let (count, is_cut) = (Cell::new(0), Cell::new(false));
    let is_over = || {
        is_cut.set(count.get() >= MOST_RECORDS || ends(count.get()));
        is_cut.get()
    };
    let follow = |sample| {
        let stream = Stream { seed, pixel: y * scene.camera.size()[0] + x, sample, bounce: 0 };
        let mut recorder = Recorder {
            scene,
            traversal: scene.accel.traversal(),
            count: &count,
            path: PathRecord { sample, ..PathRecord::default() },
            waiting: Vec::new(),
            bounces: 0,
        };
        recorder.path.radiance = tracer.path(scene, [x, y], stream, &is_over, &mut recorder);
        recorder.path
    };
    let begun = range.take_while(|_| !is_cut.get());
    let paths = begun.map(follow).collect();
    let cut_after = is_cut.get().then(|| count.get());
    PixelRecord { pixel: [x, y], samples, paths, cut_after }
}

/// Records the recursive tracer.
struct Recorder<'a> {
    scene: &'a PreparedScene,
    /// For the recorder's own rays, which are not counted.
    traversal: Traversal,
    /// The rays and points on lights that are recorded.
    count: &'a Cell<u32>,
    path: PathRecord,
    /// Where the waiting rays of the tracer come from, and their kinds.
    waiting: Vec<(usize, RayKind)>,
    /// How often the last ray was mirrored or refracted.
    bounces: u32,
}

impl Recorder<'_> {
    fn path_of(&self, primitive: u32) -> String {
        let appearance = &self.scene.appearance;
        appearance.paths.get(appearance.shape_of(primitive)).cloned().unwrap_or_default()
    }

    fn met(&self, ray: &Ray, hit: &Hit) -> HitRecord {
        let (geometry, appearance) = (self.scene.accel.geometry(), &self.scene.appearance);
        let found = with_precision!(geometry.precision, P => crate::prepared::surface::<P>(geometry, ray, hit));
        HitRecord {
            primitive: hit.primitive,
            kind: kind(geometry, hit.primitive),
            shape: self.path_of(hit.primitive),
            name: appearance.names.get(appearance.shape_of(hit.primitive)).cloned().flatten(),
            t: hit.t,
            t_error: (geometry.precision != Precision::Fast).then_some(UNIT_ROUNDOFF * hit.t.abs()),
            uv: found.barycentric,
            point: Vec3::from(found.point).as_dvec3() + self.scene.origin,
            error: found.error.into(),
            normal: found.normal.into(),
            shading_normal: found.normal.into(),
            ..HitRecord::default()
        }
    }

    fn last_met(&mut self) -> Option<&mut HitRecord> {
        self.path.bounces.last_mut()?.met.as_mut()
    }

    /// What a shadow ray is blocked by.
    fn blocked(&mut self, ray: &Ray) -> Visibility {
        let hit = occluder(&self.scene.accel, ray, &mut self.traversal);
        let primitive = (!hit.is_miss()).then_some(hit.primitive);
        let shape = primitive.map_or_else(String::new, |number| self.path_of(number));
        Visibility::Occluded { primitive, shape, t: hit.t }
    }
}

impl Observer for Recorder<'_> {
    fn ray(&mut self, branch: &Branch, hit: &Hit, tests: TestCounts) {
        let Branch { ray, throughput, state, .. } = branch;
        let appearance = &self.scene.appearance;
        let path_of_solid = |solid| {
            let shape = appearance.shapes.iter().position(|shape| shape.solid == Some(solid));
            shape.map_or_else(String::new, |shape| appearance.paths[shape].clone())
        };
        let met = (!hit.is_miss()).then(|| self.met(ray, hit));
        self.count.set(self.count.get() + 1);
        self.bounces = state.bounces;
        let (from, kind) = self.waiting.pop().unzip();
        self.path.bounces.push(Bounce {
            kind: kind.unwrap_or(RayKind::Camera),
            from,
            throughput: *throughput,
            origin: ray.origin.as_dvec3() + self.scene.origin,
            direction: ray.direction,
            medium: state.media.medium().map(path_of_solid),
            nodes: tests.nodes,
            leaves: tests.leaves,
            primitives: tests.primitives.all(),
            met,
            radiance: Vec3::ZERO,
            end: None,
        });
    }

    fn surface(&mut self, point: &ShadingPoint<f32>, class: &Class) {
        // The file of the image that gives the colour.
        let images = &self.scene.appearance.images;
        let image = class.color().and_then(|color| images.get(color.image as usize));
        let texture = image.map(|image| image.name().to_owned());
        let transparency = class.transparency.as_ref();
        let (kt, ior) = transparency.map_or((0.0, 1.0), |of| (of.kt, of.ior));
        let Some(met) = self.last_met() else { return };
        (met.normal, met.shading_normal) = (point.normal.into(), point.shading_normal.into());
        met.lit = point.lit;
        met.surface = Some(SurfaceRecord {
            color: point.color.into(),
            texture,
            ks: point.reflection.ks,
            kd: point.reflection.kd,
            exponent: point.reflection.exponent,
            kr: point.kr,
            opacity: point.opacity,
            kt,
            ior,
            emission: point.emission.into(),
        });
    }

    fn light(
        &mut self,
        [light, index]: [usize; 2],
        target: &LightPoint<f32>,
        request: TracedLight<'_>,
    ) {
        self.count.set(self.count.get() + 1);
        let arrives = request.map(|(request, transmittance)| {
            let all = Vec3::from(request.contribution);
            match transmittance {
                None => (self.blocked(&request.ray()), Vec3::ZERO),
                Some(Vec3::ONE) => (Visibility::Visible, all),
                Some(transmittance) => {
                    (Visibility::Weakened { transmittance }, all * transmittance)
                }
            }
        });
        let origin = self.scene.origin;
        let emitter = &self.scene.lights[light].emitter;
        let around = emitter.ambient_reach();
        let is_distant = emitter.is_distant();
        let Some(met) = self.last_met() else { return };
        let from = if is_distant { Vec3::ZERO } else { (met.point - origin).as_vec3() };
        let towards = Vec3::from(target.position) - from;
        let distance = if is_distant { None } else { around.or(Some(towards.length())) };
        let behind = around.is_none() && met.normal.dot(normalize(towards)) <= 0.0;
        let none = if behind { Visibility::Behind } else { Visibility::NotReflected };
        let (verdict, adds) = arrives.unwrap_or((none, Vec3::ZERO));
        let ambient = around.is_some();
        met.lights.push(LightRecord { light, ambient, index, distance, verdict, adds });
    }

    fn done(&mut self, radiance: Vec3, next: &[Branch], end: PathEnd) {
        let from = self.path.bounces.len().saturating_sub(1);
        let normal = self.last_met().map_or(Vec3::ZERO, |met| met.normal);
        let kind = |branch: &Branch| match branch {
            _ if branch.state.bounces == self.bounces => RayKind::Straight,
            _ if branch.ray.direction.dot(normal) < 0.0 => RayKind::Refracted,
            _ => RayKind::Mirrored,
        };
        for branch in next {
            // As the tracer's own, of which faint ones wait below all others.
            let index = if branch.state.faint { 0 } else { self.waiting.len() };
            self.waiting.insert(index, (from, kind(branch)));
        }
        if let Some(bounce) = self.path.bounces.last_mut() {
            (bounce.radiance, bounce.end) = (radiance, next.is_empty().then_some(end));
        }
    }
}

/// The closest hit of a shadow ray on what it does not pass. What is hidden by something that it
/// passes, within the rounding of t, may be left out.
pub fn occluder(accel: &Accel, ray: &Ray, traversal: &mut Traversal) -> Hit {
    let mut rest = *ray;
    loop {
        let hit = accel.closest(&rest, traversal);
        if hit.is_miss() || !accel.geometry().is_passed(hit.primitive) {
            return hit;
        }
        // The exact t may be above the rounded one: then the same hit is found again from there.
        rest.t_min = if hit.t > rest.t_min { hit.t } else { rest.t_min.next_up() };
    }
}

fn kind(geometry: &Geometry, primitive: u32) -> &'static str {
    match geometry.primitive(primitive) {
        Primitive::Triangle(_) | Primitive::Instanced(_) => "triangle",
        Primitive::Quad(_) => "quad",
        Primitive::Quadric(i) => match geometry.quadrics[i] {
            Quadric::Sphere(..) => "sphere",
            Quadric::Disk(_) => "disk",
        },
    }
}
