//! Hits that single precision cannot tell from hits of a neighbour.
//!
//! A ray that passes just outside a triangle may meet its rounded vertices ([`Meeting::Near`]). If
//! the ray then meets the neighbour across the edge, but rounding makes it miss that one, the
//! surface would be lost. If it misses the surface altogether, as a ray that leaves a flat floor
//! does, there must be no hit. One triangle alone cannot tell these cases apart, so the ray is
//! traced once more without rounding, and the hit counts if there is a surface. This happens for a
//! few rays in millions, and depends only on ray and triangle.

use std::cell::RefCell;

use super::geometry::{Geometry, PreparedRay};
use super::query::Closest;
use super::tree::{Searched, reach};
use super::{Hit, TestCounts, Traversal, compiled};
use crate::kernels::precision::{Arithmetic, Exact, Reference};
use crate::kernels::triangle::Meeting;
use crate::math::ray::Ray;

/// The unrounded hits of recent rays, so that a ray that passes several triangles closely is traced
/// once.
#[derive(Debug, Default)]
pub(super) struct Exactly(RefCell<Vec<(Ray, Hit)>>);

/// As many rays as are in flight at a time: the search in the list is linear.
const MOST_REMEMBERED: usize = 64;

impl Exactly {
    fn hit(&self, ray: &Ray, find: impl FnOnce() -> Hit) -> Hit {
        let known = self.0.borrow().iter().find(|(known, _)| known == ray).map(|&(_, hit)| hit);
        known.unwrap_or_else(|| {
            let hit = find();
            let mut all = self.0.borrow_mut();
            if all.len() == MOST_REMEMBERED {
                all.clear();
            }
            all.push((*ray, hit));
            hit
        })
    }
}

impl Searched<'_> {
    /// The t at which the ray hits the primitive.
    #[inline(always)]
    pub(super) fn hit<P: Arithmetic>(
        &self,
        number: u32,
        ray: &PreparedRay,
        tests: &mut TestCounts,
    ) -> Option<f32> {
        self.geometry.hit::<P>(number, ray, tests, |t| self.has_surface(number, ray, t))
    }

    /// As [`Self::hit`], for a triangle already counted when it was tested in lanes.
    #[cold]
    #[inline(never)]
    pub(super) fn hit_again<P: Arithmetic>(
        &self,
        number: u32,
        ray: &PreparedRay,
        tests: &mut TestCounts,
    ) -> Option<f32> {
        tests.undecided += 1;
        let meeting = self.geometry.meet::<P>(number, ray);
        meeting.confirmed(|t| self.has_surface(number, ray, t))
    }

    /// Whether the ray, which passes the primitive closely at t, meets the surface there.
    #[cold]
    #[inline(never)]
    fn has_surface(&self, number: u32, ray: &PreparedRay, t: f32) -> bool {
        let endless = Ray { t_max: f32::INFINITY, ..ray.ray };
        let found = self.exactly.hit(&endless, || {
            let mut traversal =
                Traversal { stack: vec![0; self.tree.stack_entries()], ..Traversal::default() };
            let level = fearless_simd::Level::new();
            compiled::one::<Closest, Reference>(level, *self, &endless, &mut traversal)
        });
        is_surface(self.geometry, number, &endless, t, found)
    }
}

impl Geometry {
    /// As [`Searched::has_surface`], by brute force over the geometry's own primitives.
    #[cold]
    #[inline(never)]
    pub(super) fn has_surface(
        &self,
        number: u32,
        ray: &PreparedRay,
        t: f32,
        exactly: &Exactly,
    ) -> bool {
        let endless = Ray { t_max: f32::INFINITY, ..ray.ray };
        let found = exactly.hit(&endless, || {
            let prepared = PreparedRay::of::<Reference>(&endless);
            let meetings = (0..self.own() as u32).filter_map(|primitive| {
                let counts = &mut TestCounts::default();
                let t = self.hit::<Reference>(primitive, &prepared, counts, |_| false)?;
                Some(Hit { t, primitive })
            });
            meetings.fold(Hit::MISS, |best, hit| if hit.t < best.t { hit } else { best })
        });
        is_surface(self, number, &endless, t, found)
    }
}

/// Whether the hit `found` without rounding is that of the primitive passed closely at t: not if it
/// is farther, on a surface that is met with rounding too.
fn is_surface(geometry: &Geometry, number: u32, ray: &Ray, t: f32, found: Hit) -> bool {
    if found.is_miss() || found.t <= reach::<Exact>(t) {
        return !found.is_miss();
    }
    match geometry.meet::<Exact>(found.primitive, &PreparedRay::new(ray)) {
        Meeting::Hit(_) => false,
        // A quad passed at one half while rounding makes the ray miss the other has only this hit.
        // Another quad decides for itself.
        Meeting::Near(_) => found.primitive == number,
        Meeting::Miss => true,
    }
}

impl Meeting {
    /// The t of a hit, or of a near hit for which `is_met` returns true.
    #[inline(always)]
    pub(super) fn confirmed(self, is_met: impl FnOnce(f32) -> bool) -> Option<f32> {
        match self {
            Self::Miss => None,
            Self::Hit(t) => Some(t),
            Self::Near(t) => is_met(t).then_some(t),
        }
    }
}
