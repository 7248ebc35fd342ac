//! Pass 3: adds the light of every hit and collects its requests.
//!
//! Misses and lights are handled at once; other hits wait in [`faces`] and are shaded together: hits
//! on plain classes by the kind of primitive, others by class and kind. So nothing branches by hit.

mod scatter;

use glam::Vec3;

use super::batch::is_row;
use super::{Batch, GROUPS, SortedHits, Wavefront, faces};
use crate::accel::{Hit, NO_PRIMITIVE};
use crate::geometry::ShadingKind;
use crate::kernels::shade::mirror_request;
use crate::kernels::{Arithmetic, Footprint, MirrorRequest, ShadingPoint};
use crate::math::{AnyWidth, LANES, Line, Mask, Single, Vector, dispatch_any_width, set_bits};
use crate::plan::schedule::Step;
use crate::prepared::{Face, Group, PathState, PreparedScene, SampleCounts};
use crate::tile::TimedPass;

impl<P: Arithmetic> Wavefront<P> {
    /// Adds background, emission and ambient light to the paths; collects lit points and, while bounces
    /// are left, the next rays.
    pub(super) fn shade(&mut self, scene: &PreparedScene, bounce: u32) {
        let (batch, schedule) = (&mut self.batch, scene.plan.schedule());
        let sees = !batch.seen.is_empty();
        batch.lit.clear();
        batch.tints.clear();
        batch.next.clear();
        batch.next_carried.clear();
        let shade = Shade {
            scene,
            bounce,
            differentials: scene.carries_differentials(),
            sees,
            shadows: schedule.has_shadows() && !sees,
            tints: schedule.runs(Step::Tints),
            mirrors: schedule.has_mirrors()
                && !sees
                && (bounce < scene.bounces || schedule.has_transmission()),
            transmits: schedule.has_transmission(),
            needs_t: scene.needs_t() || sees,
            tracer: self,
        };
        dispatch_any_width(scene.accel.level, shade);
    }
}

/// Hits of a group, with their rays and shading points.
#[derive(Clone, Copy)]
pub(super) struct Shaded<'a, F: Single> {
    pub(super) group: &'a Group<F>,
    kind: ShadingKind,
    line: Line<F>,
    t: F,
    /// The numbers of the rays, and of their paths.
    pub(super) numbers: [u32; LANES],
    pub(super) path: [u32; LANES],
    throughput: Vector<F>,
    pub(super) point: ShadingPoint<F>,
}

struct Shade<'a, P> {
    tracer: &'a mut Wavefront<P>,
    scene: &'a PreparedScene,
    bounce: u32,
    /// Whether rays from surfaces have differentials.
    differentials: bool,
    /// Whether to keep what paths show, in place of light.
    sees: bool,
    /// Whether to collect lit points, and mirror rays.
    shadows: bool,
    mirrors: bool,
    /// Whether surfaces let light through.
    transmits: bool,
    /// Whether highlights are coloured.
    tints: bool,
    /// Whether the t of every hit is needed.
    needs_t: bool,
}

impl<P: Arithmetic> AnyWidth for Shade<'_, P> {
    type Output = ();

    #[inline(always)]
    fn run<F: Single>(mut self, token: F::Token) {
        let appearance = &self.scene.appearance;
        let geometry = self.scene.accel.geometry();
        let mut groups = [Group::<F>::default(); GROUPS];
        let block = GROUPS * F::LANES;
        let mut waiting = ShadingKind::ALL.map(|_| Vec::with_capacity(block));
        let mut sorted = std::mem::take(&mut self.tracer.batch.sorted);
        // The last shape hit: the next hit is likely on it too.
        let (mut last, mut is_plain) = (usize::MAX, true);
        for i in 0..self.tracer.batch.rays.len() {
            let primitive = self.tracer.batch.hits[i].primitive;
            if primitive == NO_PRIMITIVE {
                self.miss(i);
                continue;
            }
            if self.transmits {
                self.absorb(i);
            }
            let mut shape = appearance.shapes.get(last);
            if !shape.is_some_and(|shape| shape.primitives.contains(&primitive)) {
                last = appearance.shape_of(primitive);
                shape = appearance.shapes.get(last);
                is_plain = shape.is_none_or(|shape| appearance.class(shape).is_plain());
            }
            let Some(shape) = shape else { continue };
            if let Some(color) = shape.light {
                self.light(i, color);
                continue;
            }
            let kind = geometry.kind(primitive);
            let face = Face { ray: i as u32, primitive, shape: last as u32 };
            face.prefetch_vertices(geometry);
            if is_plain {
                let waiting = &mut waiting[kind as usize];
                waiting.push(face);
                if waiting.len() == block {
                    self.block(token, &mut groups, waiting, kind);
                    waiting.clear();
                }
            } else if sorted.push(face, shape.class, kind) {
                self.spans(token, &mut groups, &mut sorted);
            }
        }
        for (waiting, kind) in waiting.iter().zip(ShadingKind::ALL) {
            self.block(token, &mut groups, waiting, kind);
        }
        self.spans(token, &mut groups, &mut sorted);
        self.tracer.batch.sorted = sorted;
    }
}

