//! Traversal by packets: tiles of rays with nearly the same direction.
//!
//! A tile of [`TILE`] rays goes through the tree together. At a node one interval test over the
//! rays' origins and directions covers all eight children at once (Boulos, Wald and Shirley,
//! *Geometric and Arithmetic Culling Methods for Entire Ray Packets*, 2006). Children that the
//! whole tile misses cost nothing more, nor do those that it certainly meets as a whole. Other
//! children are tested for each ray, sixteen rays at a time ([`children`]), as are the triangles of
//! leaves that many rays meet ([`groups`]); in leaves that few rays meet, each ray is tested alone
//! with eight triangles ([`leaves`]). When at most [`FEW_RAYS`] of a tile visit a node, they are
//! handed over to the kernel of rays in flight ([`super::stream`]), with the place to continue
//! from. If tiles share little on average, the rest of the batch goes there at once.
//!
//! [`TILES_ON_THEIR_WAY`] tiles are traversed at a time, and their tests go through the same short
//! loops: the processor then has many independent tests and few branches to predict.
//!
//! All steps compute the same numbers as a single ray, so the answers have the same bits.
//!
//! The constants here and in [`super::stream`] were measured in
//! `benches/runs/2026-11-21-epyc-zen5`; they do not affect answers.

mod beam;
mod children;
mod groups;
mod leaves;
mod remaining;
mod spheres;
mod tile;

use std::marker::PhantomData;

use super::arena::Kind;
use super::geometry::PreparedRay;
use super::node::{distance, place};
use super::query::{Query, no_hit};
use super::rays::Rays;
use super::stream::{self, Flight, Found, FromRoot, MOST_HANDED};
use super::tree::{Root, Searched, Tree};
use super::{Counts, KernelChoice, TestCounts, single};
use crate::kernels::precision::Arithmetic;
use crate::math::simd::{Lanes, entry, outlined};
use beam::extent;
use children::Children;
use groups::{Groups, Open};
use leaves::SingleTest;
use remaining::{Handed, Remaining};
use tile::{Tile, number_of};

/// Tiles traversed together, so that one computes while another waits for memory.
const TILES_ON_THEIR_WAY: usize = 4;

/// Rays in a tile.
pub(super) const TILE: usize = 64;

/// This many rays at a node, or fewer, share nothing.
const FEW_RAYS: u32 = 1;

/// The same for any-hit queries.
const FEW_RAYS_FOR_ANY: u32 = 24;

/// A tile is coherent if at least this many rays on average visit its nodes.
const COHERENT: u64 = 20;

/// The memory of this many tiles is prefetched.
const AHEAD: usize = 3;

/// Tiles of a batch to traverse before judging the rest.
const TRIAL: usize = 2;

/// A place that rays of the tile still have to visit.
#[derive(Clone, Copy, Debug)]
struct Visit {
    /// As on the stack of a ray, with the least distance of all rays.
    entry: u64,
    rays: u64,
}

impl Visit {
    const NONE: Self = Self { entry: 0, rays: 0 };
}

/// Marks the first place of a ray.
const FIRST: u32 = u32::MAX;

/// The memory of a thread's packets.
#[derive(Clone, Debug, Default)]
pub(super) struct Packets {
    tiles: Vec<Tile>,
    groups: Groups,
    asks: Vec<Open>,
    handed: Vec<Handed>,
    /// For each ray of the batch its last place, and the number of places.
    last: Vec<(u32, u32)>,
    /// The rays handed over.
    queue: Vec<u32>,
    /// Rays tested alone in front of leaves, and their results.
    singles: Vec<SingleTest>,
    found: Vec<Found>,
}

/// A thread's memory for many rays.
pub(super) struct Memory<'a> {
    pub(super) packets: &'a mut Packets,
    pub(super) flight: &'a mut Flight,
    pub(super) stack: &'a mut [u64],
}

