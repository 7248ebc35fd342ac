//! Traversal by one ray: for the recursive tracer, and for the rays left by packets.

use super::{Best, Kind, NotedLeaves, Query, Searched, distance, leaf, node, place};
use crate::counters::TestCounts;
use crate::geometry::PreparedRay;
use crate::kernels::Arithmetic;
use crate::math::Lanes;

/// The hit for query `Q`, starting with the first `height` entries of `stack`, the nearest last,
/// and with `best`, the closest hit so far, for the ray with that number.
#[inline(always)]
pub(super) fn trace<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    (ray, number): (&PreparedRay, usize),
    mut best: Best,
    (stack, mut height): (&mut [u64], usize),
    (tests, noted): (&mut TestCounts, &mut NotedLeaves),
) -> Best {
    let arena = searched.tree.arena.view();
    while height > 0 {
        height -= 1;
        let entry = stack[height];
        // In any-hit queries the limit is fixed, and everything on the stack is within it.
        if !Q::ANY && distance(entry) > ray.slab.reach(best.high) {
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
        let (ray, notes) = ((ray, number), (&mut *tests, &mut *noted));
        if leaf::visit::<S, Q, P>(simd, searched, ray, leaf, &mut best, notes) && Q::ANY {
            break;
        }
    }
    best
}
