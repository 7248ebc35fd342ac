//! Leaves: one ray against up to eight triangles at a time, or against the primitives of a list.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;

use super::arena::LeafHead;
use super::query::ANY_HIT;
use super::{ArenaView, Best, Kind, Query, Ref, Searched};
use crate::counters::TestCounts;
use crate::geometry::PreparedRay;
use crate::kernels::triangle::exact;
use crate::kernels::triangle::filter;
use crate::kernels::triangle::settle::Verdict;
use crate::kernels::{Arithmetic, LaneHits, ShearedSpace, triangle};
use crate::math::{LANES, Lanes, Ray, Vector, outlined, set_bits};

/// Searches the leaf for the hit of the query: replaces `best` by a hit that comes first, or by
/// any. Returns whether it did. A query for all gets what the ray with that number crosses there.
#[inline(always)]
pub(super) fn visit<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: &Searched<'_>,
    (ray, number): (&PreparedRay, usize),
    place: Ref,
    best: &mut Best,
    (tests, query): (&mut TestCounts, &mut Q),
) -> bool {
    tests.leaves += 1;
    if place.kind() == Kind::List {
        let ray = (&ray.ray, number);
        return visit_list::<Q, P>(searched, ray, place, best, (tests, query));
    }
    let arena = searched.arena;
    let hits = test::<S, P>(simd, arena, (&ray.ray, &ray.space), place, best.high, tests);
    let ray = (&ray.ray, number);
    take::<S, Q, P>(simd, searched, ray, (place, hits), best, (tests, query))
}

/// As [`visit`], for a list.
#[inline(never)]
fn visit_list<Q: Query, P: Arithmetic>(
    searched: &Searched<'_>,
    (ray, index): (&Ray, usize),
    place: Ref,
    best: &mut Best,
    (tests, query): (&mut TestCounts, &mut Q),
) -> bool {
    let mut is_closer = false;
    let numbers = searched.arena.list(place);
    for (entry, &number) in numbers.iter().enumerate() {
        if Q::ALL {
            let (ray, at) = ((ray, index), ((place, entry), number));
            cross_listed::<Q, P>(searched, ray, at, (tests, query));
            continue;
        }
        let Some(t) = searched.geometry.meet::<P>(number, ray, tests) else { continue };
        let new = Best::in_leaf(place, entry, [t, t]);
        if Q::ANY {
            if searched.behind_holes::<P>(ray, new, tests).is_some() {
                *best = Best::of(ANY_HIT);
                return true;
            }
        } else {
            is_closer |= best.offer::<P>(searched, ray, new, tests);
        }
    }
    is_closer
}

/// The triangles of the leaf at `place` that the ray meets, or may meet, no farther than `reach`.
#[inline(always)]
pub(super) fn test<S: Lanes, P: Arithmetic>(
    simd: S,
    arena: ArenaView<'_>,
    (ray, space): (&Ray, &ShearedSpace),
    place: Ref,
    reach: f32,
    tests: &mut TestCounts,
) -> LaneHits {
    if P::IS_REFERENCE {
        let open = begin(arena.head(place), tests);
        return LaneHits { open, ..LaneHits::default() };
    }
    let ray = (ray, space, reach);
    if place.kind() == Kind::Soup {
        let soup = arena.soup(place);
        let used = begin(&soup.head, tests);
        let corners = (bytemuck::cast_ref(soup), soup.head.extent);
        return filter::soup::<S, P>(simd, ray, corners, used);
    }
    let patch = arena.patch(place);
    let used = begin(&patch.head, tests);
    let vertices = (bytemuck::cast_ref(patch), patch.corners, patch.head.extent);
    filter::patch::<S, P>(simd, ray, vertices, used)
}

