//! Hits on surfaces of one kind, collected to be shaded together.
//!
//! The data of hits is spread over memory. It is fetched for a block of hits, loop by loop, so that
//! many loads are in flight at a time, before any computation.

use crate::geometry::Geometry;
use crate::math::ray::Ray;
use crate::math::real::Single;
use crate::math::simd::LANES;
use crate::prepared::{Appearance, Face, Group};

/// Groups of hits that are fetched together.
const GROUPS: usize = 8;

/// Largest number of waiting hits.
const WAITING: usize = GROUPS * LANES;

/// Hits that wait for a full block.
pub(super) struct WaitingHits<F: Single> {
    waiting: [Face; WAITING],
    count: usize,
    groups: [Group<F>; GROUPS],
}

impl<F: Single> WaitingHits<F> {
    /// Hits in a block.
    const BLOCK: usize = GROUPS * F::LANES;

    pub(super) fn new() -> Self {
        Self { waiting: [Face::default(); WAITING], count: 0, groups: [Group::default(); GROUPS] }
    }

    /// Adds a hit. Returns whether the block is full.
    #[inline(always)]
    pub(super) fn push(&mut self, face: Face) -> bool {
        self.waiting[self.count & (WAITING - 1)] = face;
        self.count += 1;
        self.count >= Self::BLOCK
    }

    /// Fetches the data of the hits, with corners only if needed, and empties the block.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        with_corners: bool,
        geometry: &Geometry,
        appearance: &Appearance,
        ray: impl Fn(usize) -> Ray + Copy,
    ) -> &[Group<F>] {
        let count = self.count.div_ceil(F::LANES).min(GROUPS);
        let waiting = &self.waiting[..self.count.min(WAITING)];
        for (group, faces) in self.groups.iter_mut().zip(waiting.chunks(F::LANES)) {
            group.begin(faces, appearance);
        }
        let asked = if with_corners { count } else { 0 };
        for group in &mut self.groups[..asked] {
            for lane in 0..F::LANES {
                let number = group.faces[lane].ray as usize;
                group.fetch(lane, geometry, appearance, || ray(number));
            }
        }
        self.count = 0;
        &self.groups[..count]
    }
}
