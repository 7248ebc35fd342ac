//! Transparent surfaces, where a path scatters into several rays.
//!
//! A path follows one ray at a time in both tracers. At a transparent surface that is the mirror
//! ray, then the refracted ray, then the one that goes straight on, each to its end before the
//! next. So contributions are added in this order, and no more than two rays for each bounce wait.

use glam::Vec3;

use super::{
    Branch, Group, GroupHits, Interface, InterfaceHit, PathState, PreparedScene, SampleCounts,
};
use crate::accel::{Hit, Traversal};
use crate::kernels::{
    Arithmetic, Differential, Footprint, Refracted, ShadingPoint, Transparency, shade,
};
use crate::math::{LANES, Line, Mask, Ray, Single, Vector, set_bits};

impl PreparedScene {
    /// As [`Meeting::scatter`], of one ray: the throughput of the light that the surface sends to it, and the rays that
    /// go on from there, in the order in which they are followed.
    #[inline(never)]
    pub fn scatter<P: Arithmetic>(
        &self,
        incoming: &Branch,
        hit: &Hit,
        transparency: &Transparency,
        point: &ShadingPoint<f32>,
        (traversal, look_ups): (&mut Traversal, &mut SampleCounts),
    ) -> (Vec3, [Option<Branch>; 3]) {
        let Branch { ray, throughput, state, .. } = *incoming;
        let meeting = Meeting {
            line: &Line::from(&ray),
            used: 1,
            hits: &[*hit; LANES],
            states: &[state; LANES],
            throughput: throughput.into(),
            point,
        };
        let mut scattered = meeting.scatter::<P>(self, transparency, traversal);
        if self.carries_differentials() {
            let (group, kind) = (self.group(&ray, hit), self.accel.geometry().kind(hit.primitive));
            let hits = (kind, meeting.line, hit.t);
            scattered.turn(&group, hits, self, &|_| incoming.footprint, (point, look_ups));
        }
        let branch = |rays: &ScatteredRays<f32>| (rays.asked == 1).then(|| rays.branch(0));
        (scattered.own.into(), scattered.rays.each_ref().map(branch))
    }
}

/// Where rays meet a transparent surface, each in a lane.
pub struct Meeting<'a, F: Single> {
    /// The rays.
    pub line: &'a Line<F>,
    /// The lanes in use, a bit each.
    pub used: u32,
    /// Their hits.
    pub hits: &'a [Hit; LANES],
    /// What they went through.
    pub states: &'a [PathState; LANES],
    /// The throughputs of the paths.
    pub throughput: Vector<F>,
    /// The points.
    pub point: &'a ShadingPoint<F>,
}

/// Rays into which paths scatter.
#[derive(Clone, Copy, Debug)]
pub struct Scattered<F: Single> {
    /// The throughputs of the light that the surfaces send to the rays themselves.
    pub own: Vector<F>,
    /// The mirror rays, the refracted ones, and those that go straight on: in the order in which they are followed.
    pub rays: [ScatteredRays<F>; 3],
    refracted: Refracted<F>,
    /// The refracted rays that nothing bends, a bit each.
    unbent: u32,
}

/// A ray for some of the lanes.
#[derive(Clone, Copy, Debug)]
pub struct ScatteredRays<F: Single> {
    /// The rays, of unit direction.
    pub line: Line<F>,
    /// Their least t.
    pub t_min: F,
    /// Their throughputs.
    pub throughput: Vector<F>,
    /// The lanes that have one, a bit each.
    pub asked: u32,
    /// Those of them whose ray is faint.
    pub faint: u32,
    /// What they went through.
    pub states: [PathState; LANES],
    /// Their differentials, if rays carry any.
    pub differential: Option<Differential<F>>,
}

impl<F: Single> ScatteredRays<F> {
    /// The lanes whose ray goes straight on from the camera.
    pub fn straight(&self) -> u32 {
        let straight = |&lane: &usize| !self.states[lane].turned;
        set_bits::<LANES>(self.asked).filter(straight).fold(0, |all, lane| all | 1 << lane)
    }

    /// The ray in a lane.
    #[inline(always)]
    pub fn branch(&self, lane: usize) -> Branch {
        let ray = Ray { t_min: self.t_min.lane(lane), ..self.line.ray(lane) };
        let carried = |of: Differential<F>| Footprint::Carried(of.lane(lane));
        let footprint = self.differential.map_or(Footprint::Camera(1.0), carried);
        let (throughput, state) = (self.throughput.lane(lane), self.states[lane]);
        Branch { ray, throughput, state, footprint }
    }
}

