//! Pass 3: adds the light of every hit and collects its requests.
//!
//! Hits are sorted by kind. Misses and lights are handled at once; hits on quadrics, on instances,
//! and on triangles and quads wait in [`faces`] and are shaded together.

mod faces;

use std::marker::PhantomData;

use glam::Vec3;

use super::batch::{Batch, Vectors};
use super::count;
use crate::accel::{Hit, NO_PRIMITIVE};
use crate::counters::Counters;
use crate::geometry::ShadingKind;
use crate::kernels::differential::Differential;
use crate::kernels::precision::Arithmetic;
use crate::kernels::shade::{ShadingPoint, mirror_request};
use crate::math::ray::Ray;
use crate::math::real::{Mask, Single};
use crate::math::simd::{LANES, Pass, dispatch_pass};
use crate::math::vector::{Line, Vector};
use crate::plan::schedule::Step;
use crate::prepared::{Branch, Face, Group, Interaction, LookUps, PreparedScene, Trail, lanes};
use faces::WaitingHits;

/// Adds background, emission and ambient light to the paths; collects lit points and, while bounces
/// are left, the next rays.
pub(super) fn run<P: Arithmetic>(
    scene: &PreparedScene,
    bounce: u32,
    batch: &mut Batch,
    counters: &mut Counters,
) {
    batch.lit.clear();
    batch.tints.clear();
    batch.next.clear();
    batch.next_differentials.clear();
    batch.next_trails.clear();
    let schedule = scene.plan.schedule();
    let steps =
        [Step::Normals, Step::Colors, Step::Texels, Step::NormalMaps, Step::Maps, Step::Emission];
    let appearance = steps.iter().any(|&step| schedule.runs(step));
    let shade = Shade::<P> {
        scene,
        bounce,
        differentials: scene.carries_differentials(),
        batch,
        counters,
        has_any: schedule.has_shadows()
            || schedule.goes_on()
            || appearance
            || scene.hemisphere.is_some(),
        shadows: schedule.has_shadows(),
        tints: schedule.runs(Step::Tints),
        mirrors: schedule.has_mirrors() && (bounce < scene.bounces || schedule.has_transmission()),
        transmits: schedule.has_transmission(),
        precision: PhantomData,
    };
    dispatch_pass(scene.accel.level, shade);
}

struct Shade<'a, P> {
    scene: &'a PreparedScene,
    bounce: u32,
    /// Whether rays from surfaces have differentials.
    differentials: bool,
    batch: &'a mut Batch,
    counters: &'a mut Counters,
    /// Whether hits need shading points: for rays, appearance or hemispheric light.
    has_any: bool,
    /// Whether to collect lit points, and mirror rays.
    shadows: bool,
    mirrors: bool,
    /// Whether surfaces let light through.
    transmits: bool,
    /// Whether highlights are coloured.
    tints: bool,
    precision: PhantomData<P>,
}

impl<P: Arithmetic> Pass for Shade<'_, P> {
    type Output = ();

    #[inline(always)]
    fn run<F: Single>(mut self, token: F::Token) {
        let appearance = &self.scene.appearance;
        let geometry = self.scene.accel.geometry();
        let (mut flat, mut quadrics) = (WaitingHits::<F>::new(), WaitingHits::new());
        let mut instances = (!geometry.instances.is_empty()).then(WaitingHits::new);
        // The last shape hit: the next hit is likely on it too.
        let mut last = 0;
        for i in 0..self.batch.rays.len() {
            let primitive = self.batch.hits.hit[i].primitive;
            if primitive == NO_PRIMITIVE {
                self.miss(i);
                continue;
            }
            if self.transmits {
                self.absorb(i);
            }
            if !appearance.shapes[last].primitives.contains(&primitive) {
                last = appearance.shape_of(primitive);
            }
            if let Some(color) = appearance.shapes[last].light {
                self.light(i, color);
                continue;
            }
            if self.transmits && self.scene.transparency(primitive).is_some() {
                self.transparent(i);
                continue;
            }
            let kind = geometry.kind(primitive);
            let faces = match (kind, &mut instances) {
                (ShadingKind::Instances, Some(instances)) => instances,
                (ShadingKind::Quadrics, _) => &mut quadrics,
                _ => &mut flat,
            };
            if faces.push(Face { ray: i as u32, primitive, shape: last as u32 }) {
                self.block(token, faces, kind);
            }
        }
        self.block(token, &mut flat, ShadingKind::Flat);
        self.block(token, &mut quadrics, ShadingKind::Quadrics);
        if let Some(instances) = &mut instances {
            self.block(token, instances, ShadingKind::Instances);
        }
    }
}

