//! Traversal by packets: tiles of rays with nearly the same direction.
//!
//! A tile of up to [`TILE`] rays, whose directions have one sign along each axis, goes through the
//! tree together ([`load`]). At a node one interval test over the rays' origins and directions
//! covers all eight children at once (Boulos, Wald and Shirley, *Geometric and Arithmetic Culling
//! Methods for Entire Ray Packets*, 2006). Children that the whole tile misses cost nothing more,
//! nor do those that it certainly meets as a whole. Other children are tested for each ray, sixteen
//! rays at a time. Leaves are tested in the same way ([`frame`]), or ray by ray if few rays meet
//! them. When few rays of a tile visit a node, they are handed over to the kernel of rays in flight
//! ([`super::stream`]), with the place to continue from. If tiles share little on average, or most
//! rays are in no tile, the rest of the batch goes there at once. Rays of a tile that meet an instance are a
//! batch in its prototype, or if they are few are handed over.
//!
//! Any-hit queries first try the leaf that ended the last tile: shadow rays often end at one wall.

mod beam;
mod columns;
mod frame;
mod instances;
mod leaves;
mod load;
mod nodes;
mod tile;

use super::query::ANY_HIT;
use super::stream::{self, HandedRays, RaySource};
use super::{
    Hit, KernelChoice, Kind, Query, Rays, Ref, Root, Search, Searched, Traversal, distance, place,
    single,
};
use crate::counters::TestCounts;
use crate::kernels::Arithmetic;
use crate::math::{Lanes, entry, outlined, set_bits};
use beam::Beam;
use columns::{GROUPS, TileColumn, WIDTH, load, number_of, numbers};
use load::FEWEST;
use tile::RayTile;

/// Tiles traversed in turn, step by step, so that one computes while another waits.
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
#[derive(Clone, Copy, Debug, Default)]
struct Visit {
    /// As on the stack of a ray, for closest hits with the least distance of all rays.
    entry: u64,
    rays: u64,
}

/// The memory of a thread's packets.
#[derive(Clone, Debug, Default)]
pub(super) struct Packets {
    tiles: Vec<RayTile>,
    handed: HandedRays,
}