/// Counts the triangles of a leaf, and returns a mask of them.
#[inline(always)]
fn begin(&LeafHead { count, quads, .. }: &LeafHead, tests: &mut TestCounts) -> u32 {
    tests.primitives.count_triangles(count, quads, 1);
    first_lanes(count)
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
    searched: &Searched<'_>,
    (ray, number): (&Ray, usize),
    (place, mut hits): (Ref, LaneHits),
    best: &mut Best,
    (tests, query): (&mut TestCounts, &mut Q),
) -> bool {
    if Q::ALL {
        for lane in set_bits::<LANES>(hits.certain | hits.open) {
            let is_certain = hits.certain >> lane & 1 == 1;
            let at = ((place, lane), is_certain.then_some([hits.low[lane], hits.high[lane]]));
            cross::<Q, P>(searched, (ray, number), at, (tests, query));
        }
        return false;
    }
    if Q::ANY && take_any::<P>(searched, ray, (place, &mut hits), best, tests) {
        return true;
    }
    // Of hits that may be in holes, none tells which others are behind.
    if !Q::ANY && hits.certain.count_ones() > FEW && searched.geometry.cutouts.is_empty() {
        open_overlapping(best.high, &mut hits);
    }
    if hits.open != 0 {
        let arena = searched.arena;
        tests.settled += u64::from(hits.open.count_ones());
        if !P::IS_REFERENCE && hits.open.count_ones() > FEW {
            settle(simd, arena, ray, place, &mut hits);
        }
        settle_each(arena, ray, place, &mut hits, tests);
        if Q::ANY && take_any::<P>(searched, ray, (place, &mut hits), best, tests) {
            return true;
        }
    }
    if Q::ANY {
        return false;
    }
    let mut is_closer = false;
    for lane in set_bits::<LANES>(hits.certain) {
        let new = Best::in_leaf(place, lane, [hits.low[lane], hits.high[lane]]);
        is_closer |= best.offer::<P>(searched, ray, new, tests);
    }
    is_closer
}

/// Gives the query a triangle of a leaf that the ray with that number meets within these bounds of t, passing beside
/// every edge; or without bounds, that it may meet, if the ray crosses it.
#[inline(always)]
pub(super) fn cross<Q: Query, P: Arithmetic>(
    searched: &Searched<'_>,
    (ray, number): (&Ray, usize),
    ((place, entry), t): ((Ref, usize), Option<[f32; 2]>),
    (tests, query): (&mut TestCounts, &mut Q),
) {
    let t = t.or_else(|| {
        if Q::TAKES_OPEN {
            return Some([f32::NEG_INFINITY, f32::INFINITY]);
        }
        tests.settled += 1;
        let t = triangle::crossing(ray, &searched.arena.triangle(place, entry))?;
        Some([t, t])
    });
    let hit = t.map(|t| Best::in_leaf(place, entry, t));
    let hit = hit.and_then(|hit| match Q::TAKES_OPEN {
        true => Some(hit),
        false => searched.behind_holes::<P>(ray, hit, tests),
    });
    if let Some(hit) = hit {
        query.cross(number, hit);
    }
}

/// Gives the query every point at which the ray with that number crosses a primitive of a list.
#[inline(always)]
pub(super) fn cross_listed<Q: Query, P: Arithmetic>(
    searched: &Searched<'_>,
    (ray, number): (&Ray, usize),
    ((place, entry), primitive): ((Ref, usize), u32),
    (tests, query): (&mut TestCounts, &mut Q),
) {
    let at = |t: f32| query.cross(number, Best::in_leaf(place, entry, [t, t]));
    searched.geometry.cross::<P>(primitive, ray, tests).for_each(at);
}

/// Takes any of the certain hits, of which the others are removed. Returns whether there is one.
#[inline(always)]
fn take_any<P: Arithmetic>(
    searched: &Searched<'_>,
    ray: &Ray,
    (place, hits): (Ref, &mut LaneHits),
    best: &mut Best,
    tests: &mut TestCounts,
) -> bool {
    for lane in set_bits::<LANES>(std::mem::take(&mut hits.certain)) {
        let hit = Best::in_leaf(place, lane, [hits.low[lane], hits.high[lane]]);
        if searched.behind_holes::<P>(ray, hit, tests).is_some() {
            *best = Best::of(ANY_HIT);
            return true;
        }
    }
    false
}

/// Up to this many open triangles are settled one by one.
const FEW: u32 = 2;

