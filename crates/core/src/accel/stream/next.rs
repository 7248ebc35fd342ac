//! The next steps of rays in flight.

use bytemuck::Zeroable;

use super::FLIGHT;
use crate::accel::Kind;

/// This many steps to leaves of a kind are worth a loop.
const ENOUGH_STEPS: usize = 16;

/// The kinds of places, and the slots for each: a byte tells all apart.
const KINDS: usize = 4;
const _: () = assert!(KINDS * FLIGHT == 256);

/// The rays in flight by the kind of their next place, each by its slot.
#[derive(Clone, Copy, Debug, Zeroable)]
pub(super) struct NextSteps {
    slots: [u8; KINDS * FLIGHT],
    counts: [u32; KINDS],
}

impl NextSteps {
    /// The number of rays in flight.
    pub(super) fn count(&self) -> usize {
        self.counts.iter().sum::<u32>() as usize
    }

    /// Adds the step of a ray. Without a branch, which would be mispredicted.
    #[inline(always)]
    pub(super) fn push(&mut self, kind: Kind, slot: usize) {
        let count = &mut self.counts[kind as usize];
        self.slots[at(kind, *count as usize)] = slot as u8;
        *count += 1;
    }

    /// The slot of the `i`th step to a place of this `kind`.
    #[inline(always)]
    pub(super) fn get(&self, kind: Kind, i: usize) -> usize {
        usize::from(self.slots[at(kind, i)]) % FLIGHT
    }

    /// Removes all steps to places of this `kind` from the list; they can be read until others are
    /// written there. Returns their number.
    #[inline(always)]
    pub(super) fn take(&mut self, kind: Kind) -> usize {
        (std::mem::take(&mut self.counts[kind as usize]) as usize).min(FLIGHT)
    }

    /// As [`NextSteps::take`], if there are enough steps, or none of the kinds before.
    #[inline(always)]
    pub(super) fn take_enough(&mut self, kind: Kind) -> usize {
        let is_first = self.counts[..kind as usize].iter().all(|&count| count == 0);
        let is_time = is_first || self.counts[kind as usize] as usize >= ENOUGH_STEPS;
        if is_time { self.take(kind) } else { 0 }
    }
}

/// The place of the `i`th step of a kind among those of all: kinds alternate.
#[inline(always)]
fn at(kind: Kind, i: usize) -> usize {
    usize::from((i * KINDS + kind as usize) as u8)
}
