//! The next steps of rays in flight.

use bytemuck::Zeroable;

use super::FLIGHT;
use crate::accel::{ArenaView, Kind, Ref};

/// This many steps to leaves of a kind are worth a loop.
const ENOUGH_STEPS: usize = 16;

/// A ray in flight, by its slot, and its next place.
#[derive(Clone, Copy, Debug, Zeroable)]
pub(super) struct StreamStep(u64);

impl StreamStep {
    #[inline(always)]
    fn new(slot: usize, place: Ref) -> Self {
        Self(u64::from(place.bits()) << 32 | slot as u64)
    }

    #[inline(always)]
    pub(super) fn slot(self) -> usize {
        self.0 as usize & (FLIGHT - 1)
    }

    #[inline(always)]
    pub(super) fn place(self) -> Ref {
        Ref::from_bits((self.0 >> 32) as u32)
    }
}

/// The next steps of all rays in flight, by kind of place.
#[derive(Clone, Copy, Debug, Zeroable)]
pub(super) struct NextSteps {
    steps: [[StreamStep; FLIGHT]; 4],
    counts: [usize; 4],
}

impl NextSteps {
    /// The number of rays in flight.
    pub(super) fn count(&self) -> usize {
        self.counts.iter().sum()
    }

    /// Adds the step of a ray, and prefetches its place. Without a branch, which would be
    /// mispredicted.
    #[inline(always)]
    pub(super) fn push(&mut self, arena: ArenaView<'_>, slot: usize, then: Ref) {
        arena.prefetch(then);
        let kind = then.kind() as usize;
        let count = self.counts[kind];
        self.steps[kind][count & (FLIGHT - 1)] = StreamStep::new(slot, then);
        self.counts[kind] = count + 1;
    }

    /// The `i`th step to a place of this `kind`.
    #[inline(always)]
    pub(super) fn get(&self, kind: Kind, i: usize) -> StreamStep {
        self.steps[kind as usize][i & (FLIGHT - 1)]
    }

    /// Removes all steps to places of this `kind` from the list; they can be read until others are
    /// written there. Returns their number.
    #[inline(always)]
    pub(super) fn take(&mut self, kind: Kind) -> usize {
        std::mem::take(&mut self.counts[kind as usize]).min(FLIGHT)
    }

    /// As [`NextSteps::take`], if there are enough steps, or none of the kinds before.
    #[inline(always)]
    pub(super) fn take_enough(&mut self, kind: Kind) -> usize {
        let is_first = self.counts[..kind as usize].iter().all(|&count| count == 0);
        let is_time = is_first || self.counts[kind as usize] >= ENOUGH_STEPS;
        if is_time { self.take(kind) } else { 0 }
    }
}