/// Answers all rays: by packets as long as `choice` says so, the others in flight.
#[inline(always)]
pub(super) fn trace<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    (rays, choice): (Rays<'_>, KernelChoice),
    answers: &mut [Q::Answer],
    Memory { packets, flight, stack }: Memory<'_>,
    counts: Counts<'_>,
) {
    let Some(root) = searched.tree.root() else {
        answers.fill(Q::NONE);
        counts.kernel.stream += rays.count() as u64;
        return;
    };
    packets.prepare(searched.tree, rays.count());
    let Packets { tiles, groups, asks, handed, last, queue, singles, found } = packets;
    let mut batch = Batch::<Q, P> {
        searched,
        rays,
        choice,
        root,
        next: 0,
        unfit: 0,
        judged: Judged::default(),
        handed,
        last,
        queue,
        groups,
        asks,
        children: Children::NONE,
        singles,
        found,
        stack,
        query: PhantomData,
    };
    batch.trace(simd, tiles, answers, counts.tests);
    let Batch { next, unfit, judged, .. } = batch;
    counts.kernel.packet += (next - unfit) as u64;
    counts.kernel.handed_over += (queue.len() - unfit) as u64;
    counts.kernel.stream += (rays.count() - next + unfit) as u64;
    counts.kernel.packet_nodes += judged.visits;
    counts.kernel.packet_rays += judged.rays;
    if !queue.is_empty() || next < rays.count() {
        let rest = FromRoot { rays, next, root };
        let mut source = Remaining { queue, handed, last, rays, rest };
        stream::trace::<S, Q, P>(simd, searched, &mut source, answers, flight, counts);
    }
}

impl Packets {
    /// Makes room for this many rays in the tree, and clears earlier rays.
    fn prepare(&mut self, tree: &Tree, rays: usize) {
        self.tiles.resize(TILES_ON_THEIR_WAY, Tile::EMPTY);
        for tile in &mut self.tiles {
            tile.visits.resize(tree.stack_entries(), Visit::NONE);
        }
        self.handed.clear();
        self.queue.clear();
        self.last.clear();
        self.last.resize(rays, (FIRST, 0));
    }
}

/// The coherence of a batch's tiles so far.
#[derive(Clone, Copy, Debug, Default)]
struct Judged {
    tiles: usize,
    visits: u64,
    rays: u64,
}

impl Judged {
    #[inline(always)]
    fn is_coherent(&self) -> bool {
        self.tiles < TRIAL || self.rays >= COHERENT * self.visits
    }
}

/// The tiles of a batch of rays.
struct Batch<'a, Q, P> {
    searched: Searched<'a>,
    rays: Rays<'a>,
    choice: KernelChoice,
    root: Root,
    /// The first ray not yet in a tile.
    next: usize,
    /// Rays of tiles unfit for packets.
    unfit: usize,
    judged: Judged,
    handed: &'a mut Vec<Handed>,
    last: &'a mut [(u32, u32)],
    queue: &'a mut Vec<u32>,
    groups: &'a mut Groups,
    asks: &'a mut Vec<Open>,
    children: Children,
    singles: &'a mut Vec<SingleTest>,
    found: &'a mut Vec<Found>,
    stack: &'a mut [u64],
    query: PhantomData<(Q, P)>,
}

