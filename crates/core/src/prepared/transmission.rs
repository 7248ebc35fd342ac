//! Transparent surfaces, where a path scatters into several rays.
//!
//! A path follows one ray at a time in both tracers. At a transparent surface that is the mirror
//! ray, then the refracted ray, then the one that goes straight on, each to its end before the
//! next. So contributions are added in this order, and no more than two rays for each bounce wait.

use glam::Vec3;

use super::{Interface, InterfaceHit, MediumStack, PreparedScene, SampleCounts, Sides};
use crate::accel::{Hit, Traversal};
use crate::geometry::Geometry;
use crate::kernels::{Arithmetic, Differential, ShadingPoint, Transparency, shade};
use crate::math::{Ray, Vector};
use crate::plan::Effect;
use crate::plan::schedule::Step;

/// What a ray went through on its path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathState {
    /// How often it was mirrored or refracted.
    pub bounces: u32,
    /// Whether it was mirrored: it then sees no background.
    pub mirrored: bool,
    /// Whether only what is brighter than white counts: see [`Visible`](super::Visible).
    pub faint: bool,
    /// Whether it was mirrored or bent: until then, the ray goes straight on from the camera.
    pub turned: bool,
    /// What it is inside of.
    pub media: MediumStack,
    /// The hit that it has if that is known: what lies where it starts. Else a miss.
    pub next: Hit,
}

impl PathState {
    /// The state of a mirror ray from here.
    pub fn mirrored(self) -> Self {
        let bounces = self.bounces + 1;
        Self { bounces, mirrored: true, turned: true, next: Hit::MISS, ..self }
    }
}

/// Most rays of a path: where surfaces send on all that they receive, and mirror it, a path scatters again
/// and again.
pub const MOST_RAYS: u32 = 1 << 16;

/// A ray of a path.
#[derive(Clone, Copy, Debug)]
pub struct Branch {
    /// The ray, of unit direction.
    pub ray: Ray,
    /// Its throughput.
    pub throughput: Vec3,
    /// What it went through.
    pub state: PathState,
    /// Its differential; that of a camera ray follows from its direction.
    pub differential: Option<Differential>,
}

impl Branch {
    /// Moves the faint ones of the rays from the `first` on below all others, which follow one another as if there were
    /// none: random numbers go by the number of a ray.
    pub fn sink(waiting: &mut Vec<Self>, first: usize) {
        for i in first..waiting.len() {
            if waiting[i].state.faint {
                let faint = waiting.remove(i);
                waiting.insert(0, faint);
            }
        }
    }
}

impl PreparedScene {
    /// The share of a `weight` that counts for light of this brightness, at the end of a ray in this state.
    #[inline(always)]
    pub fn shown(&self, state: &PathState, weight: Vec3, brightness: Vec3) -> Vec3 {
        let is_lost = state.faint && !self.visible.counts(weight, brightness);
        if is_lost { Vec3::ZERO } else { weight }
    }

    /// Whether the exact t of hits is needed: for footprints, for light absorbed on the way, and for bent
    /// quads with holes, which tell by it which of their halves was hit.
    pub fn needs_t(&self) -> bool {
        let Geometry { cutouts, quads, .. } = self.accel.geometry();
        self.plan.has(Effect::RayDifferentials)
            || self.plan.schedule().has_transmission()
            || !cutouts.is_empty() && !quads.is_empty()
    }

    /// Whether hits need shading points: for rays, appearance, or ambient light that is not the same
    /// everywhere.
    pub fn needs_points(&self) -> bool {
        const STEPS: [Step; 6] = [
            Step::Normals,
            Step::Colors,
            Step::Texels,
            Step::NormalMaps,
            Step::Maps,
            Step::Emission,
        ];
        let schedule = self.plan.schedule();
        schedule.has_shadows()
            || schedule.goes_on()
            || STEPS.iter().any(|&step| schedule.runs(step))
            || self.appearance.classes.iter().any(|class| class.material.ambient != 1.0)
            || self.hemisphere.is_some()
    }

    /// The light of a ray that escapes, as it meets nothing: only what was mirrored does not see the background.
    #[inline(always)]
    pub fn escaped(&self, direction: Vec3, state: &PathState) -> Option<Vec3> {
        if let Some(environment) = &self.environment {
            if environment.hidden && !state.turned {
                return None;
            }
            let image = |number: u32| self.appearance.images[number as usize].usable();
            return Some(environment.at(direction, image));
        }
        match &self.hemisphere {
            _ if !state.mirrored => Some(self.background),
            Some(hemisphere) => Some(hemisphere.at::<f32>(direction.into()).into()),
            None => None,
        }
    }

