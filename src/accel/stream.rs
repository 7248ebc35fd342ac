//! Traversal by many rays at a time: the kernel of a wavefront's batch.
//!
//! A thread keeps [`FLIGHT`] rays in flight, each with a stack of its own. In each round every ray
//! takes one step, through a node or a leaf, and asks for the memory of its next; by the time that
//! its turn comes again, the memory is there. A ray that is done makes place for the next one of
//! the batch. A step through a node has no branch that depends on the ray: the children met are
//! sorted and pushed as a vector, and the next is popped. So that no entry has to be looked at
//! twice, a stack is cleared of what is too far when a hit is found, and only then.

use std::ops::Range;

use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::Vec3;

use super::arena::{Kind, Ref, View, prefetch};
use super::geometry::{Geometry, PreparedRay};
use super::node::{self, distance, place};
use super::packet::MOST_HANDED;
use super::single::{no_hit, or_miss};
use super::tree::{Root, Tree, reach};
use super::{Hit, KernelCounts, TestCounts, leaf};
use crate::kernels::triangle::LaneHits;
use crate::math::ray::Ray;
use crate::math::simd::{LANES, Lanes, entry};

/// Rays in flight.
pub(super) const FLIGHT: usize = 64;
const ENOUGH: usize = 16;

/// Rays in a row.
pub trait Rays {
    /// How many.
    fn count(&self) -> usize;

    /// The `i`th.
    fn ray(&self, i: usize) -> Ray;

    /// Eight rays from the `i`th on, all of which there are.
    fn eight<S: Lanes>(&self, simd: S, i: usize) -> RayLanes<S>;

    /// Asks for the memory of the rays of `range`, if they may not be in a cache.
    #[inline(always)]
    fn prefetch(&self, _: Range<usize>) {}
}

/// Eight rays, a component each.
#[derive(Clone, Copy)]
pub struct RayLanes<S: Lanes> {
    /// Where they start.
    pub origin: [f32x8<S>; 3],
    /// Where they go.
    pub direction: [f32x8<S>; 3],
    /// The ranges of t.
    pub t_min: f32x8<S>,
    /// The ranges of t.
    pub t_max: f32x8<S>,
}

impl Rays for [Ray] {
    fn count(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn ray(&self, i: usize) -> Ray {
        self[i]
    }

    #[inline(always)]
    fn eight<S: Lanes>(&self, simd: S, i: usize) -> RayLanes<S> {
        let rows: &[[f32; LANES]] = bytemuck::cast_slice(&self[i..i + LANES]);
        let [a, b, c, d, e, f, g, h] = *rows.first_chunk().unwrap_or(&[[0.0; LANES]; LANES]);
        let (a, b): (f32x8<S>, f32x8<S>) = (a.simd_into(simd), b.simd_into(simd));
        let (c, d): (f32x8<S>, f32x8<S>) = (c.simd_into(simd), d.simd_into(simd));
        let (e, f): (f32x8<S>, f32x8<S>) = (e.simd_into(simd), f.simd_into(simd));
        let (g, h): (f32x8<S>, f32x8<S>) = (g.simd_into(simd), h.simd_into(simd));
        // Three perfect shuffles turn rows into columns.
        let (a, b, c, d, e, f, g, h) = shuffle(a, b, c, d, e, f, g, h);
        let (a, b, c, d, e, f, g, h) = shuffle(a, b, c, d, e, f, g, h);
        let (ox, oy, oz, t_min, dx, dy, dz, t_max) = shuffle(a, b, c, d, e, f, g, h);
        RayLanes { origin: [ox, oy, oz], direction: [dx, dy, dz], t_min, t_max }
    }

    #[inline(always)]
    fn prefetch(&self, range: Range<usize>) {
        for two in self.get(range).unwrap_or_default().chunks(2) {
            prefetch(two.as_ptr().cast());
        }
    }
}

/// Eight vectors.
type Eight<S> = (f32x8<S>, f32x8<S>, f32x8<S>, f32x8<S>, f32x8<S>, f32x8<S>, f32x8<S>, f32x8<S>);

/// Interleaves the first four with the last four.
#[inline(always)]
#[allow(clippy::too_many_arguments, clippy::many_single_char_names, reason = "a vector each")]
fn shuffle<S: Lanes>(
    a: f32x8<S>,
    b: f32x8<S>,
    c: f32x8<S>,
    d: f32x8<S>,
    e: f32x8<S>,
    f: f32x8<S>,
    g: f32x8<S>,
    h: f32x8<S>,
) -> Eight<S> {
    (
        a.zip_low(e),
        a.zip_high(e),
        b.zip_low(f),
        b.zip_high(f),
        c.zip_low(g),
        c.zip_high(g),
        d.zip_low(h),
        d.zip_high(h),
    )
}

/// A question about a ray.
pub(super) trait Query {
    /// The answer.
    type Answer: Copy;