/// Of hits whose intervals of t overlap, opens those with unknown t, and drops those behind: the t
/// of all are then found at once, instead of for each comparison. Nearly equal triangles at one place
/// depend on it.
#[inline(never)]
fn open_overlapping(reach: f32, hits: &mut LaneHits) {
    let ends = set_bits::<LANES>(hits.certain).map(|lane| hits.high[lane]);
    let reach = ends.fold(reach, f32::min);
    for lane in set_bits::<LANES>(hits.certain).filter(|&lane| hits.low[lane] > reach) {
        hits.certain &= !(1 << lane);
    }
    if hits.certain.count_ones() > FEW {
        let is_open = |&lane: &usize| hits.low[lane] < hits.high[lane];
        for lane in set_bits::<LANES>(hits.certain).filter(is_open) {
            hits.certain &= !(1 << lane);
            hits.open |= 1 << lane;
        }
    }
}

/// Decides the open triangles one by one.
#[inline(never)]
fn settle_each(
    arena: ArenaView<'_>,
    ray: &Ray,
    place: Ref,
    hits: &mut LaneHits,
    tests: &mut TestCounts,
) {
    for lane in set_bits::<LANES>(std::mem::take(&mut hits.open)) {
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

/// Decides the open triangles at once, as far as double precision can.
#[inline(always)]
fn settle<S: Lanes>(simd: S, arena: ArenaView<'_>, ray: &Ray, place: Ref, hits: &mut LaneHits) {
    outlined(
        simd,
        #[inline(always)]
        || {
            let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners(simd, arena, place, [0, 1, 2]);
            let corners =
                [Vector::new(ax, ay, az), Vector::new(bx, by, bz), Vector::new(cx, cy, cz)];
            hits.settle(simd, ray, &corners);
        },
    );
}

/// The corners of all triangles of the leaf, whose axes come in this `order`.
#[inline(always)]
pub(super) fn corners<S: Lanes>(
    simd: S,
    arena: ArenaView<'_>,
    place: Ref,
    [x, y, z]: [usize; 3],
) -> [[f32x8<S>; 3]; 3] {
    if place.kind() == Kind::Soup {
        let [a, b, c] = &arena.soup(place).corners;
        return [
            [a[x].simd_into(simd), a[y].simd_into(simd), a[z].simd_into(simd)],
            [b[x].simd_into(simd), b[y].simd_into(simd), b[z].simd_into(simd)],
            [c[x].simd_into(simd), c[y].simd_into(simd), c[z].simd_into(simd)],
        ];
    }
    let leaf = arena.patch(place);
    let [a, b, c] = filter::lanes_of(simd, leaf.corners);
    let x: f32x8<S> = leaf.positions[x].simd_into(simd);
    let y: f32x8<S> = leaf.positions[y].simd_into(simd);
    let z: f32x8<S> = leaf.positions[z].simd_into(simd);
    [
        [simd.permute(x, a), simd.permute(y, a), simd.permute(z, a)],
        [simd.permute(x, b), simd.permute(y, b), simd.permute(z, b)],
        [simd.permute(x, c), simd.permute(y, c), simd.permute(z, c)],
    ]
}

impl Searched<'_> {
    /// The `hit` of `ray`, or if that is in a hole of a cut-out, the next one on the same primitive.
    #[inline(always)]
    pub(super) fn behind_holes<P: Arithmetic>(
        &self,
        ray: &Ray,
        hit: Best,
        tests: &mut TestCounts,
    ) -> Option<Best> {
        if self.geometry.cutouts.is_empty() {
            return Some(hit);
        }
        let number = hit.number(self.arena);
        // Halves of quads in other leaves are tested each by itself.
        if Ref::from_bits(hit.leaf).kind() != Kind::List {
            let is_hole = self.geometry.is_hole::<P>(number, ray, hit.low, tests);
            return (!is_hole).then_some(hit);
        }
        let t = self.geometry.behind_holes::<P>(number, ray, hit.low, tests)?;
        Some(Best { low: t, high: t, ..hit })
    }
}
