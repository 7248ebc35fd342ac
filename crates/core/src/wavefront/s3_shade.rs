//! Pass 3: what every hit shows at once, and what it asks for.
//!
//! Hits are told apart by what they need. Misses and lights are dealt with at once; hits on spheres, on
//! instances, and on triangles and quads, wait in [`faces`] and are shaded eight at a time.

mod faces;

use std::marker::PhantomData;

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8, u32x8};
use glam::{Vec2, Vec3};

use super::batch::{Batch, Vectors};
use crate::accel::{Hit, NO_PRIMITIVE};
use crate::counters::Counters;
use crate::kernels::blinn_phong::lanes::Reflection;
use crate::kernels::differential::Differential;
use crate::kernels::precision::Arithmetic;
use crate::kernels::shade::lanes::{LitPoints, mirrors};
use crate::kernels::surface::lanes::{Surfaces, interpolated_normal, spheres_at, triangles_at};
use crate::math::lanes::Vec3x8;
use crate::math::ray::Ray;
use crate::math::simd::{Kernel, LANES, Lanes, dispatch};
use crate::plan::schedule::Step;
use crate::prepared::{LookUps, MirrorPoint, PreparedScene};
use faces::{Face, Faces, Group};

/// What the hits of a list are on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum On {
    /// Triangles and quads.
    Flat,
    Spheres,
    /// Triangles of instances.
    Instances,
}

/// Adds background, emitted and ambient light to the paths; collects points that lights reach and,
/// while bounces are left, mirror rays.
pub(super) fn run<P: Arithmetic>(
    scene: &PreparedScene,
    bounce: u32,
    batch: &mut Batch,
    counters: &mut Counters,
) {
    batch.lit.clear();
    batch.next.clear();
    batch.next_differentials.clear();
    let schedule = scene.plan.schedule();
    let appearance = schedule.runs(Step::Normals) || schedule.runs(Step::Texels);
    let shade = Shade::<P> {
        scene,
        bounce,
        differentials: scene.carries_differentials(),
        batch,
        counters,
        has_any: schedule.has_shadows() || schedule.has_mirrors() || appearance,
        appearance,
        shadows: schedule.has_shadows(),
        mirrors: schedule.has_mirrors() && bounce < scene.bounces,
        variant: PhantomData,
    };
    dispatch(scene.accel.level, shade);
}

struct Shade<'a, P> {
    scene: &'a PreparedScene,
    bounce: u32,
    /// Whether mirror rays have differentials.
    differentials: bool,
    batch: &'a mut Batch,
    counters: &'a mut Counters,
    /// Whether hits are asked for more than their colour.
    has_any: bool,
    /// Whether textures and interpolated normals are.
    appearance: bool,
    /// Whether points that lights reach are asked for, as is whether mirror rays are.
    shadows: bool,
    mirrors: bool,
    variant: PhantomData<P>,
}

impl<P: Arithmetic> Kernel for Shade<'_, P> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(mut self, simd: S) {
        let appearance = &self.scene.appearance;
        let geometry = self.scene.accel.geometry();
        let first_sphere = geometry.triangles.len() + geometry.quads.len();
        let first_instanced = geometry.own();
        let (mut flat, mut spheres) = (Faces::new(), Faces::new());
        let mut instanced = (!geometry.instances.is_empty()).then(Faces::new);
        // The shape that was hit last: the next hit is likely to be there too.
        let mut last = 0;
        for i in 0..self.batch.rays.len() {
            let primitive = self.batch.hits.hit[i].primitive;
            if primitive == NO_PRIMITIVE {
                self.miss(i);
                continue;
            }
            if !appearance.shapes[last].primitives.contains(&primitive) {
                last = appearance.shape_of(primitive);
            }
            if let Some(color) = appearance.shapes[last].emission {
                self.light(i, color);
                continue;
            }
            let (faces, on) = match (primitive as usize, &mut instanced) {
                (number, Some(instanced)) if number >= first_instanced => {
                    (instanced, On::Instances)
                }
                (number, _) if number >= first_sphere => (&mut spheres, On::Spheres),
                _ => (&mut flat, On::Flat),
            };
            if faces.push(Face { ray: i as u32, primitive, shape: last as u32 }) {
                self.block(simd, faces, on);
            }
        }
        let rest = [(Some(&mut flat), On::Flat), (Some(&mut spheres), On::Spheres)];
        for (faces, on) in rest.into_iter().chain([(instanced.as_mut(), On::Instances)]) {
            if let Some(faces) = faces {
                self.block(simd, faces, on);
            }
        }
    }
}

