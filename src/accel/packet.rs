//! Traversal by tiles of rays that go nearly the same way.
//!
//! A tile of [`TILE`] rays goes through the tree together. At a node one interval test, over the
//! range of the rays' origins and directions, looks at all eight children at once (Boulos, Wald and
//! Shirley, *Geometric and Arithmetic Culling Methods for Entire Ray Packets*, 2006); children that
//! the whole tile misses cost nothing more. Those that are left are tested by ray, sixteen rays at a
//! time, and so are the triangles of a leaf. Where only [`FEW`] rays of the tile are left, they have
//! nothing to share any more and are handed to the kernel of single rays in flight
//! ([`super::stream`]), with the place to go on from.
//!
//! All of it computes the numbers that one ray computes, so that the answers are the same bits.

mod leaves;
mod remaining;
mod tile;

use std::marker::PhantomData;

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, u32x8};

use super::arena::{Kind, Node, Ref, View, child_of};
use super::geometry::{Geometry, PreparedRay};
use super::node::{distance, place};
use super::stream::{self, Flight, FromRoot, Query, Rays};
use super::tree::{Root, Tree, reach};
use super::{Hit, KernelChoice, KernelCounts, NO_PRIMITIVE, TestCounts, single};
use crate::math::simd::{LANES, Lanes, entry};
use remaining::{Handed, Remaining};
use tile::{Beam, GROUPS, Met, Tile, WIDTH, index_of, load, number_of};

/// Rays in a tile.
pub(super) const TILE: usize = 64;

/// So many rays, or fewer, have nothing to share.
const FEW: u32 = 10;

/// The same, in a leaf.
const FEW_IN_LEAF: u32 = 3;

/// The most places that a ray is handed over with; beyond them it goes on at once.
pub(super) const MOST_HANDED: usize = 24;

/// A tile is coherent if its visits of nodes are made by so many rays on average.
const COHERENT: u64 = 8;

/// Tiles of a batch that are looked at before the rest is judged.
const TRIAL: usize = 2;

/// A place that rays of the tile have still to visit.
#[derive(Clone, Copy, Debug)]
struct Visit {
    /// As on the stack of a ray, with the least distance of all rays.
    entry: u64,
    rays: u64,
}

/// No place before.
const FIRST: u32 = u32::MAX;

/// The memory of a thread's packets.
#[derive(Clone, Debug, Default)]
pub(super) struct Packets {
    tile: Option<Box<Tile>>,
    visits: Vec<Visit>,
    handed: Vec<Handed>,
    /// For each ray of the batch the last of its places, and how many there are.
    last: Vec<(u32, u32)>,
    /// The rays that were handed over.
    queue: Vec<u32>,
}

/// Answers all rays: by packets as long as `choice` has it so, the others in flight.
#[inline(always)]
pub(super) fn trace<S: Lanes, Q: Query, R: Rays + ?Sized>(
    simd: S,
    tree: &Tree,
    geometry: &Geometry,
    (rays, choice): (&R, KernelChoice),
    answers: &mut [Q::Answer],
    (packets, flight, stack): (&mut Packets, &mut Flight, &mut [u64]),
    (tests, counts): (&mut TestCounts, &mut KernelCounts),
) {
    let Some(root) = tree.root() else {
        answers.fill(Q::NONE);
        counts.stream += rays.count() as u64;
        return;
    };
    let Packets { tile, visits, handed, last, queue } = packets;
    let tile = tile.get_or_insert_with(|| Box::new(Tile::EMPTY));
    handed.clear();
    queue.clear();
    last.clear();
    last.resize(rays.count(), (FIRST, 0));
    let (mut next, mut unfit, mut judged) = (0, 0, Judged::default());
    while choice.packs(rays.count() - next, judged.is_coherent()) {
        let count = TILE.min(rays.count() - next);
        let Some(beam) = tile.load(simd, rays, next..next + count) else {
            // These go from the root, as the rest will.
            answers[next..next + count].fill(Q::NONE);
            for (number, last) in last.iter_mut().enumerate().skip(next).take(count) {
                handed.push(Handed {
                    entry: entry(f32::NEG_INFINITY, root.place.bits()),
                    before: FIRST,
                });
                *last = (handed.len() as u32 - 1, 1);
                queue.push(number as u32);
            }
            (next, unfit) = (next + count, unfit + count);
            continue;
        };
        if !beam.meets(&root.bounds) {
            judged.tiles += 1;
            answers[next..next + count].fill(Q::NONE);
            next += count;
            continue;
        }
        tile.prepare(simd, beam.negative);
        let mut packet = Packet::<Q, R> {
            tree,
            geometry,
            rays,
            start: next,
            tile,
            beam,
            done: 0,
            handed,
            last,
            queue,
            stack,
            query: PhantomData,
        };
        let mut all = u64::MAX;
        for number in count..TILE {
            all &= !(1 << index_of(number));
        }
        packet.run(simd, root, all, visits, &mut judged, tests);
        packet.answer(answers, count);
        next += count;
    }
    counts.packet += (next - unfit) as u64;
    counts.handed_over += (queue.len() - unfit) as u64;
    counts.stream += (rays.count() - next + unfit) as u64;
    counts.packet_nodes += judged.visits;
    counts.packet_rays += judged.rays;
    let mut source = Remaining { queue, handed, last, rays, rest: FromRoot { rays, next, root } };
    stream::trace::<S, Q>(simd, tree, geometry, &mut source, answers, flight, (tests, counts));
}