    /// The share of light that remains of what `ray`, inside of `media`, meets at `t`.
    #[inline]
    pub fn remaining(&self, ray: &Ray, media: &MediumStack, t: f32) -> Vec3 {
        self.absorbed(media, f64::from(t) - f64::from(ray.t_min)).as_vec3()
    }

    /// The throughput of the light that `point` of a transparent surface sends to the incoming ray
    /// itself, and the rays that go on from there, in the order in which they are followed.
    #[inline(never)]
    pub fn scatter<P: Arithmetic>(
        &self,
        incoming: &Branch,
        hit: &Hit,
        transparency: &Transparency,
        point: &ShadingPoint<f32>,
        (traversal, look_ups): (&mut Traversal, &mut SampleCounts),
    ) -> (Vec3, [Option<Branch>; 3]) {
        let Branch { ray, state, mut throughput, .. } = *incoming;
        let interface = self.interface::<P>(incoming, (hit, point), transparency, traversal);
        let Interface { sides: Sides { before, beyond }, last, close, .. } = interface;
        if before != state.media {
            throughput *= self.more_absorbed([&state.media, &before], hit.t.into()).as_vec3();
        }
        let counts = |throughput: Vec3, state: &PathState| {
            self.visible.goes_on(throughput) && state.bounces <= self.bounces
        };
        // As one of the rays into which the path is split.
        let split = |throughput: Vec3, state: PathState| PathState {
            faint: state.faint || self.visible.is_faint(throughput),
            ..state
        };
        let from = self
            .carries_differentials()
            .then(|| self.incoming_differentials(ray.direction.into(), &|_| incoming.differential));
        // The same ray, behind a hit.
        let straight = |(hit, next): (Hit, Option<Hit>), state: PathState, throughput: Vec3| {
            let state = PathState { next: next.unwrap_or(Hit::MISS), ..split(throughput, state) };
            let ray = Ray { t_min: hit.t.next_up(), ..ray };
            let branch = Branch { ray, throughput, state, differential: from };
            counts(throughput, &state).then_some(branch)
        };
        let on = PathState { media: beyond, ..state };
        if !interface.is_there {
            return (
                Vec3::ZERO,
                [None, None, straight((last.hit, interface.next), on, throughput)],
            );
        }
        let own = throughput * point.opacity;
        let iors = [before, beyond].map(|media| self.medium(&media).ior);
        let (mirrored, refracted) = transparency.split(point, iors);
        let turned =
            |start: [Vector<f32>; 3], state: PathState, direction: Vec3, throughput: Vec3| {
                let [point, error, side] = start;
                let ray = Ray::new(point.offset_origin(error, side, side).into(), direction);
                let goes_on = counts(throughput, &state) && ray.is_valid();
                let state = split(throughput, state);
                goes_on.then_some(Branch { ray, throughput, state, differential: None })
            };
        let kr = if point.lit { point.kr * (1.0 - transparency.kt) } else { 0.0 };
        let mirror = Vec3::from(point.reflection.tint) * kr + Vec3::splat(mirrored);
        let (direction, _) = shade::mirrored(point.view, point.shading_normal, point.normal);
        let state = PathState { media: before, ..state };
        let start = [point.point, point.error, point.normal];
        let mut branches = [
            turned(start, state.mirrored(), direction.into(), own * mirror),
            refracted.and_then(|found| {
                let state = PathState { bounces: state.bounces + 1, ..on };
                let throughput = own * found.weight * interface.tint;
                if found.direction == ray.direction {
                    return straight((last.hit, interface.next), state, throughput);
                }
                let state = PathState { turned: true, ..state };
                let InterfaceHit { point, error, normal, .. } = last;
                let side = if close.is_some() { normal } else { -normal };
                let mut bent = turned([point, error, side], state, found.direction, throughput);
                if let (Some(bent), Some(close)) = (&mut bent, close) {
                    // It starts before that surface, and may pass beside.
                    let (geometry, tests) = (self.accel.geometry(), &mut traversal.tests);
                    let t = geometry.hit::<P>(close.primitive, &bent.ray, tests);
                    bent.state.next = t.map_or(Hit::MISS, |t| Hit { t, ..close });
                }
                bent
            }),
            straight(
                (*hit, interface.second),
                PathState { media: interface.behind, ..state },
                throughput * (1.0 - point.opacity),
            ),
        ];
        if let Some(from) = &from {
            let [mirror, bent, _] = &mut branches;
            if let Some(mirror) = mirror {
                mirror.differential =
                    Some(self.turned(Some(*from), (&ray, hit), point, None, look_ups));
            }
            if let (Some(bent), Some(refracted)) = (bent, &refracted)
                && bent.differential.is_none()
            {
                let refracted = Some(refracted);
                let found = self.turned(Some(*from), (&ray, hit), point, refracted, look_ups);
                bent.differential = Some(found);
            }
        }
        (own, branches)
    }
}