impl<F: Single> Meeting<'_, F> {
    /// Scatters the rays; their differentials are left to [`Scattered::turn`].
    #[inline(always)]
    pub fn scatter<P: Arithmetic>(
        &self,
        scene: &PreparedScene,
        transparency: &Transparency,
        traversal: &mut Traversal,
    ) -> Scattered<F> {
        let (point, mut throughput) = (self.point, self.throughput);
        let mut find = |lane| self.interface::<P>(lane, scene, transparency, traversal);
        let mut at = [find(0); LANES];
        for lane in set_bits::<LANES>(self.used & !1) {
            at[lane] = find(lane);
        }
        let mut there = 0;
        for lane in set_bits::<LANES>(self.used) {
            there |= u32::from(at[lane].is_there) << lane;
            let (media, before) = (&self.states[lane].media, &at[lane].sides.before);
            if media != before {
                let way = self.hits[lane].t.into();
                let more = scene.more_absorbed([media, before], way).as_vec3();
                throughput.set_lane(lane, throughput.lane(lane) * more);
            }
        }
        let token = point.kr.token();
        let before = F::lanes(token, |lane| scene.medium(&at[lane].sides.before).ior);
        let beyond = F::lanes(token, |lane| scene.medium(&at[lane].sides.beyond).ior);
        let (mirrored, refracted) = transparency.split(point, [before, beyond]);
        let is_there = F::mask(token, there);
        let none = Vector::splat(token, Vec3::ZERO);
        let own = Vector::select(is_there, throughput.scale(point.opacity), none);
        let mirrored = self.mirrored(scene, &at, own, (transparency, mirrored));
        let (bent, unbent) = self.refracted::<P>(scene, &at, own, &refracted, traversal);
        let straight = self.straight(scene, &at, throughput, is_there);
        Scattered { own, rays: [mirrored, bent, straight], refracted, unbent }
    }

    /// What lies where the ray in a lane meets the surface.
    fn interface<P: Arithmetic>(
        &self,
        lane: usize,
        scene: &PreparedScene,
        transparency: &Transparency,
        traversal: &mut Traversal,
    ) -> Interface {
        let ray = (&self.line.ray(lane), self.states[lane].media);
        let first = InterfaceHit::at(&self.hits[lane], self.point, lane);
        scene.interface::<P>(ray, first, transparency, traversal)
    }

    /// The mirror rays, of surfaces that mirror this weight of light by Fresnel's equations alone.
    #[inline(always)]
    fn mirrored(
        &self,
        scene: &PreparedScene,
        at: &[Interface; LANES],
        own: Vector<F>,
        (transparency, mirrored): (&Transparency, F),
    ) -> ScatteredRays<F> {
        let point = self.point;
        let kr = point.kr.times(1.0 - transparency.kt);
        let kr = F::select(point.lit, kr, kr.zero());
        let weight = point.reflection.tint.scale(kr) + Vector::new(mirrored, mirrored, mirrored);
        let (direction, _) = shade::mirrored(point.view, point.shading_normal, point.normal);
        let origin = point.point.offset_origin(point.error, point.normal, point.normal);
        let line = Line { origin, direction };
        self.rays(scene, (line, kr.zero()), own * weight, line.is_valid(), |lane| {
            PathState { media: at[lane].sides.before, ..self.states[lane] }.mirrored()
        })
    }

    /// The refracted rays, and those of them that nothing bends, a bit each.
    #[inline(always)]
    fn refracted<P: Arithmetic>(
        &self,
        scene: &PreparedScene,
        at: &[Interface; LANES],
        own: Vector<F>,
        refracted: &Refracted<F>,
        traversal: &mut Traversal,
    ) -> (ScatteredRays<F>, u32) {
        let Refracted { asked, weight, direction, .. } = *refracted;
        let token = weight.x.token();
        let is_unbent = !(direction - self.line.direction).is_not_zero();
        let point = Vector::<F>::lanes(token, |lane| at[lane].last.point.into());
        let error = Vector::<F>::lanes(token, |lane| at[lane].last.error.into());
        let side = Vector::<F>::lanes(token, |lane| at[lane].side());
        let origin = point.offset_origin(error, side, side);
        let line = Line { origin: Vector::select(is_unbent, self.line.origin, origin), direction };
        let t = F::lanes(token, |lane| at[lane].last.hit.t.next_up());
        let t_min = F::select(is_unbent, t, t.zero());
        let asked = asked & (is_unbent | line.is_valid());
        let unbent = is_unbent.bits();
        let tint = Vector::<F>::lanes(token, |lane| at[lane].tint);
        let mut rays = self.rays(scene, (line, t_min), own * weight * tint, asked, |lane| {
            let state = self.states[lane];
            let is_bent = unbent >> lane & 1 == 0;
            let next = if is_bent { Hit::MISS } else { at[lane].next };
            let (bounces, turned) = (state.bounces + 1, state.turned || is_bent);
            PathState { bounces, turned, media: at[lane].sides.beyond, next, ..state }
        });
        for lane in set_bits::<LANES>(rays.asked & !unbent) {
            if let Some(close) = at[lane].close {
                // It starts before that surface, and may pass beside.
                let (geometry, tests) = (scene.accel.geometry(), &mut traversal.tests);
                let t = geometry.hit::<P>(close.primitive, &rays.line.ray(lane), tests);
                rays.states[lane].next = t.map_or(Hit::MISS, |t| Hit { t, ..close });
            }
        }
        (rays, unbent)
    }

    /// The rays that go straight on behind the first surface, or where none is there, behind the last.
    #[inline(always)]
    fn straight(
        &self,
        scene: &PreparedScene,
        at: &[Interface; LANES],
        throughput: Vector<F>,
        is_there: F::Mask,
    ) -> ScatteredRays<F> {
        let opacity = self.point.opacity;
        let passed = throughput.scale(opacity.same(1.0) - opacity);
        let throughput = Vector::select(is_there, passed, throughput);
        let t = F::lanes(opacity.token(), |lane| {
            let hit = if at[lane].is_there { self.hits[lane] } else { at[lane].last.hit };
            hit.t.next_up()
        });
        self.rays(scene, (*self.line, t), throughput, opacity.eq(opacity), |lane| {
            let Interface { is_there, behind, second, next, .. } = at[lane];
            let (media, next) = match is_there {
                true => (behind, second),
                false => (at[lane].sides.beyond, next),
            };
            PathState { media, next, ..self.states[lane] }
        })
    }

    /// Those of the rays that go on.
    #[inline(always)]
    fn rays(
        &self,
        scene: &PreparedScene,
        (line, t_min): (Line<F>, F),
        throughput: Vector<F>,
        asked: F::Mask,
        state: impl Fn(usize) -> PathState,
    ) -> ScatteredRays<F> {
        let goes_on = (scene.visible.goes_on(throughput) & asked).bits() & self.used;
        let is_faint = scene.visible.is_faint(throughput).bits();
        let mut states = [PathState::default(); LANES];
        let (mut asked, mut faint) = (0, 0);
        for lane in set_bits::<LANES>(goes_on) {
            let mut state = state(lane);
            // As one of the rays into which the path is split.
            state.faint |= is_faint >> lane & 1 == 1;
            if state.bounces <= scene.bounces {
                asked |= 1 << lane;
                faint |= u32::from(state.faint) << lane;
                states[lane] = state;
            }
        }
        ScatteredRays { line, t_min, throughput, asked, faint, states, differential: None }
    }
}

