//! Transparent surfaces: where a path divides.
//!
//! A path follows one ray at a time in both tracers. At a transparent surface that is the mirror
//! ray, then the refracted ray, then the one that goes straight on, each to its end before the
//! next. So contributions are added in this order, and no more than two rays for each bounce wait.

use glam::Vec3;

use super::{LookUps, PreparedScene};
use crate::accel::Hit;
use crate::kernels::differential::Differential;
use crate::kernels::shade::{self, ShadingPoint};
use crate::kernels::transmission::{self, Transparency};
use crate::math::ray::Ray;
use crate::plan::Effect;
use crate::plan::schedule::Step;

/// What a ray went through on its path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trail {
    /// How often it was mirrored or refracted.
    pub bounces: u32,
    /// Whether it was mirrored: it then sees no background.
    pub mirrored: bool,
    /// Light absorbed on its way, by channel, per scene unit: the sum over all that it is inside of.
    pub absorption: Vec3,
}

impl Trail {
    /// The trail of a mirror ray from here.
    pub fn mirrored(self) -> Self {
        Self { bounces: self.bounces + 1, mirrored: true, ..self }
    }

    /// The trail behind a surface with this `absorption` inside, which is entered or left.
    fn behind(self, absorption: Vec3, leaves: bool) -> Self {
        let sum = self.absorption + if leaves { -absorption } else { absorption };
        Self { absorption: sum.max(Vec3::ZERO), ..self }
    }

    /// The share of light that remains of what is met at `t`.
    #[inline]
    pub fn remaining(&self, t: f32) -> Option<Vec3> {
        let absorbs = self.absorption != Vec3::ZERO && t.is_finite();
        absorbs.then(|| transmission::remaining(self.absorption, t.into()).as_vec3())
    }
}

/// A ray of a path.
#[derive(Clone, Copy, Debug)]
pub struct Branch {
    /// The ray, of unit direction.
    pub ray: Ray,
    /// Its throughput.
    pub throughput: Vec3,
    /// What it went through.
    pub trail: Trail,
    /// Its differential; that of a camera ray follows from its direction.
    pub differential: Option<Differential>,
}

impl PreparedScene {
    /// Whether ambient light arrives along shadow rays.
    pub(super) fn traces_ambient(&self) -> bool {
        self.hemisphere.is_some_and(|hemisphere| hemisphere.traced)
    }

    /// Whether the exact t of hits is needed: for footprints, and for light absorbed on the way.
    pub fn needs_t(&self) -> bool {
        self.plan.has(Effect::RayDifferentials) || self.plan.schedule().has_transmission()
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

    /// The colour along a ray that meets nothing: only what was mirrored does not see the background.
    #[inline(always)]
    pub fn beyond(&self, direction: Vec3, mirrored: bool) -> Option<Vec3> {
        if let Some(environment) = &self.environment {
            let image = |number: u32| self.appearance.images[number as usize].look_up();
            return Some(environment.at(direction, image));
        }
        match &self.hemisphere {
            _ if !mirrored => Some(self.background),
            Some(hemisphere) => Some(hemisphere.at::<f32>(direction.into()).into()),
            None => None,
        }
    }

    /// The throughput of the light that `point` of a transparent surface sends to the arriving ray
    /// itself, and the rays that go on from there, in the order in which they are followed.
    #[inline(never)]
    pub fn divide(
        &self,
        arriving: &Branch,
        hit: &Hit,
        transparency: &Transparency,
        point: &ShadingPoint<f32>,
        look_ups: &mut LookUps,
    ) -> (Vec3, [Option<Branch>; 3]) {
        let Branch { ray, trail, mut throughput, .. } = *arriving;
        if point.inside {
            // A path that began inside did not meet the front.
            let more = (transparency.absorption - trail.absorption).max(Vec3::ZERO);
            throughput *= transmission::remaining(more, hit.t.into()).as_vec3();
        }
        let behind = trail.behind(transparency.absorption, point.inside);
        let own = throughput * point.opacity;
        let (mirrored, refracted) = transparency.split(point);
        let kr = if point.lit { point.kr * (1.0 - transparency.kt) } else { 0.0 };
        let mirror = Vec3::from(point.reflection.tint) * kr + Vec3::splat(mirrored);
        let (direction, _) = shade::mirrored(point.view, point.shading_normal, point.normal);
        let next = |trail: Trail, direction: Vec3, throughput: Vec3| {
            let origin = point.point.offset_origin(point.error, point.normal, direction.into());
            let ray = Ray::new(origin.into(), direction);
            let counts = throughput.max_element() >= Transparency::LEAST_WEIGHT;
            let goes_on = counts && trail.bounces <= self.bounces && ray.is_valid();
            goes_on.then_some(Branch { ray, throughput, trail, differential: None })
        };
        let mut branches = [
            next(trail.mirrored(), direction.into(), own * mirror),
            refracted.and_then(|found| {
                let refracted = Trail { bounces: behind.bounces + 1, ..behind };
                next(refracted, found.direction, own * found.weight)
            }),
            next(behind, ray.direction, throughput * (1.0 - point.opacity)),
        ];
        if self.carries_differentials() {
            let from = self.arriving(ray.direction.into(), &|_| arriving.differential);
            let [mirror, bent, straight] = &mut branches;
            if let Some(mirror) = mirror {
                mirror.differential = Some(self.mirrored(Some(from), &ray, hit, point, look_ups));
            }
            for (branch, refracted) in [(bent, refracted.as_ref()), (straight, None)] {
                if let Some(branch) = branch {
                    let found = self.transmitted(&from, (&ray, hit), point, refracted, look_ups);
                    branch.differential = Some(found);
                }
            }
        }
        (own, branches)
    }
}
