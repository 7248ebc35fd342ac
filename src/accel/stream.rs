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

use super::arena::{Kind, Ref, prefetch};
use super::geometry::{Geometry, PreparedRay};
use super::node::{self, distance, place};
use super::packet::MOST_HANDED;
use super::single::{no_hit, or_miss};
use super::tree::{Root, Tree, reach};
use super::{Hit, KernelCounts, TestCounts, leaf};
use crate::math::ray::Ray;
use crate::math::simd::{LANES, Lanes, entry};

/// Rays in flight.
pub(super) const FLIGHT: usize = 32;

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
struct Slot {
    ray: PreparedRay,
    best: Hit,
    reach: f32,
    /// Its number in the batch.
    number: u32,
    /// Height of its stack.
    height: usize,
}

/// A ray in flight and where it goes next.
#[derive(Clone, Copy, Debug, Default)]
struct Step {
    slot: u32,
    place: u32,
}

/// The end of a stack: no place, since it is no node.
const DONE: u32 = u32::MAX;

/// The memory of a thread's rays in flight.
#[derive(Clone, Debug, Default)]
pub(super) struct Flight {
    slots: Vec<Slot>,
    stacks: Vec<u64>,
    /// Entries of one stack.
    stride: usize,
}

impl Flight {
    /// Memory for rays in `tree`.
    pub(super) fn new(tree: &Tree) -> Self {
        // The end of the stack, and what a packet hands over.
        let stride = tree.stack_entries() + 1 + MOST_HANDED;
        Self { slots: Vec::with_capacity(FLIGHT), stacks: vec![0; stride * FLIGHT], stride }
    }
}

/// Where rays come from.
pub(super) trait Source<Q: Query> {
    /// The next ray that has to be traced, with the entries to begin with put on `stack`; rays that
    /// need not be traced are answered on the way.
    fn next(&mut self, answers: &mut [Q::Answer], stack: &mut [u64]) -> Option<Begun>;
}

/// A ray at its beginning.
pub(super) struct Begun {
    pub(super) ray: PreparedRay,
    /// The closest hit known.
    pub(super) best: Hit,
    /// Its number in the batch.
    pub(super) number: usize,
    /// How many entries there are to begin with.
    pub(super) entries: usize,
}

/// Rays of a batch from `next` on, each from the root.
pub(super) struct FromRoot<'a, R: ?Sized> {
    pub(super) rays: &'a R,
    pub(super) next: usize,
    pub(super) root: Root,
}