impl<P: Arithmetic> Shade<'_, P> {
    #[inline(always)]
    fn miss(&mut self, i: usize) {
        if self.bounce == 0 {
            let path = self.batch.rays.path[i] as usize;
            self.batch.paths.radiance.add(path, self.scene.background);
        }
    }

    #[inline(always)]
    fn light(&mut self, i: usize, color: Vec3) {
        let path = self.batch.rays.path[i] as usize;
        self.batch.paths.radiance.add(path, self.batch.rays.throughput.get(i) * color);
    }

    #[inline(always)]
    fn block<S: Lanes>(&mut self, simd: S, faces: &mut Faces, on: On) {
        let rays = &self.batch.rays;
        let (geometry, appearance) = (self.scene.accel.geometry(), &self.scene.appearance);
        let groups = faces.take(self.has_any, geometry, appearance, |i| rays.ray(i));
        for group in groups {
            self.group(simd, group, on);
        }
    }

    /// Up to eight hits on surfaces of one kind.
    #[inline(always)]
    fn group<S: Lanes>(&mut self, simd: S, group: &Group, on: On) {
        let rays = &self.batch.rays;
        let throughput = fetch(simd, &rays.throughput, &group.rays);
        let path = group.rays.map(|ray| rays.path[ray as usize]);
        let mut color = Vec3x8::load(simd, &group.color);
        let ambient = f32x8::splat(simd, self.scene.ambient);
        if !self.has_any {
            self.add(group.used, &path, throughput * color.scale(ambient));
            return;
        }
        let used = mask(simd, group.used);
        let direction = fetch(simd, &rays.direction, &group.rays);
        let origin = fetch(simd, &rays.origin, &group.rays);
        let t = self.distances(simd, group);
        let surfaces = match on {
            On::Flat => triangles_at::<S, P>(simd, (origin, direction), t, &group.corners),
            On::Spheres => {
                let [center, [radius, ..], _] = &group.corners;
                let center = Vec3x8::load(simd, center);
                let radius = (*radius).simd_into(simd);
                spheres_at::<S, P>(simd, (origin, direction), t, center, radius)
            }
            On::Instances => {
                let [origin, direction] = &group.carried;
                let carried = (Vec3x8::load(simd, origin), Vec3x8::load(simd, direction));
                let found = triangles_at::<S, P>(simd, carried, t, &group.corners);
                group.in_world(simd, &found, self.scene.accel.geometry())
            }
        };

        let outward = surfaces.normal.scale(group.side.simd_into(simd));
        let at_back = outward.dot(direction).simd_gt(0.0);
        let normal = (-outward).or(at_back, outward);
        let shading_normal = if !self.appearance || group.smooth == 0 {
            normal
        } else {
            let (values, smooth) = (&group.normals, mask(simd, group.smooth));
            interpolated_normal(simd, values, surfaces.barycentric, normal, smooth)
        };
        if self.appearance && group.textured & group.used != 0 {
            self.textures(group, &surfaces, &mut color);
        }
        self.add(group.used, &path, throughput * color.scale(ambient));

        let [ks, kd, exponent] = group.reflection;
        let points = LitPoints {
            point: surfaces.point,
            error: surfaces.error,
            normal,
            shading_normal,
            view: -direction.normalize(),
            color,
            throughput,
            reflection: Reflection {
                ks: ks.simd_into(simd),
                kd: kd.simd_into(simd),
                exponent: exponent.simd_into(simd),
            },
        };
        let lit = used & (mask(simd, group.two_sided) | !at_back);
        let path: u32x8<S> = path.simd_into(simd);
        if self.shadows {
            self.batch.lit.push_lanes(&points, path, lit);
        }
        let kr: f32x8<S> = group.kr.simd_into(simd);
        if self.mirrors && kr.simd_gt(0.0).to_bitmask() & 0xFF != 0 {
            let mut next = mirrors(&points, kr);
            next.asked &= lit;
            self.counters.secondary_rays += self.batch.next.push_lanes(&next, path) as u64;
            if self.differentials {
                self.mirror_differentials(group, &points, next.asked);
            }
        }
    }

    /// Where on their rays the hits are; read where it matters alone.
    #[inline(always)]
    fn distances<S: Lanes>(&self, simd: S, group: &Group) -> f32x8<S> {
        if !P::IS_FAST {
            return f32x8::splat(simd, 0.0);
        }
        let mut t = [0.0; LANES];
        for (t, &ray) in t.iter_mut().zip(&group.rays) {
            *t = self.batch.hits.hit[ray as usize].t;
        }
        t.simd_into(simd)
    }

    /// Adds light to the paths of the lanes in use.
    #[inline(always)]
    fn add<S: Lanes>(&mut self, used: u32, path: &[u32; LANES], light: Vec3x8<S>) {
        let radiance = &mut self.batch.paths.radiance;
        if used == 0xFF && is_row(path) {
            let first = path[0] as usize;
            radiance.store(first, radiance.load(light.x.token(), first) + light);
            return;
        }
        for (lane, &path) in path.iter().enumerate() {
            if used >> lane & 1 == 1 {
                radiance.add(path as usize, light.lane(lane));
            }
        }
    }

    /// Replaces the colours of hits on shapes with textures.
    fn textures<S: Lanes>(&mut self, group: &Group, surfaces: &Surfaces<S>, color: &mut Vec3x8<S>) {
        let (appearance, geometry) = (&self.scene.appearance, self.scene.accel.geometry());
        let mut look_ups = LookUps::default();
        for lane in lanes(group.textured & group.used) {
            let Face { ray, primitive, shape } = group.faces[lane];
            let shape = &appearance.shapes[shape as usize];
            let Some(texture) = &shape.texture else { continue };
            let [y, z] = surfaces.barycentric;
            let surface = group.surface(
                lane,
                surfaces.point.lane(lane),
                surfaces.error.lane(lane),
                surfaces.normal.lane(lane),
                Vec2::new(y[lane], z[lane]),
            );
            let face = (shape, primitive);
            let footprint = || {
                let (differential, ray, hit) = self.arriving(ray);
                let steps = differential.at(&ray, hit.t, surface.normal);
                appearance.footprint(texture, geometry, face, &surface, steps)
            };
            let found = appearance.texture_color(
                texture,
                geometry,
                face,
                &surface,
                footprint,
                &mut look_ups,
            );
            color.set_lane(lane, found);
        }
        self.count(look_ups);
    }

    /// Appends the differentials of the mirror rays that there are.
    #[inline(never)]
    fn mirror_differentials<S: Lanes>(
        &mut self,
        group: &Group,
        points: &LitPoints<S>,
        asked: mask32x8<S>,
    ) {
        let mut look_ups = LookUps::default();
        for lane in lanes((asked.to_bitmask() & 0xFF) as u32) {
            let (differential, ray, hit) = self.arriving(group.rays[lane]);
            let point = MirrorPoint {
                point: points.point.lane(lane),
                normal: points.normal.lane(lane),
                shading_normal: points.shading_normal.lane(lane),
            };
            let next = self.scene.mirrored(&differential, &ray, &hit, &point, &mut look_ups);
            self.batch.next_differentials.push(&next);
        }
        self.count(look_ups);
    }

    /// A ray of that number, with its differential and its hit.
    fn arriving(&self, ray: u32) -> (Differential, Ray, Hit) {
        let number = ray as usize;
        let (ray, hit) = (self.batch.rays.ray(number), self.batch.hits.hit[number]);
        let differential = match self.bounce {
            1.. if self.differentials => self.batch.differentials.get(number),
            _ => self.scene.camera.differential(ray.direction),
        };
        (differential, ray, hit)
    }

    fn count(&mut self, look_ups: LookUps) {
        self.counters.texels += look_ups.texels;
        self.counters.footprints += look_ups.footprints;
    }
}

/// The lanes whose bits are set, one after the other.
#[inline(always)]
fn lanes(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}

/// The lanes whose bits are set.
#[inline(always)]
fn mask<S: Lanes>(simd: S, bits: u32) -> mask32x8<S> {
    mask32x8::from_bitmask(simd, u64::from(bits))
}

/// Whether numbers follow each other.
#[inline(always)]
fn is_row(numbers: &[u32; LANES]) -> bool {
    let mut row = true;
    for (lane, &number) in numbers.iter().enumerate() {
        row &= number == numbers[0].wrapping_add(lane as u32);
    }
    row
}

/// The vectors of these rows.
#[inline(always)]
fn fetch<S: Lanes>(simd: S, column: &Vectors, rows: &[u32; LANES]) -> Vec3x8<S> {
    if is_row(rows) { column.load(simd, rows[0] as usize) } else { column.gather(simd, rows) }
}