    /// Whether one hit is as good as any.
    const ANY: bool;

    /// The answer for a ray that cannot be traced.
    const NONE: Self::Answer;

    /// The answer, once the ray is done.
    fn answer(best: Hit) -> Self::Answer;

    /// The hit to go on with where a packet has answered so far; `None` if that is the answer.
    fn resume(answer: Self::Answer, ray: &PreparedRay) -> Option<Hit>;
}

/// Which primitive is hit first.
pub(super) struct Closest;

impl Query for Closest {
    type Answer = Hit;
    const ANY: bool = false;
    const NONE: Hit = Hit::MISS;

    #[inline(always)]
    fn answer(best: Hit) -> Hit {
        or_miss(best)
    }

    #[inline(always)]
    fn resume(answer: Hit, ray: &PreparedRay) -> Option<Hit> {
        Some(if answer.is_miss() { no_hit(ray) } else { answer })
    }
}

/// Whether anything but a light's shape is hit.
pub(super) struct Occluded;

impl Query for Occluded {
    type Answer = bool;
    const ANY: bool = true;
    const NONE: bool = false;

    #[inline(always)]
    fn answer(best: Hit) -> bool {
        !best.is_miss()
    }

    #[inline(always)]
    fn resume(answer: bool, ray: &PreparedRay) -> Option<Hit> {
        if answer { None } else { Some(no_hit(ray)) }
    }
}

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
    pub(super) fn begin(&mut self, number: usize, best: Hit) {
        self.best = best;
        self.reach = reach(best.t);
        self.number = number as u32;
    }
}

/// A ray in flight, by its slot, and where it goes next.
#[derive(Clone, Copy, Debug)]
struct Step(u64);

impl Step {
    #[inline(always)]
    fn new(slot: usize, place: Ref) -> Self {
        Self(u64::from(place.bits()) << 32 | slot as u64)
    }

    #[inline(always)]
    fn slot(self) -> usize {
        self.0 as usize & (FLIGHT - 1)
    }

    #[inline(always)]
    fn place(self) -> Ref {
        Ref::from_bits((self.0 >> 32) as u32)
    }
}

/// The next steps of all rays in flight, by what they lead to.
#[derive(Clone, Copy, Debug)]
struct Next {
    steps: [[Step; FLIGHT]; 4],
    counts: [usize; 4],
}

impl Next {
    const NONE: Self = Self { steps: [[Step(0); FLIGHT]; 4], counts: [0; 4] };

    fn count(&self) -> usize {
        self.counts.iter().sum()
    }

    /// Adds the step of a ray, and asks for the memory of what it leads to. There is no branch,
    /// which nobody could foretell.
    #[inline(always)]
    fn push(&mut self, arena: View<'_>, slot: usize, then: Ref) {
        arena.prefetch(then);
        let kind = then.kind() as usize;
        let count = self.counts[kind];
        self.steps[kind][count & (FLIGHT - 1)] = Step::new(slot, then);
        self.counts[kind] = count + 1;
    }

    /// Takes all steps that lead to `kind` off the list, where they can be read until others are
    /// written there. How many.
    #[inline(always)]
    fn take(&mut self, kind: Kind) -> usize {
        std::mem::take(&mut self.counts[kind as usize]).min(FLIGHT)
    }

