//! Leaves: up to eight triangles tested at a time.
//!
//! The answers are those of [`Searched::hit`], bit by bit: lanes compute the same, and triangles
//! that single precision does not decide go to [`Searched::hit`] itself.

use super::arena::{Kind, Patch, Ref, Soup, View};
use super::geometry::{Geometry, PreparedRay};
use super::query::{ANY_HIT, Query};
use super::tree::{Searched, reach};
use super::{Hit, TestCounts};
use crate::kernels::precision::{Arithmetic, Precision};
use crate::kernels::triangle::{LaneHits, ShearedSpace, fast};
use crate::math::ray::Ray;
use crate::math::simd::Lanes;

/// A mask of the first `count` lanes.
#[inline(always)]
fn first_lanes(count: u32) -> u32 {
    (1 << count) - 1
}

/// Searches the leaf for the hit of query `Q`: replaces `best` by a closer hit, or by any. Returns
/// whether it did.
#[inline(always)]
pub(super) fn visit<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    ray: &PreparedRay,
    place: Ref,
    best: &mut Hit,
    tests: &mut TestCounts,
) -> bool {
    let arena = searched.tree.arena.view();
    if let Some((hits, first)) = triangles::<S, Q, P>(simd, arena, ray, place, tests) {
        return take::<Q, P>(searched, ray, (&hits, first), best, tests);
    }
    let before = *best;
    let geometry = searched.geometry;
    for &number in arena.list(place) {
        let Some(t) = searched.hit::<P>(number, ray, tests) else { continue };
        if Q::ANY && !geometry.is_light(number) {
            *best = ANY_HIT;
            return true;
        }
        offer::<Q, P>(geometry, ray, best, Hit { t, primitive: number });
    }
    *best != before
}

/// As [`visit`], for the hits on triangles whose numbers start at `first`.
#[inline(always)]
pub(super) fn take<Q: Query, P: Arithmetic>(
    searched: Searched<'_>,
    ray: &PreparedRay,
    (hits, first): (&LaneHits, u32),
    best: &mut Hit,
    tests: &mut TestCounts,
) -> bool {
    let arena = searched.tree.arena.view();
    if Q::ANY {
        let found = is_any::<P>(searched, ray, (hits, first), tests);
        if found {
            *best = ANY_HIT;
        }
        return found;
    }
    let before = *best;
    let geometry = searched.geometry;
    let (mut certain, mut open) = (hits.certain, hits.open);
    while certain != 0 {
        let lane = certain.trailing_zeros() as usize & 7;
        certain &= certain - 1;
        // Read the number only if it matters: it is rarely in the cache.
        if hits.t[lane] <= reach::<P>(before.t) {
            let hit = Hit { t: hits.t[lane], primitive: arena.number(first, lane) };
            offer::<Q, P>(geometry, ray, best, hit);
        }
    }
    while open != 0 {
        let number = arena.number(first, open.trailing_zeros() as usize & 7);
        open &= open - 1;
        if let Some(t) = searched.hit_again::<P>(number, ray, tests) {
            offer::<Q, P>(geometry, ray, best, Hit { t, primitive: number });
        }
    }
    *best != before
}

/// Replaces `best` by a hit that comes before it. Any-hit queries ended before.
#[inline(always)]
fn offer<Q: Query, P: Arithmetic>(
    geometry: &Geometry,
    ray: &PreparedRay,
    best: &mut Hit,
    hit: Hit,
) {
    if !Q::ANY && geometry.comes_first::<P>(&hit, best, || ray.ray) {
        *best = hit;
    }
}

/// Whether there is a hit on a triangle that does not belong to a light; the numbers start at
/// `first`.
#[inline(always)]
fn is_any<P: Arithmetic>(
    searched: Searched<'_>,
    ray: &PreparedRay,
    (hits, first): (&LaneHits, u32),
    tests: &mut TestCounts,
) -> bool {
    if searched.without_lights(first, hits.certain) != 0 {
        return true;
    }
    let mut open = searched.without_lights(first, hits.open);
    while open != 0 {
        let number = searched.tree.arena.view().number(first, open.trailing_zeros() as usize & 7);
        open &= open - 1;
        if searched.hit_again::<P>(number, ray, tests).is_some() {
            return true;
        }
    }
    false
}

impl Searched<'_> {
    /// The `triangles` of a leaf, a bit each, that do not belong to lights; the numbers start at
    /// `first`.
    #[inline(always)]
    pub(super) fn without_lights(&self, first: u32, triangles: u32) -> u32 {
        let Self { tree, geometry, .. } = self;
        if geometry.lights.is_empty() {
            return triangles;
        }
        let (mut kept, mut rest) = (triangles, triangles);
        while rest != 0 {
            let lane = rest.trailing_zeros();
            rest &= rest - 1;
            let number = tree.arena.view().number(first, lane as usize & 7);
            kept &= !(u32::from(geometry.is_light(number)) << lane);
        }
        kept
    }
}

/// The results for the triangles in the leaf at `place`, and the start of their numbers; `None` for
/// a list.
#[inline(always)]
fn triangles<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    arena: View<'_>,
    ray: &PreparedRay,
    place: Ref,
    tests: &mut TestCounts,
) -> Option<(LaneHits, u32)> {
    match place.kind() {
        Kind::Patch => Some(patch::<S, Q, P>(simd, arena, ray, place, tests)),
        Kind::Soup => {
            let leaf = arena.soup(place);
            tests.leaves += 1;
            tests.count_triangles(leaf.count, leaf.quads, 1);
            Some((test_soup::<S, Q, P>(simd, leaf, &ray.ray, &ray.space), leaf.first))
        }
        Kind::List | Kind::Node => {
            tests.leaves += 1;
            None
        }
    }
}

/// As [`triangles`], for a patch.
#[inline(always)]
pub(super) fn patch<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    arena: View<'_>,
    ray: &PreparedRay,
    place: Ref,
    tests: &mut TestCounts,
) -> (LaneHits, u32) {
    let leaf = arena.patch(place);
    arena.prefetch_numbers(leaf.first);
    tests.leaves += 1;
    tests.count_triangles(leaf.count, leaf.quads, 1);
    (test_patch::<S, Q, P>(simd, leaf, &ray.ray, &ray.space), leaf.first)
}

/// Tests the triangles of a patch: fast tests use the ray itself, others its sheared space.
#[inline(always)]
pub(super) fn test_patch<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    leaf: &Patch,
    ray: &Ray,
    space: &ShearedSpace,
) -> LaneHits {
    let used = first_lanes(leaf.count);
    let (positions, corners) = (&leaf.positions, leaf.corners);
    match P::PRECISION {
        Precision::Fast => fast::intersect_patch(simd, ray, positions, corners, used),
        Precision::Exact if P::IS_REFERENCE => LaneHits::open(used),
        Precision::Exact => space.intersect_patch(simd, positions, corners, (used, Q::ANY)),
    }
}

/// As [`test_patch`], for a soup.
#[inline(always)]
pub(super) fn test_soup<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    leaf: &Soup,
    ray: &Ray,
    space: &ShearedSpace,
) -> LaneHits {
    let used = first_lanes(leaf.count);
    match P::PRECISION {
        Precision::Fast => fast::intersect_soup(simd, ray, &leaf.corners, used),
        Precision::Exact if P::IS_REFERENCE => LaneHits::open(used),
        Precision::Exact => space.intersect_soup(simd, &leaf.corners, (used, Q::ANY)),
    }
}
