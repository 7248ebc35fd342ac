//! Traversal by one ray: what the recursive tracer asks, and what is left over from packets.

use super::arena::Kind;
use super::geometry::{Geometry, PreparedRay};
use super::node::{self, distance, place};
use super::tree::{Tree, reach};
use super::{Hit, NO_PRIMITIVE, TestCounts, leaf};
use crate::kernels::precision::Arithmetic;
use crate::math::simd::{Lanes, entry};

/// The closest hit, beginning with the first `height` entries of `stack`, the nearest last, and
/// with `best`, the closest hit so far.
#[inline(always)]
pub(super) fn closest<S: Lanes, P: Arithmetic>(
    simd: S,
    tree: &Tree,
    geometry: &Geometry,
    ray: &PreparedRay,
    mut best: Hit,
    (stack, mut height): (&mut [u64], usize),
    tests: &mut TestCounts,
) -> Hit {
    let arena = tree.arena.view();
    let mut limit = reach::<P>(best.t);
    while height > 0 {
        height -= 1;
        let entry = stack[height];
        if distance(entry) > limit {
            continue;
        }
        let place = place(entry);
        if place.kind() == Kind::Node {
            tests.nodes += 1;
            let range = [ray.ray.t_min, limit];
            let node = arena.node(place);
            height = node::push::<S, true>(simd, node, place, &ray.slab, range, stack, height);
        } else if leaf::closest::<S, P>(simd, arena, geometry, ray, place, &mut best, tests) {
            limit = reach::<P>(best.t);
        }
    }
    best
}

/// Whether anything but a light's shape is hit, beginning with the first `height` entries of
/// `stack`.
#[inline(always)]
pub(super) fn occluded<S: Lanes, P: Arithmetic>(
    simd: S,
    tree: &Tree,
    geometry: &Geometry,
    ray: &PreparedRay,
    (stack, mut height): (&mut [u64], usize),
    tests: &mut TestCounts,
) -> bool {
    let arena = tree.arena.view();
    let range = [ray.ray.t_min, reach::<P>(ray.ray.t_max)];
    while height > 0 {
        height -= 1;
        let place = place(stack[height]);
        if place.kind() == Kind::Node {
            tests.nodes += 1;
            let node = arena.node(place);
            height = node::push::<S, false>(simd, node, place, &ray.slab, range, stack, height);
        } else if leaf::occluded::<S, P>(simd, arena, geometry, ray, place, tests) {
            return true;
        }
    }
    false
}

/// The hit that stands for none yet on `ray`.
#[inline(always)]
pub(super) fn no_hit(ray: &PreparedRay) -> Hit {
    Hit { t: ray.ray.t_max, primitive: NO_PRIMITIVE }
}

/// `best`, or a miss if nothing was found.
#[inline(always)]
pub(super) fn or_miss(best: Hit) -> Hit {
    if best.is_miss() { Hit::MISS } else { best }
}

/// Puts the root on an empty stack if the ray meets it. The height.
#[inline(always)]
pub(super) fn start<P: Arithmetic>(tree: &Tree, ray: &PreparedRay, stack: &mut [u64]) -> usize {
    let Some(root) = tree.root().filter(|root| root.is_met::<P>(ray)) else { return 0 };
    stack[0] = entry(f32::NEG_INFINITY, root.place.bits());
    1
}
