//! Traversal that ends at no hit: every leaf whose box a ray meets is visited, and every triangle that it
//! crosses is kept. Rays are traced one by one, but many in a call.

use super::{Best, Hit, Kind, Occluded, Rays, Ref, Root, Searched, Traversal, leaf, node, place};
use crate::counters::TestCounts;
use crate::geometry::{Geometry, Primitive};
use crate::kernels::{Arithmetic, ShearedSpace, SlabRay, quad, triangle};
use crate::math::float::{max, min};
use crate::math::{LANES, Lanes, Ray, entry, set_bits};

/// The rays whose crossings are asked for, and which of these count.
#[derive(Clone, Copy)]
pub(super) struct CrossingQuery<'a> {
    pub(super) rays: Rays<'a>,
    /// The number of the first.
    pub(super) first: usize,
    /// Which of all rays to leave out.
    pub(super) occluded: &'a [bool],
    /// Whether only transparent primitives count.
    pub(super) only_transparent: bool,
}

impl CrossingQuery<'_> {
    /// Calls `cross` for each ray, which adds what it crosses to `hits`, and `each` with its number and
    /// its hits in order, until that returns false. Returns the number of the next ray.
    #[inline(always)]
    pub(super) fn run(
        self,
        geometry: &Geometry,
        hits: &mut Vec<Hit>,
        mut cross: impl FnMut(usize, &Ray, &mut Vec<Hit>),
        each: &mut HitsReceiver<'_>,
    ) -> usize {
        let Self { rays, first, occluded, .. } = self;
        for (number, _) in occluded.iter().enumerate().skip(first).filter(|(_, is)| !**is) {
            hits.clear();
            let ray = rays.ray(number);
            if ray.is_valid() {
                cross(number, &ray, hits);
            }
            if hits.len() > 1 {
                geometry.sort(&ray, hits);
            }
            if !each(number, hits) {
                return number + 1;
            }
        }
        occluded.len()
    }
}

/// Receives the number of a ray and its hits, and says whether to go on.
pub(super) type HitsReceiver<'a> = dyn FnMut(usize, &[Hit]) -> bool + 'a;

/// [`CrossingQuery::run`] in a tree.
#[inline(always)]
pub(super) fn in_tree<S: Lanes, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    query: CrossingQuery<'_>,
    traversal: &mut Traversal,
    hits: &mut Vec<Hit>,
    each: &mut HitsReceiver<'_>,
) -> usize {
    let Traversal { stack, tests, noted, .. } = traversal;
    let Some(root) = searched.tree.root else { return query.occluded.len() };
    let only_transparent = query.only_transparent;
    query.run(
        searched.geometry,
        hits,
        #[inline(always)]
        |number, ray, hits| {
            let mut ray = LazyRay { ray, slab: None, space: None };
            let leaves = noted.of(number).filter(|_| only_transparent);
            let root = (leaves.is_none() && ray.may_meet(&root)).then_some(root.place);
            for from in leaves.into_iter().flatten().chain(root) {
                let (from, found) = ((from, only_transparent), (&mut *hits, &mut *tests));
                cross_below::<S, P>(simd, searched, from, &mut ray, stack, found);
            }
        },
        each,
    )
}

/// A ray, and what is derived from it once needed: lists need neither, leaves that were noted no slab.
struct LazyRay<'a> {
    ray: &'a Ray,
    slab: Option<SlabRay>,
    space: Option<ShearedSpace>,
}

impl LazyRay<'_> {
    #[inline(always)]
    fn slab(&mut self) -> &SlabRay {
        self.slab.get_or_insert_with(|| SlabRay::new(self.ray))
    }

    #[inline(always)]
    fn space(&mut self) -> &ShearedSpace {
        self.space.get_or_insert_with(|| ShearedSpace::new(self.ray))
    }

    /// Whether it may meet what is below the root.
    #[inline(always)]
    fn may_meet(&mut self, root: &Root) -> bool {
        let &Ray { t_min, t_max, .. } = self.ray;
        let slab = self.slab();
        let [near, far] = slab.interval(&root.bounds);
        max(near, t_min) <= min(far, slab.reach(t_max))
    }
}

