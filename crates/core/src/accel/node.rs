//! Nodes: the boxes of eight children, tested at a time.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8, u32x8};

use super::arena::base;
use super::{Node, Query, Ref, child_of};
use crate::kernels::SlabRay;
use crate::kernels::slab::WIDENING;
use crate::math::{LANES, Lanes, entry};

/// The entry distances of the children's boxes, and the children met between `t_min` and
/// `t_max`.
#[inline(always)]
pub(super) fn children<S: Lanes>(
    simd: S,
    node: &Node,
    ray: &SlabRay,
    [t_min, t_max]: [f32; 2],
) -> (f32x8<S>, mask32x8<S>) {
    let [x0, x1] = axis(simd, node, ray, 0);
    let [y0, y1] = axis(simd, node, ray, 1);
    let [z0, z1] = axis(simd, node, ray, 2);
    let near = x0.max(y0).max(z0.max(f32x8::splat(simd, t_min)));
    let far = x1.min(y1).min(z1.min(f32x8::splat(simd, t_max)));
    (near, near.simd_le(widened(simd, far, ray.slack)))
}

/// Far t, grown by the error of the test: see [`crate::kernels::slab`].
#[inline(always)]
pub(super) fn widened<S: Lanes, F: SimdFloat<S, Element = f32>>(simd: S, far: F, slack: f32) -> F {
    far.mul_add(F::splat(simd, WIDENING), F::splat(simd, slack))
}

/// The t of the ray at the children's entry and exit planes on an axis.
#[inline(always)]
fn axis<S: Lanes>(simd: S, node: &Node, ray: &SlabRay, k: usize) -> [f32x8<S>; 2] {
    // Of all rows, so that no index is out of bounds.
    let rows: &[[f32; LANES]; 8] = bytemuck::cast_ref(node);
    let entry = ray.entry[k] as usize % rows.len();
    ray.crossings(k, rows[entry].simd_into(simd), rows[entry ^ 1].simd_into(simd))
}

/// Enters the nearest child that the ray meets, or for other queries than the closest hit the largest. Pushes the
/// others on the stack, whose length is `height`: the nearest or largest last. Returns the child,
/// if any, and the new height.
///
/// Few children are met, so branches on their number are well predicted, and what follows does not
/// wait for stores to the stack.
#[inline(always)]
pub(super) fn enter<S: Lanes, Q: Query>(
    simd: S,
    node: &Node,
    at: Ref,
    ray: &SlabRay,
    range: [f32; 2],
    stack: &mut [u64],
    height: usize,
) -> (Option<Ref>, usize) {
    let (near, mask) = children(simd, node, ray, range);
    let mask = mask.to_bitmask() as u8;
    let others = mask & mask.wrapping_sub(1);
    if mask == 0 {
        return (None, height);
    }
    let lane = |mask: u8| mask.trailing_zeros() as usize % LANES;
    let first = lane(mask);
    if others == 0 {
        return (Some(child_of(node, at, first)), height);
    }
    if others & (others - 1) == 0 {
        let second = lane(others);
        let near: [f32; LANES] = near.into();
        let is_in_order = Q::NEAREST && near[first] <= near[second];
        let (first, second) = if is_in_order { (first, second) } else { (second, first) };
        stack[height] = entry(near[second], child_of(node, at, second).bits());
        return (Some(child_of(node, at, first)), height + 1);
    }
    let entries = simd.entries(near, places(simd, node, at));
    let height = append::<S, Q>(simd, &entries, mask, stack, height) - 1;
    (Some(place(stack[height])), height)
}

/// Appends the `entries` whose bit in `mask` is 1 to the stack: the nearest last, or for other queries
/// than the closest hit the largest. Returns the new height.
#[inline(always)]
pub(super) fn append<S: Lanes, Q: Query>(
    simd: S,
    entries: &[u64; LANES],
    mask: u8,
    stack: &mut [u64],
    height: usize,
) -> usize {
    let Some(room) = stack.get_mut(height..).and_then(|s| s.first_chunk_mut::<LANES>()) else {
        return height;
    };
    if Q::NEAREST {
        simd.far_to_near(entries, mask, room);
    } else {
        simd.compress(entries, mask, room);
    }
    height + mask.count_ones() as usize
}

/// The places of the children of the node at `place`.
#[inline(always)]
pub(super) fn places<S: Lanes>(simd: S, node: &Node, place: Ref) -> u32x8<S> {
    let places: u32x8<S> = node.children.simd_into(simd);
    places + base(place)
}

/// The entry's distance, at which the ray enters the box.
#[inline(always)]
pub(super) fn distance(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

#[inline(always)]
pub(super) fn place(entry: u64) -> Ref {
    Ref::from_bits(entry as u32)
}