impl<P: Arithmetic> Shade<'_, P> {
    #[inline(always)]
    fn miss(&mut self, i: usize) {
        let mirrored = self.trail(i).mirrored;
        let rays = &self.batch.rays;
        if let Some(color) = self.scene.beyond(rays.direction.get(i), mirrored) {
            let path = rays.path[i] as usize;
            self.batch.paths.radiance.add(path, rays.throughput.get(i) * color);
        }
    }

    /// What the ray with that number went through.
    #[inline(always)]
    fn trail(&self, i: usize) -> Trail {
        match self.transmits {
            true if self.bounce > 0 => self.batch.trails[i],
            _ => Trail { bounces: self.bounce, mirrored: self.bounce > 0, absorption: Vec3::ZERO },
        }
    }

    /// Takes the light of a hit that is absorbed on the way from there.
    fn absorb(&mut self, i: usize) {
        if let Some(remaining) = self.trail(i).remaining(self.batch.hits.hit[i].t) {
            let throughput = &mut self.batch.rays.throughput;
            throughput.set(i, throughput.get(i) * remaining);
        }
    }

    /// Shades a hit on a transparent surface.
    #[inline(never)]
    fn transparent(&mut self, i: usize) {
        let (differential, ray, hit) = self.arriving(i as u32);
        let (throughput, path) = (self.batch.rays.throughput.get(i), self.batch.rays.path[i]);
        let arriving =
            Branch { ray, throughput, trail: self.trail(i), differential: Some(differential) };
        let mut look_ups = LookUps::default();
        let scene = self.scene;
        let found = scene.interaction::<P>(&ray, &hit, &|| differential, &mut look_ups);
        let (Interaction::Surface(point), Some(transparency)) =
            (found, scene.transparency(hit.primitive))
        else {
            return;
        };
        let (own, branches) = scene.divide(&arriving, &hit, transparency, &point, &mut look_ups);
        count(look_ups, self.counters);
        let local = point.local_light(scene.ambient, scene.hemisphere.as_ref());
        self.batch.paths.radiance.add(path as usize, own * Vec3::from(local));
        if self.shadows && point.lit {
            self.collect(&point, own.into(), &[path; LANES]);
        }
        let branches = branches.into_iter().rev().flatten();
        branches.for_each(|branch| self.batch.waiting.push(path, branch));
    }

    /// Appends the lit points.
    #[inline(always)]
    fn collect<F: Single>(
        &mut self,
        point: &ShadingPoint<F>,
        throughput: Vector<F>,
        path: &[u32; LANES],
    ) {
        self.batch.lit.provide();
        self.batch.lit.push_lanes(point, throughput, path);
        if self.tints {
            self.batch.tints.provide();
            self.batch.tints.push_lanes(point);
        }
    }

    #[inline(always)]
    fn light(&mut self, i: usize, color: Vec3) {
        let path = self.batch.rays.path[i] as usize;
        self.batch.paths.radiance.add(path, self.batch.rays.throughput.get(i) * color);
    }

    /// Shades the waiting hits.
    fn block<F: Single>(&mut self, token: F::Token, faces: &mut WaitingHits<F>, kind: ShadingKind) {
        F::outlined(
            token,
            #[inline(always)]
            || {
                let rays = &self.batch.rays;
                let (geometry, appearance) = (self.scene.accel.geometry(), &self.scene.appearance);
                for group in faces.take(self.has_any, geometry, appearance, |i| rays.ray(i)) {
                    self.group(token, group, kind);
                }
            },
        );
    }

    /// Shades hits on surfaces of one kind.
    #[inline(always)]
    fn group<F: Single>(&mut self, token: F::Token, group: &Group<F>, kind: ShadingKind) {
        let rays = &self.batch.rays;
        let numbers = group.faces.map(|face| face.ray);
        let throughput = fetch(token, &rays.throughput, &numbers);
        let path = numbers.map(|ray| rays.path[ray as usize]);
        if !self.has_any {
            let light = group.colors(token).scale(F::splat(token, self.scene.ambient));
            self.add(group.used, &path, throughput * light);
            return;
        }
        let origin = fetch(token, &rays.origin, &numbers);
        let line = Line { origin, direction: fetch(token, &rays.direction, &numbers) };
        let t = self.distances::<F>(token, kind, &numbers);
        let mut look_ups = LookUps::default();
        let arriving = |lane: usize| self.arriving(group.faces[lane].ray);
        let point = group.shading_points::<P>(kind, &line, t, self.scene, arriving, &mut look_ups);
        look_ups.colors = group.colored();
        count(look_ups, self.counters);
        let local = point.local_light(self.scene.ambient, self.scene.hemisphere.as_ref());
        self.add(group.used, &path, throughput * local);
        if self.shadows && point.lit.any() {
            self.collect(&point, throughput, &path);
        }
        if self.mirrors
            && let Some(mut next) = mirror_request(&point, throughput)
        {
            self.batch.next.provide();
            if self.transmits {
                next.asked =
                    next.asked & F::mask(token, self.mirror_trails(&numbers, next.asked.bits()));
            }
            self.batch.next.push_lanes(&next, &path);
            if self.differentials {
                self.mirror_differentials(&numbers, &point, next.asked.bits());
            }
        }
    }

    /// The t of the hits, where it matters: exact points of triangles follow from the rays alone.
    #[inline(always)]
    fn distances<F: Single>(&self, token: F::Token, kind: ShadingKind, rays: &[u32; LANES]) -> F {
        let mut t = F::splat(token, 0.0);
        if P::IS_FAST || kind == ShadingKind::Quadrics {
            for (lane, &ray) in rays.iter().enumerate().take(F::LANES) {
                t.set_lane(lane, self.batch.hits.hit[ray as usize].t);
            }
        }
        t
    }

    /// Adds light to the paths of the used lanes.
    #[inline(always)]
    fn add<F: Single>(&mut self, used: u32, path: &[u32; LANES], light: Vector<F>) {
        let radiance = &mut self.batch.paths.radiance;
        if used == u32::MAX >> (32 - F::LANES) && is_row::<F>(path) {
            let first = path[0] as usize;
            radiance.store(first, radiance.load(light.x.token(), first) + light);
            return;
        }
        for lane in lanes(used) {
            radiance.add(path[lane] as usize, light.lane(lane));
        }
    }

    /// Appends the trails of the lanes with a mirror ray that have bounces left. Returns these lanes.
    #[inline(never)]
    fn mirror_trails(&mut self, rays: &[u32; LANES], asked: u32) -> u32 {
        lanes(asked).fold(0, |kept, lane| {
            let trail = self.trail(rays[lane] as usize);
            if trail.bounces >= self.scene.bounces {
                return kept;
            }
            self.batch.push_trail(trail.mirrored());
            kept | 1 << lane
        })
    }

    /// Appends the differentials of the lanes with a mirror ray.
    #[inline(never)]
    fn mirror_differentials<F: Single>(
        &mut self,
        rays: &[u32; LANES],
        points: &ShadingPoint<F>,
        asked: u32,
    ) {
        let mut look_ups = LookUps::default();
        for lane in lanes(asked) {
            let (differential, ray, hit) = self.arriving(rays[lane]);
            let point = points.lane(lane);
            let next = self.scene.mirrored(&differential, &ray, &hit, &point, &mut look_ups);
            self.batch.push_differential(next);
        }
        count(look_ups, self.counters);
    }

    /// The ray with that number, with its differential and its hit.
    fn arriving(&self, ray: u32) -> (Differential, Ray, Hit) {
        let number = ray as usize;
        let (ray, hit) = (self.batch.rays.ray(number), self.batch.hits.hit[number]);
        let differential = match self.bounce {
            1.. if self.differentials => self.batch.differentials[number],
            _ => self.scene.camera.differential(ray.direction),
        };
        (differential, ray, hit)
    }
}

/// Whether the lanes' numbers are consecutive.
#[inline(always)]
fn is_row<F: Single>(numbers: &[u32; LANES]) -> bool {
    let mut row = true;
    for (lane, &number) in numbers.iter().enumerate().take(F::LANES) {
        row &= number == numbers[0].wrapping_add(lane as u32);
    }
    row
}

/// The vectors of these rows.
#[inline(always)]
fn fetch<F: Single>(token: F::Token, column: &Vectors, rows: &[u32; LANES]) -> Vector<F> {
    if is_row::<F>(rows) {
        column.load(token, rows[0] as usize)
    } else {
        column.gather(token, rows)
    }
}
