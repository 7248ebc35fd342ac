//! Traversal by one ray: for the recursive tracer, and for the rays left by packets.

use super::{Best, Hit, Kind, Query, Searched, distance, leaf, node, place};
use crate::counters::TestCounts;
use crate::geometry::PreparedRay;
use crate::kernels::Arithmetic;
use crate::math::{Lanes, Ray, entry, outlined};

/// The hit on `ray` for the query, in the `WORLD` or in a prototype.
#[inline(always)]
pub(super) fn hit<S: Lanes, Q: Query, P: Arithmetic, const WORLD: bool>(
    simd: S,
    searched: &Searched<'_>,
    (ray, number): (&Ray, usize),
    query: &mut Q,
    (stack, tests): (&mut [u64], &mut TestCounts),
) -> Hit {
    let Some(root) = searched.root else { return Hit::MISS };
    let prepared = (&searched.prepare(ray), number);
    let (best, from) = (Best::none(ray.t_max), entry(f32::NEG_INFINITY, root.place.bits()));
    let (from, memory) = ((stack, from), (&mut *tests, query));
    let best = trace::<S, Q, P, WORLD>(simd, searched, prepared, best, from, memory);
    if Q::ALL { Hit::MISS } else { best.answer(searched, ray, tests) }
}

/// The hit for the query at or below the place of the entry `from`, or `best`, the closest hit so far, for
/// the ray with that number, in the `WORLD` or in a prototype.
#[inline(always)]
pub(super) fn trace<S: Lanes, Q: Query, P: Arithmetic, const WORLD: bool>(
    simd: S,
    searched: &Searched<'_>,
    (ray, number): (&PreparedRay, usize),
    mut best: Best,
    (stack, from): (&mut [u64], u64),
    (tests, query): (&mut TestCounts, &mut Q),
) -> Best {
    let arena = searched.arena;
    stack[0] = from;
    let mut height = 1;
    'entries: while height > 0 {
        height -= 1;
        let entry = stack[height];
        // In other queries the limit is fixed, and everything on the stack is within it.
        if Q::NEAREST && distance(entry) > ray.slab.reach(best.high) {
            continue;
        }
        let mut at = place(entry);
        while at.kind() == Kind::Node {
            tests.nodes += 1;
            let node = arena.node(at);
            let met = node::children(simd, node, ray, best.high);
            let next = node::enter::<S, Q>(simd, (node, at), met, (&mut *stack, height));
            height = next.1;
            let Some(child) = next.0 else { continue 'entries };
            at = child;
        }
        if let Some(root) = searched.chunk(at) {
            stack[height] = crate::math::entry(distance(entry), root.bits());
            height += 1;
            continue;
        }
        let leaf = at;
        if WORLD && let Some(instance) = searched.instance(leaf) {
            if Q::ALL {
                continue;
            }
            tests.instances += 1;
            let Some(carried) = searched.carried(instance, &ray.ray, &best) else { continue };
            let memory = (&mut stack[height..], &mut *tests);
            let found = outlined(
                simd,
                #[inline(always)]
                || {
                    let prototype = searched.prototype(instance);
                    hit::<S, Q, P, false>(simd, &prototype, (&carried, number), query, memory)
                },
            );
            if Q::ANY && !found.is_miss() {
                return Best::of(found);
            }
            searched.offer::<P>(instance, found, (&ray.ray, &mut best), tests);
            continue;
        }
        if WORLD && searched.only_instances {
            continue;
        }
        let (ray, memory) = ((ray, number), (&mut *tests, &mut *query));
        if leaf::visit::<S, Q, P>(simd, searched, ray, leaf, &mut best, memory) && Q::ANY {
            break;
        }
    }
    best
}
