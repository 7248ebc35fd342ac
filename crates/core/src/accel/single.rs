//! Traversal by one ray: for the recursive tracer, and for the rays left by packets.

use super::{Best, Hit, Kind, Query, Searched, Traversal, distance, leaf, node, place};
use crate::counters::TestCounts;
use crate::geometry::PreparedRay;
use crate::kernels::Arithmetic;
use crate::math::{Lanes, Ray, entry};

/// The hit on `ray` for the query.
#[inline(always)]
pub(super) fn hit<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    (ray, number): (&Ray, usize),
    query: &mut Q,
    traversal: &mut Traversal,
) -> Hit {
    let Traversal { stack, tests, .. } = traversal;
    let Some(root) = searched.root else { return Hit::MISS };
    let prepared = &PreparedRay::new(ray);
    let (best, from) = (Best::none(ray.t_max), entry(f32::NEG_INFINITY, root.place.bits()));
    let (stack, memory) = (stack.as_mut_slice(), (&mut *tests, query));
    let best = trace::<S, Q, P>(simd, searched, (prepared, number), best, (stack, from), memory);
    if Q::ALL { Hit::MISS } else { best.answer(searched, ray, tests) }
}

/// The hit for the query at or below the place of the entry `from`, or `best`, the closest hit so far, for
/// the ray with that number.
#[inline(always)]
pub(super) fn trace<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    (ray, number): (&PreparedRay, usize),
    mut best: Best,
    (stack, from): (&mut [u64], u64),
    (tests, query): (&mut TestCounts, &mut Q),
) -> Best {
    let arena = searched.tree.arena.view();
    stack[0] = from;
    let mut height = 1;
    while height > 0 {
        height -= 1;
        let entry = stack[height];
        // In other queries the limit is fixed, and everything on the stack is within it.
        if Q::NEAREST && distance(entry) > ray.slab.reach(best.high) {
            continue;
        }
        let mut next = Some(place(entry));
        while let Some(at) = next {
            if at.kind() == Kind::Node {
                tests.nodes += 1;
                let range = [ray.ray.t_min, best.high];
                (next, height) =
                    node::enter::<S, Q>(simd, arena.node(at), at, &ray.slab, range, stack, height);
                continue;
            }
            let Some(root) = searched.chunk(at) else { break };
            next = Some(root);
        }
        let Some(leaf) = next else { continue };
        let (ray, memory) = ((ray, number), (&mut *tests, &mut *query));
        if leaf::visit::<S, Q, P>(simd, searched, ray, leaf, &mut best, memory) && Q::ANY {
            break;
        }
    }
    best
}
