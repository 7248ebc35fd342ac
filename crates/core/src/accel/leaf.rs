//! Leaves: one ray against up to eight triangles at a time, or against the primitives of a list.

use super::TestCounts;
use super::arena::{Kind, Ref, View};
use super::best::Best;
use super::geometry::PreparedRay;
use super::query::{ANY_HIT, Query};
use super::tree::Searched;
use crate::kernels::precision::Arithmetic;
use crate::kernels::triangle::filter::{self, Range};
use crate::kernels::triangle::settle::Verdict;
use crate::kernels::triangle::{self, LaneHits, ShearedSpace, exact};
use crate::math::ray::Ray;
use crate::math::simd::{Lanes, outlined};
use crate::math::vector::Vector;

/// Searches the leaf for the hit of query `Q`: replaces `best` by a hit that comes first, or by
/// any. Returns whether it did.
#[inline(always)]
pub(super) fn visit<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    ray: &PreparedRay,
    place: Ref,
    best: &mut Best,
    tests: &mut TestCounts,
) -> bool {
    if place.kind() == Kind::List {
        return visit_list::<Q, P>(searched, &ray.ray, place, best, tests);
    }
    tests.leaves += 1;
    let arena = searched.tree.arena.view();
    let hits = test::<S, P>(simd, arena, (&ray.ray, &ray.space), place, best.high, tests);
    take::<S, Q, P>(simd, searched, &ray.ray, (place, hits), best, tests)
}

/// As [`visit`], for a list.
#[inline(never)]
fn visit_list<Q: Query, P: Arithmetic>(
    searched: Searched<'_>,
    ray: &Ray,
    place: Ref,
    best: &mut Best,
    tests: &mut TestCounts,
) -> bool {
    tests.leaves += 1;
    let mut is_closer = false;
    let numbers = searched.tree.arena.view().list(place);
    for (entry, &number) in numbers.iter().enumerate() {
        if Q::ANY && searched.geometry.is_light(number) {
            continue;
        }
        let Some(t) = searched.geometry.hit::<P>(number, ray, tests) else { continue };
        if Q::ANY {
            *best = Best::of(ANY_HIT);
            return true;
        }
        is_closer |= best.offer(searched, ray, Best::in_leaf(place, entry, [t, t]));
    }
    is_closer
}

/// The triangles of the leaf at `place` that the ray meets, or may meet, no farther than `reach`.
#[inline(always)]
pub(super) fn test<S: Lanes, P: Arithmetic>(
    simd: S,
    arena: View<'_>,
    (ray, space): (&Ray, &ShearedSpace),
    place: Ref,
    reach: f32,
    tests: &mut TestCounts,
) -> LaneHits {
    let range = (space, Range { t_min: ray.t_min, t_max: ray.t_max, reach });
    if place.kind() == Kind::Soup {
        let leaf = arena.soup(place);
        tests.count_triangles(leaf.count, leaf.quads, 1);
        if P::IS_REFERENCE {
            return LaneHits { open: first_lanes(leaf.count), ..LaneHits::default() };
        }
        let corners = (&leaf.corners, leaf.extent);
        return filter::soup::<S, P>(simd, range, corners, first_lanes(leaf.count));
    }
    let leaf = arena.patch(place);
    tests.count_triangles(leaf.count, leaf.quads, 1);
    if P::IS_REFERENCE {
        return LaneHits { open: first_lanes(leaf.count), ..LaneHits::default() };
    }
    let vertices = (&leaf.positions, leaf.corners, leaf.extent);
    filter::patch::<S, P>(simd, range, vertices, first_lanes(leaf.count))
}

/// A mask of the first `count` lanes.
#[inline(always)]
pub(super) fn first_lanes(count: u32) -> u32 {
    (1 << count) - 1
}

