//! Hits that single precision cannot tell from those on a neighbour.
//!
//! A ray that passes just outside of a triangle may meet its rounded vertices ([`Meeting::Near`]). If the ray then
//! meets the neighbour across the edge, and rounding has it pass outside of that one, the surface would be lost; if it
//! passes the surface altogether, as a ray does that leaves a flat floor, there must be no hit. Both triangles cannot be
//! told apart from one alone: so the ray is traced once more, without rounding, and such a hit counts if there is a
//! surface. It happens for some rays in millions, and depends on ray and triangle only.

use super::geometry::{Geometry, PreparedRay};
use super::query::Closest;
use super::tree::{Searched, reach};
use super::{Hit, TestCounts, Traversal, compiled};
use crate::kernels::precision::{Arithmetic, Exact, Robust};
use crate::kernels::triangle::Meeting;
use crate::math::ray::Ray;

impl Searched<'_> {
    /// The t at which the ray hits the primitive, if it does.
    #[inline(always)]
    pub(super) fn hit<P: Arithmetic>(
        &self,
        number: u32,
        ray: &PreparedRay,
        tests: &mut TestCounts,
    ) -> Option<f32> {
        self.geometry.count(number, tests);
        let meeting = self.geometry.meet::<P>(number, ray);
        meeting.confirmed(|t| self.has_surface(ray, t))
    }

    /// As [`Self::hit`], for a triangle that was counted when it was tested among others.
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
        meeting.confirmed(|t| self.has_surface(ray, t))
    }

    /// Whether the ray, which passes a triangle near t, meets the surface there.
    #[cold]
    #[inline(never)]
    fn has_surface(&self, ray: &PreparedRay, t: f32) -> bool {
        let endless = Ray { t_max: f32::INFINITY, ..ray.ray };
        let mut traversal =
            Traversal { stack: vec![0; self.tree.stack_entries()], ..Traversal::default() };
        let level = fearless_simd::Level::new();
        let prepared = PreparedRay::of::<Exact>(&endless);
        let found = compiled::one::<Closest, Exact>(level, *self, &prepared, &mut traversal);
        is_surface(self.geometry, &endless, t, found)
    }
}

impl Geometry {
    /// As [`Searched::has_surface`], of the geometry's own primitives one after the other.
    #[cold]
    #[inline(never)]
    pub(super) fn has_surface(&self, ray: &PreparedRay, t: f32) -> bool {
        let endless = Ray { t_max: f32::INFINITY, ..ray.ray };
        let prepared = PreparedRay::of::<Exact>(&endless);
        let mut found = Hit::MISS;
        for number in 0..self.own() as u32 {
            if let Meeting::Hit(t) = self.meet::<Exact>(number, &prepared)
                && t < found.t
            {
                found = Hit { t, primitive: number };
            }
        }
        is_surface(self, &endless, t, found)
    }
}

/// Whether the hit that was `found` without rounding is the one near t: not if it lies beyond, on a primitive that is
/// met with rounding too.
fn is_surface(geometry: &Geometry, ray: &Ray, t: f32, found: Hit) -> bool {
    if found.is_miss() || found.t <= reach::<Robust>(t) {
        return !found.is_miss();
    }
    geometry.meet::<Robust>(found.primitive, &PreparedRay::new(ray)) == Meeting::Miss
}

impl Meeting {
    /// The t, if this is a hit or `is_met` says so of one that is near.
    #[inline(always)]
    pub(super) fn confirmed(self, is_met: impl FnOnce(f32) -> bool) -> Option<f32> {
        match self {
            Self::Miss => None,
            Self::Hit(t) => Some(t),
            Self::Near(t) => is_met(t).then_some(t),
        }
    }
}