/// Answers all rays: by packets as long as `choice` says so, the others in flight.
#[inline(always)]
pub(super) fn trace<S: Lanes, Q: Query, P: Arithmetic>(
    (simd, search): (S, Search<'_, P>),
    searched: &Searched<'_>,
    (rays, choice): (Rays<'_>, KernelChoice),
    answers: &mut [Q::Answer],
    query: &mut Q,
    traversal: &mut Traversal,
) {
    let Traversal { packets, flight, stack, inside, tests, kernels, .. } = traversal;
    let kernel = Q::counts(kernels);
    let Some(root) = searched.root else {
        answers.fill(Q::answer(Hit::MISS));
        kernel.stream += rays.count() as u64;
        return;
    };
    let Packets { tiles, handed } = packets;
    tiles.resize_with(TILES_ON_THEIR_WAY, RayTile::default);
    for tile in &mut *tiles {
        tile.visits.resize(searched.tree.stack_entries(), Visit::default());
    }
    handed.begin(rays.count());
    let mut batch = TileBatch::<S, Q, P> {
        simd,
        searched,
        rays,
        choice,
        root,
        next: 0,
        block: 0,
        left: 0,
        coherence: Coherence::default(),
        ending: None,
        handed,
        stack,
        inside,
        tests: &mut *tests,
        query: &mut *query,
        search,
    };
    batch.trace(tiles, answers);
    let TileBatch { next, coherence, .. } = batch;
    kernel.packet += coherence.fit;
    kernel.handed_over += handed.queue.len() as u64 - coherence.unfit;
    kernel.stream += rays.count() as u64 - coherence.fit;
    kernel.rays_a_node.add(coherence.rays, coherence.visits);
    if !handed.queue.is_empty() || next < rays.count() {
        let source = RaySource { rays, handed, next, searched, root };
        let memory = (tests, kernel, query);
        // Each in a function of its own, which keeps what it needs in registers.
        if Q::ALL || searched.blas.is_empty() {
            outlined(
                simd,
                #[inline(always)]
                || stream::trace::<S, Q, P, false>(simd, searched, source, answers, flight, memory),
            );
        } else {
            outlined(
                simd,
                #[inline(always)]
                || stream::trace::<S, Q, P, true>(simd, searched, source, answers, flight, memory),
            );
        }
    }
}

/// The coherence of a batch's tiles so far.
#[derive(Clone, Copy, Debug, Default)]
struct Coherence {
    tiles: usize,
    visits: u64,
    /// The sum of the rays at each visit.
    rays: u64,
    /// Rays of tiles, and rays that are unfit for packets.
    fit: u64,
    unfit: u64,
}

impl Coherence {
    #[inline(always)]
    fn is_coherent(&self) -> bool {
        self.tiles < TRIAL || self.rays >= COHERENT * self.visits && self.unfit <= self.fit
    }
}

/// The tiles of a batch of rays.
struct TileBatch<'a, S, Q, P> {
    simd: S,
    searched: &'a Searched<'a>,
    rays: Rays<'a>,
    choice: KernelChoice,
    root: Root,
    /// The first ray of the next block.
    next: usize,
    /// The first ray of this block, and the rays that no tile has taken yet, a bit each.
    block: usize,
    left: u64,
    coherence: Coherence,
    /// The leaf that ended the last tile, for any-hit queries.
    ending: Option<Ref>,
    handed: &'a mut HandedRays,
    stack: &'a mut [u64],
    /// For searches in prototypes.
    inside: &'a mut Option<Box<Traversal>>,
    tests: &'a mut TestCounts,
    query: &'a mut Q,
    search: Search<'a, P>,
}

impl<S: Lanes, Q: Query, P: Arithmetic> TileBatch<'_, S, Q, P> {
    /// Traverses tiles as long as packets are to take them.
    #[inline(always)]
    fn trace(&mut self, tiles: &mut [RayTile], answers: &mut [Q::Answer]) {
        self.rays.prefetch(0..(AHEAD * TILE).min(self.rays.count()));
        let mut count = 0;
        while count < tiles.len() && self.begin(&mut tiles[count], answers) {
            count += 1;
        }
        while count > 0 {
            let mut k = 0;
            while k < count {
                let tile = &mut tiles[k];
                if self.step(tile) {
                    k += 1;
                    continue;
                }
                self.settle(tile);
                tile.answer::<S, Q>(self.simd, self.searched, answers, self.tests);
                if self.begin(tile, answers) {
                    k += 1;
                } else {
                    count -= 1;
                    tiles.swap(k, count);
                }
            }
        }
    }

    /// Starts the next tile that can meet anything. Returns whether there is one.
    #[inline(always)]
    fn begin(&mut self, tile: &mut RayTile, answers: &mut [Q::Answer]) -> bool {
        outlined(
            self.simd,
            #[inline(always)]
            || {
                while self.left != 0 || self.next_block() {
                    let (rays, is_fit) = tile.load(self.simd, &self.rays, self.block, self.left);
                    self.left &= !rays;
                    self.coherence.tiles += 1;
                    let root = entry(f32::NEG_INFINITY, self.root.place.bits());
                    let asked = self.asked(rays, answers);
                    if !(is_fit && self.is_near(tile)) {
                        // These are left to the other kernel.
                        self.coherence.unfit += u64::from(asked.count_ones());
                        for number in numbers(self.block, asked) {
                            self.handed.add(number, root);
                        }
                        tile.miss::<Q>(rays, answers);
                        continue;
                    }
                    self.coherence.fit += u64::from(rays.count_ones());
                    if self.ends_as_before(tile) {
                        tile.fill(rays, answers, Q::answer(ANY_HIT));
                    } else if asked != 0 && tile.beam.meets(&self.root.bounds) {
                        tile.prepare(self.simd);
                        tile.clear();
                        tile.push(true, Visit { entry: root, rays: asked });
                        return true;
                    } else {
                        tile.miss::<Q>(rays, answers);
                    }
                }
                false
            },
        )
    }

    /// Those of `rays`, a bit each, that are not to be left out.
    #[inline(always)]
    fn asked(&self, rays: u64, answers: &[Q::Answer]) -> u64 {
        let is_asked = |i: usize| Q::go_on(answers[self.block + number_of(i)]).is_some();
        if !Q::ALL {
            return rays;
        }
        set_bits::<TILE>(rays).fold(0, |asked, i| asked | u64::from(is_asked(i)) << i)
    }

    /// Whether the boxes of instances are wide enough for the rays of the tile.
    #[inline(always)]
    fn is_near(&self, tile: &RayTile) -> bool {
        let Searched { tree, blas, .. } = self.searched;
        let mut origins = tile.beam.origin.as_flattened().iter();
        blas.is_empty() || origins.all(|x| x.abs() <= tree.near)
    }

    /// Goes on to the next block of rays, if packets are to take it.
    #[inline(always)]
    fn next_block(&mut self) -> bool {
        let count = self.rays.count() - self.next;
        if !self.choice.packs(count, self.coherence.is_coherent()) {
            return false;
        }
        (self.block, self.left) = (self.next, columns::first(count));
        self.next += count.min(TILE);
        let ahead = self.next + (AHEAD - 1) * TILE;
        self.rays.prefetch(ahead..(ahead + TILE).min(self.rays.count()));
        true
    }

    /// Whether all rays of the tile are done at the leaf that ended the last tile.
    #[inline(always)]
    fn ends_as_before(&mut self, tile: &mut RayTile) -> bool {
        let Some(place) = self.ending.filter(|_| Q::ANY) else { return false };
        tile.clear();
        self.visit_leaf(tile, place, tile.rays);
        self.settle(tile);
        if !tile.is_done() {
            self.ending = None;
        }
        tile.is_done()
    }

    /// Takes a tile through leaves and one node. Returns whether anything may be left.
    #[inline(always)]
    fn step(&mut self, tile: &mut RayTile) -> bool {
        while let Some(Visit { entry, mut rays }) = tile.pop() {
            let at = place(entry);
            rays &= !tile.done;
            if rays == 0 || distance(entry) > tile.beam.farthest() {
                continue;
            }
            if at.kind() == Kind::Node {
                if self.visit_node(tile, entry, rays) {
                    return true;
                }
                continue;
            }
            if Q::NEAREST {
                rays &= tile.reaching(self.simd, distance(entry));
            }
            if rays == 0 || self.visit_stand_in(tile, entry, rays) {
                continue;
            }
            self.visit_leaf(tile, at, rays);
            if Q::ANY && tile.is_done() {
                self.ending = Some(at);
                return false;
            }
        }
        false
    }

    /// Takes `rays` to the children of a node, or hands them over if they are few. Returns whether it took them.
    #[inline(always)]
    fn visit_node(&mut self, tile: &mut RayTile, entry: u64, rays: u64) -> bool {
        let at = place(entry);
        let few = if Q::NEAREST { FEW_RAYS } else { FEW_RAYS_FOR_ANY };
        if rays.count_ones() <= few && at != self.root.place {
            self.hand_over(tile, entry, rays);
            return false;
        }
        self.tests.nodes += 1;
        self.coherence.visits += 1;
        self.coherence.rays += u64::from(rays.count_ones());
        nodes::visit::<S, Q>(self.simd, tile, self.searched.arena, at, rays);
        true
    }

    /// Takes `rays` to the chunk or the instance for which a list stands. Returns whether it stands for one.
    #[inline(always)]
    fn visit_stand_in(&mut self, tile: &mut RayTile, list: u64, rays: u64) -> bool {
        if let Some(root) = self.searched.chunk(place(list)) {
            let entry = entry(distance(list), root.bits());
            tile.push(true, Visit { entry, rays });
            return true;
        }
        let Some(instance) = self.searched.instance(place(list)) else { return false };
        match rays.count_ones() {
            _ if Q::ALL => {}
            0..FEWEST => self.hand_over(tile, list, rays),
            _ => self.visit_instance(tile, instance, rays),
        }
        true
    }

    /// Hands `rays` over, to continue from `place`.
    #[inline(always)]
    fn hand_over(&mut self, tile: &mut RayTile, place: u64, rays: u64) {
        tile.is_left = true;
        let Self { simd, searched, .. } = *self;
        for i in set_bits::<TILE>(rays) {
            let number = tile.block + number_of(i);
            if self.handed.add(number, place) {
                continue;
            }
            // Beyond a number of places the ray traverses the subtree at once, alone.
            outlined(
                simd,
                #[inline(always)]
                || {
                    let ray = (&searched.prepare(&tile.ray(i)), number);
                    let before = tile.best(i);
                    let stack = (&mut *self.stack, place);
                    let memory = (&mut *self.tests, &mut *self.query);
                    let best =
                        single::trace::<S, Q, P, true>(simd, searched, ray, before, stack, memory);
                    if best == before {
                        return;
                    }
                    if Q::ANY {
                        tile.done |= 1 << i;
                    } else {
                        tile.set_best(i, best);
                        tile.tighten(simd);
                    }
                },
            );
        }
    }
}
