//! Traversal by many rays at a time: the kernel of a wavefront's batch.
//!
//! A thread keeps [`FLIGHT`] rays in flight, each with a stack of its own. In each round every ray
//! takes one step and asks for the memory of its next; by the time that its turn comes again, the
//! memory is there. Steps of a kind are taken in loops of their own, which have few branches, and so
//! the processor is on its way with several rays at any time: steps to leaves wait until there are
//! enough of them for that. A ray that is done makes place for the next one of the batch. The
//! children of a node that are met are sorted and pushed as a vector, and the next is popped. So that
//! no entry has to be looked at twice, a stack is cleared of what is too far when a hit is found, and
//! only then.

mod next;

use fearless_simd::prelude::*;
use glam::Vec3;

use super::arena::{Kind, Ref};
use super::geometry::{Geometry, PreparedRay};
use super::node::{self, distance, place};
use super::query::{Query, no_hit};
use super::rays::Rays;
use super::tree::{Root, Tree, reach};
use super::{Hit, KernelCounts, TestCounts, leaf};
use crate::kernels::precision::Arithmetic;
use crate::kernels::triangle::LaneHits;
use crate::math::ray::Ray;
use crate::math::simd::{LANES, Lanes, entry};
use next::Next;

/// The most places that a packet hands a ray over with.
pub(super) const MOST_HANDED: usize = 24;

/// Rays in flight.
pub(super) const FLIGHT: usize = 64;

/// A ray in flight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) ray: PreparedRay,
    best: Hit,
    reach: f32,
    /// Its number in the batch.
    number: u32,
}

impl Slot {
    /// For a ray to come.
    fn empty() -> Self {
        let ray = PreparedRay::new(&Ray::new(Vec3::ZERO, Vec3::X));
        Self { ray, best: Hit::MISS, reach: 0.0, number: 0 }
    }

    /// What else there is to know of a ray at its beginning: its number in the batch, and the
    /// closest hit known.
    #[inline(always)]
    pub(super) fn begin<P: Arithmetic>(&mut self, number: usize, best: Hit) {
        self.best = best;
        self.reach = reach::<P>(best.t);
        self.number = number as u32;
    }

    /// Clears its stack, from `bottom` to `top`, of what lies beyond the hit just found: of all if any is
    /// enough. The top that is left.
    #[inline(always)]
    fn closer<Q: Query, P: Arithmetic>(
        &mut self,
        stacks: &mut [u64],
        bottom: usize,
        top: usize,
    ) -> usize {
        if Q::ANY {
            return bottom + 1;
        }
        self.reach = reach::<P>(self.best.t);
        clear(stacks, bottom, top, self.reach)
    }
}

/// The children of a node, and which of them are met.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Met {
    entries: [u64; LANES],
    mask: u8,
}

/// What a patch has been found to hold.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Found {
    pub(super) hits: LaneHits,
    /// Where the numbers of the triangles begin.
    pub(super) first: u32,
}

/// The bottom of a stack, where rays are done. No list begins at unit 1: the root does at unit 0, and
/// is either all there is or a node of two units.
const BOTTOM: u32 = 1 << 2 | Kind::List as u32;

/// The memory of a thread's rays in flight.
#[derive(Clone, Debug)]
pub(super) struct Flight {
    slots: Box<[Slot; FLIGHT]>,
    /// One stack after the other.
    stacks: Vec<u64>,
    /// Where each stack ends.
    tops: [usize; FLIGHT],
    /// Entries of one stack.
    stride: usize,
}

impl Flight {
    /// Memory for rays in trees whose stacks take so many entries.
    pub(super) fn new(entries: usize) -> Self {
        // The end of the stack, and what a packet hands over.
        Self::of_stride(entries + 1 + MOST_HANDED)
    }

    fn of_stride(stride: usize) -> Self {
        Self {
            slots: Box::new([Slot::empty(); FLIGHT]),
            stacks: vec![0; stride * FLIGHT],
            tops: [0; FLIGHT],
            stride,
        }
    }
}

impl Default for Flight {
    fn default() -> Self {
        Self::of_stride(0)
    }
}

/// Where rays come from.
pub(super) trait Source<Q: Query, P: Arithmetic> {
    /// Fills `slot` with the next ray that has to be traced, and `stack` with the entries to begin
    /// with, as many as it says. Rays that need not be traced are answered on the way.
    fn next(
        &mut self,
        answers: &mut [Q::Answer],
        stack: &mut [u64],
        slot: &mut Slot,
    ) -> Option<usize>;
}

/// Rays of a batch from `next` on, each from the root.
pub(super) struct FromRoot<'a> {
    pub(super) rays: Rays<'a>,
    pub(super) next: usize,
    pub(super) root: Root,
}

impl<Q: Query, P: Arithmetic> Source<Q, P> for FromRoot<'_> {
    #[inline(always)]
    fn next(
        &mut self,
        answers: &mut [Q::Answer],
        stack: &mut [u64],
        slot: &mut Slot,
    ) -> Option<usize> {
        while self.next < self.rays.count() {
            let number = self.next;
            self.next += 1;
            let ray = self.rays.ray(number);
            if !ray.is_valid() {
                answers[number] = Q::NONE;
                continue;
            }
            slot.ray = PreparedRay::of::<P>(&ray);
            if !self.root.is_met::<P>(&slot.ray) {
                answers[number] = Q::NONE;
                continue;
            }
            stack[0] = entry(f32::NEG_INFINITY, self.root.place.bits());
            slot.begin::<P>(number, no_hit(&ray));
            return Some(1);
        }
        None
    }
}