impl<F: Single> Scattered<F> {
    /// Gives the rays differentials, from those of the rays of `group` with these `hits`, which carry one or come from
    /// the camera.
    #[inline(always)]
    pub fn turn(
        &mut self,
        group: &Group<F>,
        hits: GroupHits<'_, F>,
        scene: &PreparedScene,
        footprint: &dyn Fn(usize) -> Footprint,
        (point, look_ups): (&ShadingPoint<F>, &mut SampleCounts),
    ) {
        let from = scene.incoming_differentials(hits.1.direction, footprint);
        let [mirrored, refracted, straight] = &mut self.rays;
        let bent = refracted.asked & !self.unbent;
        look_ups.footprints += u64::from(mirrored.asked.count_ones() + bent.count_ones());
        [mirrored.differential, refracted.differential, straight.differential] = [Some(from); 3];
        if mirrored.asked != 0 {
            mirrored.differential = Some(group.mirrored(scene, hits, footprint, point));
        }
        if bent != 0 {
            let Refracted { direction, ratio, smooth, .. } = self.refracted;
            let bends = Some((direction, ratio));
            let mut turned = group.turned(scene, hits, &from, (point, smooth), bends);
            let unbent = refracted.asked & self.unbent;
            for lane in set_bits::<LANES>(unbent) {
                turned.set_lane(lane, &from.lane(lane));
            }
            refracted.differential = Some(turned);
        }
    }
}