impl<Q: Query, R: Rays + ?Sized> Source<Q> for FromRoot<'_, R> {
    #[inline(always)]
    fn next(&mut self, answers: &mut [Q::Answer], stack: &mut [u64]) -> Option<Begun> {
        while self.next < self.rays.count() {
            let number = self.next;
            self.next += 1;
            let ray = self.rays.ray(number);
            if !ray.is_valid() {
                answers[number] = Q::NONE;
                continue;
            }
            let ray = PreparedRay::new(&ray);
            if !self.root.is_met(&ray) {
                answers[number] = Q::NONE;
                continue;
            }
            stack[0] = entry(f32::NEG_INFINITY, self.root.place.bits());
            let best = no_hit(&ray);
            return Some(Begun { ray, best, number, entries: 1 });
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
    let Flight { slots, stacks, stride } = flight;
    let stride = *stride;
    // Steps of this round; those through nodes become those of the next.
    let (mut nodes, mut leaves) = ([Step::default(); FLIGHT], [Step::default(); FLIGHT]);
    let (mut node_count, mut leaf_count) = (0, 0);
    slots.clear();
    while slots.len() < FLIGHT {
        let stack = &mut stacks[slots.len() * stride..][..stride];
        let Some((slot, then)) = begin::<Q>(source, answers, stack) else { break };
        let step = Step { slot: slots.len() as u32, place: then.bits() };
        slots.push(slot);
        if then.kind() == Kind::Node {
            nodes[node_count] = step;
            node_count += 1;
        } else {
            leaves[leaf_count] = step;
            leaf_count += 1;
        }
    }
    let mut waiting = [Step::default(); FLIGHT];
    while node_count + leaf_count > 0 {
        // Nodes. Steps are taken from the front of the list while the next are written there.
        let mut kept = 0;
        tests.nodes += node_count as u64;
        counts.rounds += 1;
        counts.in_flight += (node_count + leaf_count) as u64;
        for i in 0..node_count {
            let Step { slot: index, place: at } = nodes[i];
            let at = Ref::from_bits(at);
            let slot = &mut slots[index as usize];
            let stack = &mut stacks[index as usize * stride..][..stride];
            let range = [slot.ray.ray.t_min, slot.reach];
            let node = arena.node(at);
            let (entry, height) = if Q::ANY {
                node::step::<S, false>(simd, node, at, &slot.ray.slab, range, stack, slot.height)
            } else {
                node::step::<S, true>(simd, node, at, &slot.ray.slab, range, stack, slot.height)
            };
            slot.height = height;
            let then = place(entry);
            arena.prefetch(then);
            let step = Step { slot: index, place: then.bits() };
            let is_node = then.kind() == Kind::Node;
            nodes[kept] = step;
            kept += usize::from(is_node);
            leaves[leaf_count & (FLIGHT - 1)] = step;
            leaf_count += usize::from(!is_node);
        }
        node_count = kept;
        // Leaves, and rays that are done.
        let steps = leaf_count;
        waiting[..steps].copy_from_slice(&leaves[..steps]);
        leaf_count = 0;
        for &Step { slot: index, place: at } in &waiting[..steps] {
            let slot = &mut slots[index as usize];
            let stack = &mut stacks[index as usize * stride..][..stride];
            let mut done = at == DONE;
            if !done {
                let at = Ref::from_bits(at);
                if Q::ANY {
                    done = leaf::occluded(simd, arena, geometry, &slot.ray, at, tests);
                    if done {
                        slot.best.primitive = 0;
                    }
                } else if leaf::closest(simd, arena, geometry, &slot.ray, at, &mut slot.best, tests)
                {
                    slot.reach = reach(slot.best.t);
                    slot.height = clear(stack, slot.height, slot.reach);
                }
            }
            let then = if done {
                answers[slot.number as usize] = Q::answer(slot.best);
                let Some((fresh, then)) = begin::<Q>(source, answers, stack) else { continue };
                *slot = fresh;
                then
            } else {
                slot.height -= 1;
                place(stack[slot.height])
            };
            arena.prefetch(then);
            let step = Step { slot: index, place: then.bits() };
            if then.kind() == Kind::Node {
                nodes[node_count] = step;
                node_count += 1;
            } else {
                leaves[leaf_count] = step;
                leaf_count += 1;
            }
        }
    }
}

/// The next ray of the source, and its first step.
#[inline(always)]
fn begin<Q: Query>(
    source: &mut impl Source<Q>,
    answers: &mut [Q::Answer],
    stack: &mut [u64],
) -> Option<(Slot, Ref)> {
    let (bottom, rest) = stack.split_first_mut()?;
    let Begun { ray, best, number, entries } = source.next(answers, rest)?;
    *bottom = entry(f32::NEG_INFINITY, DONE);
    let slot = Slot { ray, best, reach: reach(best.t), number: number as u32, height: entries };
    Some((slot, place(stack[entries])))
}

/// Removes the entries that are farther than `reach`. The height that is left.
#[inline(always)]
fn clear(stack: &mut [u64], height: usize, reach: f32) -> usize {
    let mut kept = 0;
    for i in 0..height {
        let entry = stack[i];
        stack[kept] = entry;
        kept += usize::from(distance(entry) <= reach);
    }
    kept
}