/// Replaces `best` by one of the `hits` that comes first, or by any. Returns whether there is one.
#[inline(always)]
pub(super) fn take<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    ray: &Ray,
    (place, mut hits): (Ref, LaneHits),
    best: &mut Best,
    tests: &mut TestCounts,
) -> bool {
    if Q::ANY && searched.without_lights(place, hits.certain) != 0 {
        *best = Best::of(ANY_HIT);
        return true;
    }
    if hits.open != 0 {
        let arena = searched.tree.arena.view();
        if P::IS_REFERENCE || hits.open.count_ones() <= FEW {
            settle_few(arena, ray, place, &mut hits, tests);
        } else {
            settle(simd, arena, ray, place, &mut hits, tests);
        }
        if Q::ANY && searched.without_lights(place, hits.certain) != 0 {
            *best = Best::of(ANY_HIT);
            return true;
        }
    }
    if Q::ANY {
        return false;
    }
    let mut is_closer = false;
    while hits.certain != 0 {
        let lane = hits.certain.trailing_zeros() as usize % 8;
        hits.certain &= hits.certain - 1;
        let new = Best::in_leaf(place, lane, [hits.low[lane], hits.high[lane]]);
        is_closer |= best.offer(searched, ray, new);
    }
    is_closer
}

/// Up to this many open triangles are settled one by one.
const FEW: u32 = 2;

/// Decides the open triangles one by one.
#[inline(never)]
fn settle_few(arena: View<'_>, ray: &Ray, place: Ref, hits: &mut LaneHits, tests: &mut TestCounts) {
    tests.settled += u64::from(hits.open.count_ones());
    while hits.open != 0 {
        let lane = hits.open.trailing_zeros() as usize % 8;
        hits.open &= hits.open - 1;
        let corners = arena.triangle(place, lane);
        let t = match triangle::settled(ray, &corners) {
            Verdict::Open => {
                tests.exact += 1;
                exact::meet(ray, &corners)
            }
            Verdict::Hit(t) => Some(t),
            Verdict::Miss => None,
        };
        if let Some(t) = t {
            (hits.low[lane], hits.high[lane]) = (t, t);
            hits.certain |= 1 << lane;
        }
    }
}

/// Decides all open triangles at once.
#[inline(always)]
fn settle<S: Lanes>(
    simd: S,
    arena: View<'_>,
    ray: &Ray,
    place: Ref,
    hits: &mut LaneHits,
    tests: &mut TestCounts,
) {
    outlined(
        simd,
        #[inline(always)]
        || {
            tests.settled += u64::from(hits.open.count_ones());
            let corners = if place.kind() == Kind::Soup {
                let [a, b, c] = &arena.soup(place).corners;
                [Vector::load(simd, a), Vector::load(simd, b), Vector::load(simd, c)]
            } else {
                let leaf = arena.patch(place);
                let [a, b, c] = filter::lanes_of(simd, leaf.corners);
                let [x, y, z] = &leaf.positions;
                let v = Vector::load(simd, &[*x, *y, *z]);
                [
                    Vector::new(simd.permute(v.x, a), simd.permute(v.y, a), simd.permute(v.z, a)),
                    Vector::new(simd.permute(v.x, b), simd.permute(v.y, b), simd.permute(v.z, b)),
                    Vector::new(simd.permute(v.x, c), simd.permute(v.y, c), simd.permute(v.z, c)),
                ]
            };
            hits.settle(simd, ray, &corners);
            if hits.open != 0 {
                decide_exactly(arena, ray, place, hits, tests);
            }
        },
    );
}

/// Decides what double precision leaves open.
#[cold]
#[inline(never)]
fn decide_exactly(
    arena: View<'_>,
    ray: &Ray,
    place: Ref,
    hits: &mut LaneHits,
    tests: &mut TestCounts,
) {
    tests.exact += u64::from(hits.open.count_ones());
    while hits.open != 0 {
        let lane = hits.open.trailing_zeros() as usize % 8;
        hits.open &= hits.open - 1;
        if let Some(t) = exact::meet(ray, &arena.triangle(place, lane)) {
            (hits.low[lane], hits.high[lane]) = (t, t);
            hits.certain |= 1 << lane;
        }
    }
}

impl Searched<'_> {
    /// The `triangles` of a leaf, a bit each, that do not belong to lights.
    #[inline(always)]
    pub(super) fn without_lights(&self, leaf: Ref, triangles: u32) -> u32 {
        if self.geometry.lights.is_empty() {
            return triangles;
        }
        let (mut kept, mut rest) = (triangles, triangles);
        while rest != 0 {
            let lane = rest.trailing_zeros();
            rest &= rest - 1;
            let number = self.tree.arena.view().number_of(leaf, lane as usize);
            kept &= !(u32::from(self.geometry.is_light(number)) << lane);
        }
        kept
    }
}
