//! Hits on surfaces of one kind, which wait until there are enough to be shaded together.
//!
//! What a hit needs lies far apart in memory. It is fetched for a block of hits, loop by loop, so
//! that many look-ups are on their way at a time, and only then computed with.

use crate::accel::geometry::Geometry;
use crate::math::ray::Ray;
use crate::math::real::Single;
use crate::math::simd::LANES;
use crate::prepared::{Appearance, Face, Group};

/// Groups of hits that are fetched together.
const GROUPS: usize = 8;

/// The most hits that wait.
const WAITING: usize = GROUPS * LANES;

/// Hits that wait until a block is full.
pub(super) struct Faces<F: Single> {
    waiting: [Face; WAITING],
    count: usize,
    groups: [Group<F>; GROUPS],
}

impl<F: Single> Faces<F> {
    /// Hits in a block.
    const BLOCK: usize = GROUPS * F::LANES;

    pub(super) fn new() -> Self {
        Self { waiting: [Face::default(); WAITING], count: 0, groups: [Group::default(); GROUPS] }
    }

    /// Adds a hit. Whether the block is full.
    #[inline(always)]
    pub(super) fn push(&mut self, face: Face) -> bool {
        self.waiting[self.count & (WAITING - 1)] = face;
        self.count += 1;
        self.count >= Self::BLOCK
    }

    /// Fetches what the hits need, corners where they are asked for, and empties the block.
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