    /// As [`Next::take`] if there are enough of them, or none of the kinds before.
    #[inline(always)]
    fn take_enough(&mut self, kind: Kind) -> usize {
        let is_first = self.counts[..kind as usize].iter().all(|&count| count == 0);
        if is_first || self.counts[kind as usize] >= ENOUGH { self.take(kind) } else { 0 }
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

/// The bottom of a stack, where rays are done. Nothing else is there: the root would have to be a
/// list that begins at unit 0.
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
    /// Memory for rays in `tree`.
    pub(super) fn new(tree: &Tree) -> Self {
        // The end of the stack, and what a packet hands over.
        Self::of_stride(tree.stack_entries() + 1 + MOST_HANDED)
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
pub(super) trait Source<Q: Query> {
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
pub(super) struct FromRoot<'a, R: ?Sized> {
    pub(super) rays: &'a R,
    pub(super) next: usize,
    pub(super) root: Root,
}

impl<Q: Query, R: Rays + ?Sized> Source<Q> for FromRoot<'_, R> {
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
            slot.ray = PreparedRay::new(&ray);
            if !self.root.is_met(&slot.ray) {
                answers[number] = Q::NONE;
                continue;
            }
            stack[0] = entry(f32::NEG_INFINITY, self.root.place.bits());
            slot.begin(number, no_hit(&slot.ray));
            return Some(1);
        }
        None
    }
}

/// Answers all rays of `source`.
#[inline(always)]
pub(super) fn trace<S: Lanes, Q: Query>(
    simd: S,
    tree: &Tree,
    geometry: &Geometry,
    source: &mut impl Source<Q>,
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
        let Some((then, height)) = begin::<Q>(source, answers, stack, slot) else { break };
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
        for (step, met) in next.steps[Kind::Node as usize][..nodes].iter().zip(&mut met) {
            let at = step.place();
            let Slot { ray, reach, .. } = &slots[step.slot()];
            let node = arena.node(at);
            let (near, mask) = node::children(simd, node, &ray.slab, ray.ray.t_min, *reach);
            met.entries = simd.entries(near, node::places(simd, node, at));
            met.mask = mask.to_bitmask() as u8;
        }
        // and where to go next.
        for i in 0..nodes {
            let index = next.steps[Kind::Node as usize][i].slot();
            let Met { entries, mask } = &met[i];
            let top = if Q::ANY {
                node::append::<S, false>(simd, entries, *mask, stacks, tops[index])
            } else {
                node::append::<S, true>(simd, entries, *mask, stacks, tops[index])
            } - 1;
            tops[index] = top;
            next.push(arena, index, place(stacks[top]));
        }
        // Patches: which triangles are met,
        let patches = next.take_enough(Kind::Patch);
        for (step, found) in next.steps[Kind::Patch as usize][..patches].iter().zip(&mut found) {
            let ray = &slots[step.slot()].ray;
            let (hits, first) = leaf::patch(simd, arena, ray, step.place(), tests);
            *found = Found { hits, first };
        }
        // and what that means.
        for i in 0..patches {
            let index = next.steps[Kind::Patch as usize][i].slot();
            let slot = &mut slots[index];
            let hits = (&found[i].hits, found[i].first);
            if Q::ANY {
                if leaf::is_any(arena, geometry, &slot.ray, hits) {
                    slot.best.primitive = 0;
                    tops[index] = index * *stride + 1;
                }
            } else if leaf::is_closer(arena, geometry, &slot.ray, hits, &mut slot.best) {
                slot.reach = reach(slot.best.t);
                tops[index] = clear(stacks, index * *stride, tops[index], slot.reach);
            }
            tops[index] -= 1;
            next.push(arena, index, place(stacks[tops[index]]));
        }
        // Other leaves,
        for kind in [Kind::Soup, Kind::List] {
            for i in 0..next.take_enough(kind) {
                let step = next.steps[kind as usize][i];
                let (index, at) = (step.slot(), step.place());
                let slot = &mut slots[index];
                // and rays that are done.
                if at.bits() == BOTTOM {
                    answers[slot.number as usize] = Q::answer(slot.best);
                    let bottom = index * *stride;
                    let stack = &mut stacks[bottom..][..*stride];
                    if let Some((then, height)) = begin::<Q>(source, answers, stack, slot) {
                        tops[index] = bottom + height;
                        next.push(arena, index, then);
                    }
                    continue;
                }
                if Q::ANY {
                    if leaf::occluded(simd, arena, geometry, &slot.ray, at, tests) {
                        slot.best.primitive = 0;
                        tops[index] = index * *stride + 1;
                    }
                } else if leaf::closest(simd, arena, geometry, &slot.ray, at, &mut slot.best, tests)
                {
                    slot.reach = reach(slot.best.t);
                    tops[index] = clear(stacks, index * *stride, tops[index], slot.reach);
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
fn begin<Q: Query>(
    source: &mut impl Source<Q>,
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
