//! Traversal of the tree by one ray: the nearer child first, the other kept on a stack.

use super::geometry::{Geometry, PreparedRay};
use super::tree::{Child, Tree};
use super::{Hit, NO_PRIMITIVE, TestCounts, Traversal};
use crate::kernels::slab::Interval;
use crate::kernels::triangle::T_TOLERANCE;

/// A child still to be visited, and where the ray enters its box.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    near: f32,
    child: Child,
}

/// The closest hit.
pub fn closest(
    tree: &Tree,
    geometry: &Geometry,
    ray: &PreparedRay,
    traversal: &mut Traversal,
) -> Hit {
    let slack = slack(tree);
    let mut best = Hit { t: ray.ray.t_max, primitive: NO_PRIMITIVE };
    let mut limit = best.t * slack;
    walk(tree, ray, traversal, limit, |leaf, tests, reach| {
        for &number in leaf {
            if let Some(t) = geometry.hit(number, ray, tests)
                && (t < best.t || (t == best.t && number < best.primitive))
            {
                best = Hit { t, primitive: number };
                limit = t * slack;
            }
        }
        *reach = limit;
        false
    });
    if best.is_miss() { Hit::MISS } else { best }
}

/// Whether anything but a light's shape is hit.
pub fn occluded(
    tree: &Tree,
    geometry: &Geometry,
    ray: &PreparedRay,
    traversal: &mut Traversal,
) -> bool {
    let mut found = false;
    walk(tree, ray, traversal, ray.ray.t_max * slack(tree), |leaf, tests, _| {
        found = leaf.iter().any(|&number| {
            geometry.hit(number, ray, tests).is_some() && !geometry.is_light(number)
        });
        found
    });
    found
}

/// How far beyond a t boxes are still visited. Where leaves hold parts of primitives, the box of a
/// part can begin after the t that was computed for a hit in it, by no more than the error of t:
/// each hit is at a point of the primitive that the ray passes within rounding (see
/// [`crate::kernels::triangle`]), and so in the padded box of a part.
fn slack(tree: &Tree) -> f32 {
    if tree.has_splits() { 1.0 + 4.0 * T_TOLERANCE } else { 1.0 }
}

/// Visits the leaves whose boxes the ray meets before `reach`, nearest first, until `visit` says
/// that it has enough. `visit` may lower `reach`.
#[inline(always)]
fn walk(
    tree: &Tree,
    ray: &PreparedRay,
    traversal: &mut Traversal,
    mut reach: f32,
    mut visit: impl FnMut(&[u32], &mut TestCounts, &mut f32) -> bool,
) {
    let Some((bounds, root)) = tree.root() else { return };
    let t_min = ray.ray.t_min;
    let meets = |i: Interval, reach: f32| i.near <= i.far && i.far >= t_min && i.near <= reach;
    if !meets(ray.slab.interval(&bounds), reach) {
        return;
    }
    let Traversal { stack, tests } = traversal;
    stack.clear();
    let mut current = root;
    loop {
        if current.count == 0 {
            tests.nodes += 1;
            let node = &tree.nodes()[current.index as usize];
            let [a, b] = node.bounds.map(|bounds| ray.slab.interval(&bounds));
            let [first, second] = node.children;
            match (meets(a, reach), meets(b, reach)) {
                (true, true) => {
                    let (next, later) = if b.near < a.near {
                        (second, Entry { near: a.near, child: first })
                    } else {
                        (first, Entry { near: b.near, child: second })
                    };
                    stack.push(later);
                    current = next;
                    continue;
                }
                (true, false) => {
                    current = first;
                    continue;
                }
                (false, true) => {
                    current = second;
                    continue;
                }
                (false, false) => {}
            }
        } else {
            let start = current.index as usize;
            let leaf = &tree.primitives()[start..start + current.count as usize];
            if visit(leaf, tests, &mut reach) {
                return;
            }
        }
        current = loop {
            match stack.pop() {
                None => return,
                Some(entry) if entry.near <= reach => break entry.child,
                Some(_) => {}
            }
        };
    }
}