/// Adds what the ray crosses at or below a place: all, or only transparent primitives.
#[inline(always)]
fn cross_below<S: Lanes, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    (first, only_transparent): (Ref, bool),
    ray: &mut LazyRay<'_>,
    stack: &mut [u64],
    (hits, tests): (&mut Vec<Hit>, &mut TestCounts),
) {
    let arena = searched.tree.arena.view();
    let range = [ray.ray.t_min, ray.ray.t_max];
    stack[0] = entry(f32::NEG_INFINITY, first.bits());
    let mut height = 1;
    while height > 0 {
        height -= 1;
        let mut next = Some(place(stack[height]));
        while let Some(at) = next {
            if at.kind() == Kind::List {
                next = searched.chunk(at);
                if next.is_none() {
                    tests.leaves += 1;
                    let numbers = (arena.list(at).iter().copied(), only_transparent);
                    cross_each::<P>(searched.geometry, numbers, ray.ray, hits, tests);
                }
                continue;
            }
            if at.kind() != Kind::Node {
                cross_leaf::<S, P>(simd, searched, ray, (at, only_transparent), (hits, tests));
                break;
            }
            tests.nodes += 1;
            // Like an any-hit query: no hit cuts the range.
            let (node, slab) = (arena.node(at), ray.slab());
            (next, height) = node::enter::<S, Occluded>(simd, node, at, slab, range, stack, height);
        }
    }
}

/// Adds the triangles of a leaf that the ray crosses: all, or only transparent ones.
#[inline(always)]
fn cross_leaf<S: Lanes, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    ray: &mut LazyRay<'_>,
    (place, only_transparent): (Ref, bool),
    (hits, tests): (&mut Vec<Hit>, &mut TestCounts),
) {
    tests.leaves += 1;
    let arena = searched.tree.arena.view();
    let (ray, space) = (ray.ray, ray.space());
    let found = leaf::test::<S, P>(simd, arena, (ray, space), place, ray.t_max, tests);
    let mut met = found.certain | found.open;
    if only_transparent {
        met = searched.transparent(place, met);
    }
    for lane in set_bits::<LANES>(met) {
        let hit = if found.certain >> lane & 1 == 1 {
            // It passes beside every edge.
            Best::in_leaf(place, lane, [found.low[lane], found.high[lane]])
        } else {
            tests.settled += 1;
            let t = triangle::crossing(ray, &arena.triangle(place, lane));
            let Some(t) = t else { continue };
            Best::in_leaf(place, lane, [t, t])
        };
        hits.extend(
            searched.behind_holes::<P>(ray, hit, tests).map(|hit| hit.finished(arena, ray)),
        );
    }
}

/// Adds those of the primitives with these numbers that the ray crosses, testing each, or each transparent
/// one.
#[inline(never)]
pub(super) fn cross_each<P: Arithmetic>(
    geometry: &Geometry,
    (numbers, only_transparent): (impl Iterator<Item = u32>, bool),
    ray: &Ray,
    hits: &mut Vec<Hit>,
    tests: &mut TestCounts,
) {
    for primitive in numbers.filter(|&number| !only_transparent || geometry.is_transparent(number))
    {
        let found = match geometry.primitive(primitive) {
            Primitive::Triangle(i) => {
                tests.primitives.triangles += 1;
                [triangle::crossing(ray, &geometry.triangle(i)), None]
            }
            Primitive::Quad(i) => {
                tests.primitives.quads += 2;
                let halves = quad::halves(&geometry.quad(i));
                halves.map(|half| triangle::crossing(ray, &half))
            }
            Primitive::Quadric(i) => {
                geometry.quadrics[i].count(tests, 1);
                geometry.quadrics[i].crossings::<P>(ray)
            }
            Primitive::Instanced(_) => [None; 2],
        };
        let is_there = |t: &f32| !geometry.is_hole::<P>(primitive, ray, *t, tests);
        hits.extend(found.into_iter().flatten().filter(is_there).map(|t| Hit { t, primitive }));
    }
}
