//! Traversal by many rays in flight: the kernel for a wavefront's batch.
//!
//! A thread keeps [`FLIGHT`] rays in flight, each with its own stack. In each round every ray takes
//! one step and prefetches the memory of its next; the memory has arrived by its next turn. Steps
//! of a kind run in separate loops with few branches, so that the processor works on several rays
//! at any time; steps to leaves wait until there are enough for a loop. A finished ray is replaced
//! by the next one of the batch. The met children of a node are sorted and pushed as a vector, and
//! the next is popped. A stack is cleared of entries that are too far only when a hit is found, so
//! that no entry is checked twice.

mod next;
mod source;

use std::marker::PhantomData;

use bytemuck::Zeroable;
use glam::Vec3;

use super::arena::StandIn;
use super::{ArenaView, Best, Kind, Query, Ref, Searched, distance, leaf, node, place};
use crate::counters::{KernelCounts, TestCounts};
use crate::geometry::PreparedRay;
use crate::kernels::{Arithmetic, LaneHits};
use crate::math::{LANES, Lanes, Ray, entry};
use next::NextSteps;
use source::MOST_HANDED;
pub(super) use source::{HandedRays, RaySource};

/// Streams of rays in flight.
pub(super) const FLIGHT: usize = 64;

/// A ray in flight: two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(128))]
pub(super) struct Slot {
    pub(super) ray: PreparedRay,
    best: Best,
    /// Its number in the batch.
    number: u32,
    /// The instance in which it is searched, or [`NO_INSTANCE`].
    instance: u32,
    /// The last entry of its stack among those of all; the one before the bottom, if that is taken.
    last: u32,
    /// The next place.
    place: Ref,
}

const _: () = assert!(size_of::<Slot>() == 128);

/// The number of no instance.
const NO_INSTANCE: u32 = u32::MAX;

/// The bottom of a stack, which ends a ray, or its search in an instance. No list starts at unit 1: the
/// root is at unit 0, and is either everything or a node of two units.
const BOTTOM: u32 = 1 << 2 | Kind::List as u32;

/// The memory of a thread's rays in flight.
#[derive(Clone, Debug, Default)]
pub(super) struct Flight {
    /// One for each ray in flight, then one for each that is in an instance, as it was outside; none
    /// without a tree.
    slots: Vec<Slot>,
    /// The stacks, in sequence.
    stacks: Vec<u64>,
    /// Entries of one stack.
    stride: usize,
    /// What a round writes before it is read, one; kept between calls, as few rays would not pay for clearing it.
    rounds: Vec<RoundMemory>,
}

/// The memory of a round.
#[derive(Clone, Copy, Debug, Zeroable)]
#[repr(C, align(64))]
struct RoundMemory {
    /// For each step to a node entries of the children met, and a bit for each that is met.
    entries: [[u64; LANES]; FLIGHT],
    met: [u8; FLIGHT],
    next: NextSteps,
    /// What is found in patches, by slots.
    found: [(u32, LaneHits); FLIGHT],
}

impl Flight {
    /// Memory for rays in trees whose stacks take `entries` entries.
    pub(super) fn new(entries: usize) -> Self {
        // The bottom of the stack, and the places a packet hands over.
        let stride = entries + 1 + MOST_HANDED as usize;
        let ray = PreparedRay::new(&Ray::new(Vec3::ZERO, Vec3::X));
        let (best, place) = (Best::none(0.0), Ref::default());
        let empty = Slot { ray, best, number: 0, instance: NO_INSTANCE, last: 0, place };
        let (stacks, rounds) = (vec![0; stride * FLIGHT], vec![RoundMemory::zeroed()]);
        Self { slots: vec![empty; 2 * FLIGHT], stacks, stride, rounds }
    }
}

