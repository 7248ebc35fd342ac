//! The rays of a path, and what becomes of them.

use glam::Vec3;

use super::{MediumStack, PreparedScene};
use crate::accel::Hit;
use crate::geometry::Geometry;
use crate::kernels::Footprint;
use crate::math::Ray;
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
    /// Its footprint; without a meaning if rays carry none.
    pub footprint: Footprint,
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
}