impl<Q: Query, P: Arithmetic> Batch<'_, Q, P> {
    /// Traverses tiles as long as packets are to take them.
    #[inline(always)]
    fn trace<S: Lanes>(
        &mut self,
        simd: S,
        tiles: &mut [Tile],
        answers: &mut [Q::Answer],
        tests: &mut TestCounts,
    ) {
        self.rays.prefetch(0..(AHEAD * TILE).min(self.rays.count()));
        let mut count = 0;
        while count < TILES_ON_THEIR_WAY && self.begin(simd, &mut tiles[count], answers) {
            count += 1;
        }
        while count > 0 {
            let mut is_done = [false; TILES_ON_THEIR_WAY];
            for (k, is_done) in is_done.iter_mut().enumerate().take(count) {
                *is_done = !self.step(simd, tiles, k, tests);
            }
            self.children.visit::<S, Q>(simd, tiles, self.searched.tree.arena.view());
            self.visit_leaves(simd, tiles, tests);
            for k in (0..count).rev() {
                if is_done[k] {
                    let tile = &mut tiles[k];
                    tile.answer::<S, Q>(simd, answers);
                    if !self.begin(simd, tile, answers) {
                        count -= 1;
                        tiles.swap(k, count);
                    }
                }
            }
        }
    }

    /// Starts the next tile that can meet anything. Returns whether there is one.
    #[inline(always)]
    fn begin<S: Lanes>(&mut self, simd: S, tile: &mut Tile, answers: &mut [Q::Answer]) -> bool {
        outlined(
            simd,
            #[inline(always)]
            || {
                while self.choice.packs(self.rays.count() - self.next, self.judged.is_coherent()) {
                    let start = self.next;
                    let count = TILE.min(self.rays.count() - start);
                    self.next += count;
                    self.rays.prefetch(
                        self.next + (AHEAD - 1) * TILE
                            ..(self.next + AHEAD * TILE).min(self.rays.count()),
                    );
                    if !tile.load::<S, P>(simd, &self.rays, start..start + count) {
                        // These start at the root, like the rest.
                        answers[start..start + count].fill(Q::NONE);
                        self.unfit += count;
                        for number in start..start + count {
                            self.last[number] = (self.handed.len() as u32, 1);
                            let entry = entry(f32::NEG_INFINITY, self.root.place.bits());
                            self.handed.push(Handed { entry, before: FIRST });
                            self.queue.push(number as u32);
                        }
                    } else if tile.beam.meets(&self.root.bounds) {
                        self.judged.tiles += 1;
                        tile.prepare::<S, P>(simd);
                        let entry = entry(f32::NEG_INFINITY, self.root.place.bits());
                        tile.push(true, Visit { entry, rays: tile.all() });
                        return true;
                    } else {
                        self.judged.tiles += 1;
                        answers[start..start + count].fill(Q::NONE);
                    }
                }
                false
            },
        )
    }

    /// Advances a tile through leaves and one node. Returns whether anything may be left.
    #[inline(always)]
    fn step<S: Lanes>(
        &mut self,
        simd: S,
        tiles: &mut [Tile],
        k: usize,
        tests: &mut TestCounts,
    ) -> bool {
        let tile = &mut tiles[k];
        let arena = self.searched.tree.arena.view();
        // Not where hits are stored: vectors just written ray by ray are slow to reload.
        if tile.is_reach_stale && !Q::ANY {
            tile.is_reach_stale = false;
            tile.beam.reach = extent(simd, &tile.reach);
        }
        while self.children.has_room() {
            let Some(Visit { entry, rays }) = tile.pop() else { return false };
            let rays = rays & !tile.done;
            if rays == 0 || distance(entry) > tile.beam.reach[1] {
                continue;
            }
            let at = place(entry);
            let is_node = at.kind() == Kind::Node;
            let few = if Q::ANY { FEW_RAYS_FOR_ANY } else { FEW_RAYS };
            if is_node && rays.count_ones() <= few && at != self.root.place {
                self.hand_over(simd, tile, entry, rays, tests);
                continue;
            }
            if is_node {
                tests.nodes += 1;
                self.judged.visits += 1;
                self.judged.rays += u64::from(rays.count_ones());
                self.children.add::<S, Q>(simd, (tile, k), (arena.node(at), at), rays);
                return true;
            }
            let rays = if Q::ANY { rays } else { rays & tile.reaching(simd, distance(entry)) };
            if rays != 0 {
                self.children.add_leaf(at, k, rays);
            }
        }
        true
    }

    /// Hands `rays` over, to continue from `place`.
    #[inline(always)]
    fn hand_over<S: Lanes>(
        &mut self,
        simd: S,
        tile: &mut Tile,
        place: u64,
        rays: u64,
        tests: &mut TestCounts,
    ) {
        let mut rest = rays;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize & (TILE - 1);
            rest &= rest - 1;
            let number = tile.start + number_of(i);
            let (before, count) = self.last[number];
            if count as usize == MOST_HANDED {
                // Beyond that number the ray continues at once.
                self.go_on(simd, tile, place, i, tests);
                continue;
            }
            if count == 0 {
                self.queue.push(number as u32);
            }
            self.last[number] = (self.handed.len() as u32, count + 1);
            self.handed.push(Handed { entry: place, before });
        }
    }

    /// Traverses the subtree at `place` with the `i`th ray alone.
    #[inline(always)]
    fn go_on<S: Lanes>(
        &mut self,
        simd: S,
        tile: &mut Tile,
        place: u64,
        i: usize,
        tests: &mut TestCounts,
    ) {
        outlined(
            simd,
            #[inline(always)]
            || {
                let ray = PreparedRay::of::<P>(&self.rays.ray(tile.start + number_of(i)));
                let before = tile.best(i);
                let best = if before.is_miss() { no_hit(&ray.ray) } else { before };
                self.stack[0] = place;
                let (searched, stack) = (self.searched, (&mut *self.stack, 1));
                let best = single::trace::<S, Q, P>(simd, searched, &ray, best, stack, tests);
                if best.is_miss() {
                    return;
                }
                if Q::ANY {
                    tile.set_done(i);
                } else {
                    tile.set_best::<P>(i, best);
                    tile.is_reach_stale = true;
                }
            },
        )
    }
}

#[cfg(test)]
mod tests;