/// Answers all rays of `source`: with `INSTANCES`, rays go on in those that they reach; else all stay in one arena, as
/// for queries that leave instances out.
#[inline(always)]
pub(super) fn trace<S: Lanes, Q: Query, P: Arithmetic, const INSTANCES: bool>(
    simd: S,
    searched: &Searched<'_>,
    mut source: RaySource<'_>,
    answers: &mut [Q::Answer],
    flight: &mut Flight,
    (tests, kernel, query): (&mut TestCounts, &mut KernelCounts, &mut Q),
) {
    let Flight { slots, stacks, stride, rounds } = flight;
    let (Some((slots, outside)), Some(round)) = (slots.split_first_chunk_mut(), rounds.first_mut())
    else {
        return;
    };
    // There are no steps left from the call before.
    let RoundMemory { entries, met, next, found } = round;
    // Only references and no array, so that everything stays in registers.
    let mut rounds = FlightRounds::<Q, P, INSTANCES> {
        searched,
        arena: searched.arena,
        arenas: &mut [searched.arena; FLIGHT],
        source: &mut source,
        answers,
        slots,
        outside,
        stacks,
        stride: *stride,
        tests,
        query,
        next,
        precision: PhantomData,
    };
    for slot in 0..FLIGHT {
        if !rounds.begin(slot) {
            break;
        }
    }
    // The inner loops are short, so that the processor overlaps many rays.
    while rounds.next.count() > 0 {
        kernel.rays_a_round.add(rounds.next.count() as u64, 1);
        rounds.visit_nodes(simd, (entries, met));
        rounds.visit_patches(simd, found);
        rounds.visit_others(simd, Kind::Soup);
        rounds.visit_others(simd, Kind::List);
    }
}

/// Rays in flight, round by round. Lists of steps are read from the front while later steps are
/// written there.
struct FlightRounds<'a, 'b, Q: Query, P, const INSTANCES: bool> {
    searched: &'a Searched<'a>,
    arena: ArenaView<'a>,
    /// That of each ray among instances: the scene's or that of a prototype.
    arenas: &'a mut [ArenaView<'a>; FLIGHT],
    source: &'a mut RaySource<'b>,
    answers: &'a mut [Q::Answer],
    slots: &'a mut [Slot; FLIGHT],
    /// Of rays in instances, as they were outside.
    outside: &'a mut [Slot],
    /// The stacks of `stride` entries in sequence.
    stacks: &'a mut [u64],
    stride: usize,
    tests: &'a mut TestCounts,
    query: &'a mut Q,
    next: &'a mut NextSteps,
    precision: PhantomData<P>,
}