/// How coherent the tiles of a batch were so far.
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

/// A tile on its way.
struct Packet<'a, Q, R: ?Sized> {
    tree: &'a Tree,
    geometry: &'a Geometry,
    rays: &'a R,
    /// The number of its first ray.
    start: usize,
    tile: &'a mut Tile,
    beam: Beam,
    /// Rays that have found what they look for.
    done: u64,
    handed: &'a mut Vec<Handed>,
    last: &'a mut [(u32, u32)],
    queue: &'a mut Vec<u32>,
    stack: &'a mut [u64],
    query: PhantomData<Q>,
}

impl<Q: Query, R: Rays + ?Sized> Packet<'_, Q, R> {
    /// Takes the rays of `all` through the tree.
    #[inline(always)]
    fn run<S: Lanes>(
        &mut self,
        simd: S,
        root: Root,
        all: u64,
        visits: &mut Vec<Visit>,
        judged: &mut Judged,
        tests: &mut TestCounts,
    ) {
        judged.tiles += 1;
        let arena = self.tree.arena.view();
        visits.clear();
        visits.push(Visit { entry: entry(f32::NEG_INFINITY, root.place.bits()), rays: all });
        while let Some(Visit { entry, rays }) = visits.pop() {
            let rays = rays & !self.done;
            if rays == 0 || distance(entry) > self.beam.reach[1] {
                continue;
            }
            let at = place(entry);
            let is_node = at.kind() == Kind::Node;
            let few = rays.count_ones() <= if is_node { FEW } else { FEW_IN_LEAF };
            if is_node && (!few || at == root.place) {
                tests.nodes += 1;
                judged.visits += 1;
                judged.rays += u64::from(rays.count_ones());
                self.visit_children(simd, arena, at, rays, visits);
            } else if few {
                self.hand_over(simd, entry, rays, tests);
            } else {
                self.visit_leaf(simd, arena, at, rays, tests);
            }
        }
    }

    /// Puts the children that any ray of `rays` meets on `visits`, the nearest last.
    #[inline(always)]
    fn visit_children<S: Lanes>(
        &self,
        simd: S,
        arena: View<'_>,
        at: Ref,
        rays: u64,
        visits: &mut Vec<Visit>,
    ) {
        let node = arena.node(at);
        let Met { near, some, all } = self.beam.children(simd, node);
        let lanes: u32x8<S> = [0, 1, 2, 3, 4, 5, 6, 7].simd_into(simd);
        let mut met = [0; LANES];
        simd.far_to_near(near, lanes, some, &mut met);
        let all = all.to_bitmask();
        for &child in &met[..some.to_bitmask().count_ones() as usize] {
            let lane = child as u32 as usize & (LANES - 1);
            let rays =
                if all >> lane & 1 == 1 { rays } else { self.rays_in(simd, node, lane, rays) };
            if rays != 0 {
                let at = child_of(node, at, lane);
                arena.prefetch(at);
                visits.push(Visit { entry: entry(distance(child), at.bits()), rays });
            }
        }
    }

    /// Which of `rays` meet the child.
    #[inline(always)]
    fn rays_in<S: Lanes>(&self, simd: S, node: &Node, lane: usize, rays: u64) -> u64 {
        let tile = &*self.tile;
        let [nx, ny, nz] = self.beam.negative;
        let [x, y, z] = &node.planes;
        let (x_first, x_last) = (x[usize::from(nx)][lane], x[usize::from(!nx)][lane]);
        let (y_first, y_last) = (y[usize::from(ny)][lane], y[usize::from(!ny)][lane]);
        let (z_first, z_last) = (z[usize::from(nz)][lane], z[usize::from(!nz)][lane]);
        let mut met = 0;
        for g in 0..GROUPS {
            if rays >> (g * WIDTH) & 0xFFFF == 0 {
                continue;
            }
            let rx = load(simd, &tile.reciprocal[0], g);
            let ry = load(simd, &tile.reciprocal[1], g);
            let rz = load(simd, &tile.reciprocal[2], g);
            let x0 = (f32x16::splat(simd, x_first) - load(simd, &tile.near_origin[0], g)) * rx;
            let y0 = (f32x16::splat(simd, y_first) - load(simd, &tile.near_origin[1], g)) * ry;
            let z0 = (f32x16::splat(simd, z_first) - load(simd, &tile.near_origin[2], g)) * rz;
            let x1 = (f32x16::splat(simd, x_last) - load(simd, &tile.far_origin[0], g)) * rx;
            let y1 = (f32x16::splat(simd, y_last) - load(simd, &tile.far_origin[1], g)) * ry;
            let z1 = (f32x16::splat(simd, z_last) - load(simd, &tile.far_origin[2], g)) * rz;
            let near = x0.max(y0).max(z0.max(load(simd, &tile.t_min, g)));
            let far = x1.min(y1).min(z1.min(load(simd, &tile.reach, g)));
            met |= near.simd_le(far).to_bitmask() << (g * WIDTH);
        }
        met & rays
    }

    #[inline(always)]
    fn set_done(&mut self, i: usize) {
        self.done |= 1 << i;
    }

    #[inline(always)]
    fn best(&self, i: usize) -> Hit {
        let (g, l) = (i / WIDTH, i % WIDTH);
        Hit { t: self.tile.best[g][l], primitive: self.tile.primitive[g][l] }
    }

    #[inline(always)]
    fn set_best(&mut self, i: usize, hit: Hit) {
        let (g, l) = (i / WIDTH, i % WIDTH);
        self.tile.best[g][l] = hit.t;
        self.tile.primitive[g][l] = hit.primitive;
        self.tile.reach[g][l] = reach(hit.t);
    }

    /// Hands `rays` over to go on from `place`.
    #[inline(always)]
    fn hand_over<S: Lanes>(&mut self, simd: S, place: u64, rays: u64, tests: &mut TestCounts) {
        let mut rest = rays;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize & (TILE - 1);
            rest &= rest - 1;
            let number = self.start + number_of(i);
            let (before, count) = self.last[number];
            if count as usize == MOST_HANDED {
                self.go_on(simd, place, i, tests);
                continue;
            }
            if count == 0 {
                self.queue.push(number as u32);
            }
            self.last[number] = (self.handed.len() as u32, count + 1);
            self.handed.push(Handed { entry: place, before });
        }
    }

    /// Takes the `i`th ray through what is at `place`, alone.
    #[inline(always)]
    fn go_on<S: Lanes>(&mut self, simd: S, place: u64, i: usize, tests: &mut TestCounts) {
        let ray = PreparedRay::new(&self.rays.ray(self.start + number_of(i)));
        let best = self.best(i);
        self.stack[0] = place;
        let stack = (&mut *self.stack, 1);
        if Q::ANY {
            if single::occluded(simd, self.tree, self.geometry, &ray, stack, tests) {
                self.set_done(i);
            }
        } else {
            let best = single::closest(simd, self.tree, self.geometry, &ray, best, stack, tests);
            self.set_best(i, best);
        }
    }

    /// Writes what is known of the first `count` rays.
    #[inline(always)]
    fn answer(&self, answers: &mut [Q::Answer], count: usize) {
        for (i, answer) in answers[self.start..self.start + count].iter_mut().enumerate() {
            let i = index_of(i);
            *answer = if Q::ANY {
                let primitive = if self.done >> i & 1 == 1 { 0 } else { NO_PRIMITIVE };
                Q::answer(Hit { t: 0.0, primitive })
            } else {
                Q::answer(self.best(i))
            };
        }
    }
}

#[cfg(test)]
mod tests;