impl<P: Arithmetic> Shade<'_, P> {
    #[inline(always)]
    fn miss(&mut self, i: usize) {
        if self.sees {
            return self.tracer.batch.see_nothing(i);
        }
        let state = self.state(i);
        if let Some(color) = self.scene.escaped(self.tracer.batch.rays.direction.get(i), &state) {
            self.light(i, color);
        }
    }

    /// What the ray with that number went through.
    #[inline(always)]
    fn state(&self, i: usize) -> PathState {
        match self.transmits {
            true if self.bounce > 0 => self.tracer.batch.carried.states()[i],
            _ => PathState {
                bounces: self.bounce,
                mirrored: self.bounce > 0,
                turned: self.bounce > 0,
                media: self.tracer.start,
                faint: false,
                next: Hit::MISS,
            },
        }
    }

    /// Takes the light of a hit that is absorbed on the way from there, and keeps what the ray is inside of.
    fn absorb(&mut self, i: usize) {
        let (ray, media) = (self.tracer.batch.ray(i), self.state(i).media);
        let remaining = self.scene.remaining(&ray, &media, self.tracer.batch.hits[i].t);
        let throughput = &mut self.tracer.batch.rays.throughput;
        throughput.set(i, throughput.get(i) * remaining);
        self.tracer.batch.set_media(i, media);
    }

    #[inline(always)]
    fn light(&mut self, i: usize, color: Vec3) {
        if self.sees {
            return self.tracer.batch.see_light::<P>(self.scene, i, color);
        }
        let path = self.tracer.batch.rays.path[i] as usize;
        let weight =
            self.scene.shown(&self.state(i), self.tracer.batch.rays.throughput.get(i), color);
        self.tracer.batch.paths.radiance.add(path, weight * color);
    }

    /// Shades hits, those of each class together: a pass of its own for the clock.
    fn spans<F: Single>(
        &mut self,
        token: F::Token,
        groups: &mut [Group<F>; GROUPS],
        sorted: &mut SortedHits,
    ) {
        if sorted.is_empty() {
            return;
        }
        self.tracer.clock.lap(TimedPass::Shade);
        for (kind, faces) in sorted.sort() {
            for faces in faces.chunks(GROUPS * F::LANES) {
                self.block(token, groups, faces, kind);
            }
        }
        self.tracer.clock.lap(TimedPass::Maps);
    }

    /// Shades up to a block of hits of one kind.
    fn block<F: Single>(
        &mut self,
        token: F::Token,
        groups: &mut [Group<F>; GROUPS],
        faces: &[Face],
        kind: ShadingKind,
    ) {
        if faces.is_empty() {
            return;
        }
        F::outlined(
            token,
            #[inline(always)]
            || {
                let rays = &self.tracer.batch.rays;
                let ray = |i| rays.ray(i);
                let with_corners = self.tracer.needs_points;
                let groups = faces::fetch(groups, faces, with_corners, self.scene, ray);
                let class = groups.first().map(|group| group.class(&self.scene.appearance));
                match class.and_then(|class| class.transparency.as_ref()) {
                    Some(through) if self.transmits => {
                        for group in groups {
                            F::outlined(
                                token,
                                #[inline(always)]
                                || self.scatter(token, (group, kind), through),
                            );
                        }
                    }
                    _ => {
                        for group in groups {
                            self.group(token, group, kind);
                        }
                    }
                }
            },
        );
    }

    /// Shades hits on opaque surfaces of one kind.
    #[inline(always)]
    fn group<F: Single>(&mut self, token: F::Token, group: &Group<F>, kind: ShadingKind) {
        if self.tracer.needs_points {
            let shaded = self.shaded(token, group, kind);
            self.add_light(&shaded, shaded.throughput);
            if self.mirrors {
                self.mirror(token, &shaded);
            }
            return;
        }
        let numbers = group.faces.map(|face| face.ray);
        let rays = &self.tracer.batch.rays;
        let throughput = rays.throughput.gather(token, &numbers);
        let path = numbers.map(|ray| rays.path[ray as usize]);
        group.count(group.class(&self.scene.appearance), &mut self.tracer.counters.samples);
        let light = group.colors(token).scale(F::splat(token, self.scene.ambient));
        self.add(group.used, &path, throughput * light);
    }

    /// The shading points of hits on surfaces of one kind.
    #[inline(always)]
    fn shaded<'g, F: Single>(
        &mut self,
        token: F::Token,
        group: &'g Group<F>,
        kind: ShadingKind,
    ) -> Shaded<'g, F> {
        let rays = &self.tracer.batch.rays;
        let numbers = group.faces.map(|face| face.ray);
        let throughput = rays.throughput.gather(token, &numbers);
        let path = numbers.map(|ray| rays.path[ray as usize]);
        let origin = rays.origin.gather(token, &numbers);
        let line = Line { origin, direction: rays.direction.gather(token, &numbers) };
        let t = self.distances::<F>(token, kind, &numbers);
        group.count(group.class(&self.scene.appearance), &mut self.tracer.counters.samples);
        let mut look_ups = SampleCounts::default();
        let footprint = |lane: usize| self.footprint(numbers[lane] as usize);
        let hits = (kind, &line, t);
        let point = group.shading_points::<P>(hits, self.scene, &footprint, &mut look_ups);
        self.tracer.counters.samples += look_ups;
        Shaded { group, kind, line, t, numbers, path, throughput, point }
    }

    /// Adds the light that surfaces send to the rays themselves, with these throughputs, and collects lit points.
    #[inline(always)]
    fn add_light<F: Single>(&mut self, shaded: &Shaded<'_, F>, throughput: Vector<F>) {
        if self.sees {
            return self.tracer.batch.see(shaded, throughput);
        }
        let Shaded { group, numbers, path, point, .. } = shaded;
        let scene = self.scene;
        let [mut own, mut direct] = [throughput; 2];
        if self.transmits && scene.visible.has_faint() {
            for lane in set_bits::<LANES>(group.used) {
                let state = self.state(numbers[lane] as usize);
                let brightness = point.emission.lane(lane);
                own.set_lane(lane, scene.shown(&state, own.lane(lane), brightness));
                if state.faint {
                    direct.set_lane(lane, Vec3::ZERO);
                }
            }
        }
        let local = point.local_light(scene.ambient, scene.hemisphere.as_ref());
        self.add(group.used, path, own * local);
        if self.shadows && point.lit.any() {
            self.tracer.batch.lit.provide();
            self.tracer.batch.lit.push_lanes(point, direct, path);
            if self.tints {
                self.tracer.batch.tints.provide();
                self.tracer.batch.tints.push_lanes(point);
            }
        }
    }

    /// Collects the mirror rays of opaque surfaces.
    #[inline(always)]
    fn mirror<F: Single>(&mut self, token: F::Token, shaded: &Shaded<'_, F>) {
        let Shaded { group, kind, line, t, numbers, path, throughput, point } = shaded;
        let Some(mut next) = mirror_request(point, *throughput) else { return };
        self.tracer.batch.next.provide();
        if self.transmits {
            let kept = self.mirror_states(numbers, next.asked.bits());
            next.asked = next.asked & F::mask(token, kept);
        }
        let MirrorRequest { line: mirrored, throughput, asked } = next;
        self.tracer.batch.next.push_lanes(&mirrored, throughput, asked, path);
        if self.differentials {
            let footprint = |lane: usize| self.footprint(numbers[lane] as usize);
            let (hits, scene) = ((*kind, line, *t), self.scene);
            let mirrored = F::outlined(
                token,
                #[inline(always)]
                || group.mirrored(scene, hits, &footprint, point),
            );
            let asked = asked.bits();
            self.tracer.counters.samples.footprints += u64::from(asked.count_ones());
            for lane in set_bits::<LANES>(asked) {
                self.tracer.batch.next_carried.push_differential(mirrored.lane(lane));
            }
        }
    }

    /// The t of the hits, where it matters: exact points of triangles follow from the rays alone.
    #[inline(always)]
    fn distances<F: Single>(&self, token: F::Token, kind: ShadingKind, rays: &[u32; LANES]) -> F {
        let mut t = F::splat(token, 0.0);
        if P::IS_FAST || kind == ShadingKind::Quadrics || self.needs_t {
            for (lane, &ray) in rays.iter().enumerate().take(F::LANES) {
                t.set_lane(lane, self.tracer.batch.hits[ray as usize].t);
            }
        }
        t
    }

    /// Adds light to the paths of the used lanes.
    #[inline(always)]
    fn add<F: Single>(&mut self, used: u32, path: &[u32; LANES], light: Vector<F>) {
        let radiance = &mut self.tracer.batch.paths.radiance;
        if used == u32::MAX >> (32 - F::LANES) && is_row::<F>(path) {
            let first = path[0] as usize;
            radiance.store(first, radiance.load(light.x.token(), first) + light);
            return;
        }
        for lane in set_bits::<LANES>(used) {
            radiance.add(path[lane] as usize, light.lane(lane));
        }
    }

    /// Appends the states of the lanes with a mirror ray that have bounces left. Returns these lanes.
    #[inline(never)]
    fn mirror_states(&mut self, rays: &[u32; LANES], asked: u32) -> u32 {
        set_bits::<LANES>(asked).fold(0, |kept, lane| {
            let state = self.state(rays[lane] as usize);
            if state.bounces >= self.scene.bounces {
                return kept;
            }
            self.tracer.batch.next_carried.push_state(state.mirrored(), 0.0);
            kept | 1 << lane
        })
    }

    /// The footprint of the ray with that number.
    #[inline(always)]
    fn footprint(&self, ray: usize) -> Footprint {
        let Batch { paths, rays, carried, .. } = &self.tracer.batch;
        if self.bounce > 0 && self.differentials {
            return Footprint::Carried(carried.differential(ray));
        }
        Footprint::Camera(self.scene.camera.footprint(paths.sample[rays.path[ray] as usize]))
    }
}