/// Answers all rays of `source`.
#[inline(always)]
pub(super) fn trace<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    tree: &Tree,
    geometry: &Geometry,
    source: &mut impl Source<Q, P>,
    answers: &mut [Q::Answer],
    flight: &mut Flight,
    (tests, counts): (&mut TestCounts, &mut KernelCounts),
) {
    let arena = tree.arena.view();
    let Flight { slots, stacks, tops, stride } = flight;
    let (mut next, mut met) = (Next::NONE, [Met::default(); FLIGHT]);
    let mut found = [Found::default(); FLIGHT];
    for (index, slot) in slots.iter_mut().enumerate() {
        let bottom = index * *stride;
        let stack = &mut stacks[bottom..][..*stride];
        let Some((then, height)) = begin::<Q, P>(source, answers, stack, slot) else { break };
        tops[index] = bottom + height;
        next.push(arena, index, then);
    }
    // Each loop in this one is short, so that the processor has many rays at a time on their way
    // through it. Lists are read from the front while later steps are written there.
    while next.count() > 0 {
        counts.rounds += 1;
        counts.in_flight += next.count() as u64;
        // Nodes: which children are met,
        let nodes = next.take(Kind::Node);
        tests.nodes += nodes as u64;
        for (i, met) in met.iter_mut().enumerate().take(nodes) {
            let step = next.get(Kind::Node, i);
            let at = step.place();
            let Slot { ray, reach, .. } = &slots[step.slot()];
            let node = arena.node(at);
            let (near, mask) = node::children(simd, node, &ray.slab, ray.ray.t_min, *reach);
            met.entries = simd.entries(near, node::places(simd, node, at));
            met.mask = mask.to_bitmask() as u8;
        }
        // and where to go next.
        for (i, Met { entries, mask }) in met.iter().enumerate().take(nodes) {
            let index = next.get(Kind::Node, i).slot();
            let top = node::append::<S, Q>(simd, entries, *mask, stacks, tops[index]) - 1;
            tops[index] = top;
            next.push(arena, index, place(stacks[top]));
        }
        // Patches: which triangles are met,
        let patches = next.take_enough(Kind::Patch);
        for (i, found) in found.iter_mut().enumerate().take(patches) {
            let step = next.get(Kind::Patch, i);
            let ray = &slots[step.slot()].ray;
            let (hits, first) = leaf::patch::<S, P>(simd, arena, ray, step.place(), tests);
            *found = Found { hits, first };
        }
        // and what that means.
        for (i, Found { hits, first }) in found.iter().enumerate().take(patches) {
            let index = next.get(Kind::Patch, i).slot();
            let slot = &mut slots[index];
            if leaf::take::<Q, P>(arena, geometry, &slot.ray, (hits, *first), &mut slot.best) {
                tops[index] = slot.closer::<Q, P>(stacks, index * *stride, tops[index]);
            }
            tops[index] -= 1;
            next.push(arena, index, place(stacks[tops[index]]));
        }
        // Other leaves,
        for kind in [Kind::Soup, Kind::List] {
            for i in 0..next.take_enough(kind) {
                let step = next.get(kind, i);
                let (index, at) = (step.slot(), step.place());
                let slot = &mut slots[index];
                // and rays that are done.
                if at.bits() == BOTTOM {
                    answers[slot.number as usize] = Q::answer(slot.best);
                    let bottom = index * *stride;
                    let stack = &mut stacks[bottom..][..*stride];
                    if let Some((then, height)) = begin::<Q, P>(source, answers, stack, slot) {
                        tops[index] = bottom + height;
                        next.push(arena, index, then);
                    }
                    continue;
                }
                let Slot { ray, best, .. } = slot;
                if leaf::visit::<S, Q, P>(simd, arena, geometry, ray, at, best, tests) {
                    tops[index] = slot.closer::<Q, P>(stacks, index * *stride, tops[index]);
                }
                tops[index] -= 1;
                next.push(arena, index, place(stacks[tops[index]]));
            }
        }
    }
}

/// Fills the slot with the next ray of the source. Its first step, if there is one, and the height
/// of its stack without that.
#[inline(always)]
fn begin<Q: Query, P: Arithmetic>(
    source: &mut impl Source<Q, P>,
    answers: &mut [Q::Answer],
    stack: &mut [u64],
    slot: &mut Slot,
) -> Option<(Ref, usize)> {
    let (bottom, rest) = stack.split_first_mut()?;
    let height = source.next(answers, rest, slot)?;
    *bottom = entry(f32::NEG_INFINITY, BOTTOM);
    Some((place(stack[height]), height))
}

/// Removes the entries from `bottom` to `top` that are farther than `reach`. The top that is left.
#[inline(always)]
fn clear(stacks: &mut [u64], bottom: usize, top: usize, reach: f32) -> usize {
    let mut kept = bottom;
    for i in bottom..top {
        let entry = stacks[i];
        stacks[kept] = entry;
        kept += usize::from(distance(entry) <= reach);
    }
    kept
}