impl<'a, Q: Query, P: Arithmetic, const INSTANCES: bool> FlightRounds<'a, '_, Q, P, INSTANCES> {
    /// Fills a slot with the next ray of the source, and takes its first step. Returns whether
    /// there is one.
    #[inline(always)]
    fn begin(&mut self, index: usize) -> bool {
        let bottom = index * self.stride;
        let stack = &mut self.stacks[bottom..][..self.stride];
        let Some((end, rest)) = stack.split_first_mut() else { return false };
        let slot = &mut self.slots[index];
        let Some(height) = self.source.next::<Q, INSTANCES>(self.answers, rest, slot) else {
            return false;
        };
        *end = entry(f32::NEG_INFINITY, BOTTOM);
        if INSTANCES {
            self.arenas[index] = self.arena;
        }
        self.pop(index, bottom + height);
        true
    }

    /// Takes all steps to nodes: first tests the boxes of the children, then goes on.
    #[inline(always)]
    fn visit_nodes<S: Lanes>(
        &mut self,
        simd: S,
        (entries, met): (&mut [[u64; LANES]; FLIGHT], &mut [u8; FLIGHT]),
    ) {
        let nodes = self.next.take(Kind::Node);
        self.tests.nodes += nodes as u64;
        for i in 0..nodes {
            let index = self.next.get(Kind::Node, i);
            let Slot { ray, best, place, .. } = &self.slots[index];
            let node = self.arena(index).node(*place);
            let children = node::children(simd, node, ray, best.high);
            let places = node::places(simd, node, *place);
            (entries[i], met[i]) = node::entries::<S, Q>(simd, children, places);
        }
        for i in 0..nodes {
            let index = self.next.get(Kind::Node, i);
            let last = self.slots[index].last;
            // With the entry below, which comes next if no child is met.
            let from = last as usize;
            let Some(top) = self.stacks.get_mut(from..from + LANES + 1) else { continue };
            let count = node::push::<S, Q>(simd, (&entries[i], met[i]), &mut top[1..]);
            let next = place(top[count]);
            self.slots[index].last = (last + count as u32).wrapping_sub(1);
            self.step(index, next);
        }
    }

    /// Takes the steps to patches, if there are enough: first tests the triangles, then takes
    /// what is found; rays that meet nothing go on at once.
    #[inline(always)]
    fn visit_patches<S: Lanes>(&mut self, simd: S, found: &mut [(u32, LaneHits); FLIGHT]) {
        let patches = self.next.take_enough(Kind::Patch);
        self.tests.leaves += patches as u64;
        let mut count = 0;
        for i in 0..patches {
            let index = self.next.get(Kind::Patch, i);
            let Slot { ray, best, place, last, .. } = &self.slots[index];
            let ray = (&ray.ray, &ray.space);
            let arena = self.arena(index);
            let hits = leaf::test::<S, P>(simd, arena, ray, *place, best.high, self.tests);
            if hits.certain | hits.open == 0 {
                self.pop(index, *last as usize);
            } else {
                found[count] = (index as u32, hits);
                count += 1;
            }
        }
        for &(index, hits) in &found[..count] {
            let index = index as usize % FLIGHT;
            let mut prototype = None;
            let searched = self.searched_by(index, &mut prototype);
            let Slot { ray, best, number, place, .. } = &mut self.slots[index];
            let (ray, found) = ((&ray.ray, *number as usize), (*place, hits));
            let memory = (&mut *self.tests, &mut *self.query);
            let is_closer = leaf::take::<S, Q, P>(simd, searched, ray, found, best, memory);
            if is_closer && Q::NEAREST {
                // Wanted when the ray is done.
                let arena = self.arena(index);
                arena.prefetch_numbers(arena.patch(self.slots[index].place).head.first);
            }
            self.go_on(index, is_closer);
        }
    }

    /// Takes the steps to leaves of another kind, if there are enough. Finished rays are among
    /// those to lists.
    #[inline(always)]
    fn visit_others<S: Lanes>(&mut self, simd: S, kind: Kind) {
        for i in 0..self.next.take_enough(kind) {
            let index = self.next.get(kind, i);
            let at = self.slots[index].place;
            if at.bits() == BOTTOM {
                if INSTANCES
                    && self.slots[index].last.wrapping_add(1) as usize > index * self.stride
                {
                    self.leave(index);
                    continue;
                }
                let Slot { ray, best, number, .. } = &mut self.slots[index];
                let hit = best.answer(self.searched, &ray.ray, self.tests);
                self.answers[*number as usize] = Q::answer(hit);
                self.begin(index);
                continue;
            }
            let mut prototype = None;
            let searched = self.searched_by(index, &mut prototype);
            if let Some(root) = searched.chunk(at) {
                self.step(index, root);
                continue;
            }
            if INSTANCES && searched.instance(at).is_some() {
                self.enter(index, at);
                continue;
            }
            let Slot { ray, best, number, .. } = &mut self.slots[index];
            let memory = (&mut *self.tests, &mut *self.query);
            let ray = (&*ray, *number as usize);
            let is_closer = leaf::visit::<S, Q, P>(simd, searched, ray, at, best, memory);
            self.go_on(index, is_closer);
        }
    }

    /// Continues a ray after a leaf, in which it may have found a closer hit: its stack is then cleared
    /// of entries beyond, or of all if any hit suffices.
    #[inline(always)]
    fn go_on(&mut self, index: usize, is_closer: bool) {
        let Slot { ray, best, last, .. } = &self.slots[index];
        let mut last = *last as usize;
        if is_closer {
            let bottom = index * self.stride;
            let reach = ray.slab.reach(best.high);
            last = if Q::ANY { bottom } else { clear(self.stacks, bottom, last, reach) };
        }
        self.pop(index, last);
    }

    /// Takes the next place from a stack that ends with the entry `last`.
    #[inline(always)]
    fn pop(&mut self, index: usize, last: usize) {
        self.slots[index].last = (last as u32).wrapping_sub(1);
        self.step(index, place(self.stacks[last]));
    }

    /// Takes a ray to `place` in the next round, and prefetches that.
    #[inline(always)]
    fn step(&mut self, index: usize, place: Ref) {
        self.arena(index).prefetch(place);
        self.slots[index].place = place;
        self.next.push(place.kind(), index);
    }

    /// The arena in which the ray in a slot is.
    #[inline(always)]
    fn arena(&self, index: usize) -> ArenaView<'a> {
        if INSTANCES { self.arenas[index] } else { self.arena }
    }

    /// What the ray in a slot is searched in: the scene, or a prototype, which is then kept in `prototype`.
    #[inline(always)]
    fn searched_by<'b>(
        &self,
        index: usize,
        prototype: &'b mut Option<Searched<'a>>,
    ) -> &'b Searched<'a> {
        if !INSTANCES {
            return self.searched;
        }
        let instance = self.searched.geometry.instances.get(self.slots[index].instance as usize);
        match instance {
            Some(instance) => prototype.insert(self.searched.prototype(instance)),
            None => self.searched,
        }
    }

    /// Goes on in the prototype of the instance for which the list at `place` stands.
    #[inline(never)]
    fn enter(&mut self, index: usize, place: Ref) {
        self.tests.instances += 1;
        let slot = &mut self.slots[index];
        let Some(number) = self.arenas[index].stands_for(StandIn::Instance, place) else { return };
        let instance = &self.searched.geometry.instances[number];
        let carried = self.searched.carried(instance, &slot.ray.ray, &slot.best);
        let prototype = self.searched.prototype(instance);
        let Some((carried, root)) = carried.zip(prototype.root) else {
            self.go_on(index, false);
            return;
        };
        let inside = Slot {
            ray: prototype.prepare(&carried),
            best: Best::none(carried.t_max),
            instance: number as u32,
            last: slot.last + 1,
            ..*slot
        };
        self.stacks[slot.last as usize + 1] = entry(f32::NEG_INFINITY, BOTTOM);
        self.outside[index] = std::mem::replace(slot, inside);
        self.arenas[index] = prototype.arena;
        self.step(index, root.place);
    }

    /// Goes on outside of an instance.
    #[inline(never)]
    fn leave(&mut self, index: usize) {
        let inside = self.slots[index];
        // The stack may have lost entries below since.
        self.slots[index] = Slot { last: inside.last, ..self.outside[index] };
        self.arenas[index] = self.arena;
        let slot = &mut self.slots[index];
        let instance = &self.searched.geometry.instances[inside.instance as usize];
        let prototype = self.searched.prototype(instance);
        let hit = inside.best.answer(&prototype, &inside.ray.ray, self.tests);
        let before = (&slot.ray.ray, &mut slot.best);
        self.searched.offer::<P>(instance, hit, before, self.tests);
        self.go_on(index, false);
    }
}

/// Removes the entries from `bottom` to `last` that are farther than `reach`, but not the bottom. Returns
/// the last that is left.
#[inline(always)]
fn clear(stacks: &mut [u64], bottom: usize, last: usize, reach: f32) -> usize {
    let mut kept = bottom;
    for i in bottom + 1..=last {
        let entry = stacks[i];
        stacks[kept + 1] = entry;
        kept += usize::from(distance(entry) <= reach);
    }
    kept
}
