//! Nodes: the boxes of eight children, tested at a time.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8, u32x8};

use super::{Node, Query, Ref, child_of};
use crate::geometry::PreparedRay;
use crate::kernels::SlabRay;
use crate::kernels::slab::WIDENING;
use crate::math::{LANES, Lanes, entry};

/// The entry distances of the children's boxes, and the children met from the ray's `t_min` up to `t_max`.
#[inline(always)]
pub(super) fn children<S: Lanes>(
    simd: S,
    node: &Node,
    PreparedRay { ray, slab, .. }: &PreparedRay,
    t_max: f32,
) -> (f32x8<S>, mask32x8<S>) {
    let all = |value: f32| f32x8::splat(simd, value);
    let [x0, x1] = axis(simd, node, slab, 0);
    let [y0, y1] = axis(simd, node, slab, 1);
    let [z0, z1] = axis(simd, node, slab, 2);
    let near = x0.max(y0).max(z0.max(all(ray.t_min)));
    let far = x1.min(y1).min(z1.min(all(t_max)));
    (near, near.simd_le(widened(simd, far, slab.slack())))
}

/// The t of the ray at the children's entry and exit planes on an axis.
#[inline(always)]
fn axis<S: Lanes>(simd: S, node: &Node, ray: &SlabRay, k: usize) -> [f32x8<S>; 2] {
    // Of all rows, so that no index is out of bounds.
    let rows: &[f32; 8 * LANES] = bytemuck::cast_ref(node);
    let row = |at: usize| f32x8::from_slice(simd, &rows[at..at + LANES]);
    ray.crossings(k, row(ray.entry(k)), row(ray.entry(k) ^ LANES))
}

/// Far t, grown by the error of the test: see [`crate::kernels::slab`].
#[inline(always)]
pub(super) fn widened<S: Lanes, F: SimdFloat<S, Element = f32>>(simd: S, far: F, slack: f32) -> F {
    far.mul_add(F::splat(simd, WIDENING), F::splat(simd, slack))
}

/// Stack entries of the children met, which come first, in the order of the lanes; and a bit for each lane.
#[inline(always)]
pub(super) fn entries<S: Lanes, Q: Query>(
    simd: S,
    (near, met): (f32x8<S>, mask32x8<S>),
    children: u32x8<S>,
) -> ([u64; LANES], u8) {
    // Other queries drop nothing by its distance.
    let near = if Q::NEAREST { near } else { f32x8::splat(simd, f32::NEG_INFINITY) };
    (simd.entries(near, children, met), met.to_bitmask() as u8)
}

/// The places of the children of the node at `place`.
#[inline(always)]
pub(super) fn places<S: Lanes>(simd: S, node: &Node, place: Ref) -> u32x8<S> {
    let places: u32x8<S> = node.children.simd_into(simd);
    places + place.bits()
}

/// Writes the first of the `entries`, one for each bit of `met`, to a stack with room for eight: the nearest last, or
/// for other queries than the closest hit the largest. Returns their number.
#[inline(always)]
pub(super) fn push<S: Lanes, Q: Query>(
    simd: S,
    (entries, met): (&[u64; LANES], u8),
    stack: &mut [u64],
) -> usize {
    let Some(stack) = stack.first_chunk_mut() else { return 0 };
    let count = met.count_ones() as usize;
    if Q::NEAREST {
        simd.far_to_near(entries, count, stack);
    } else {
        *stack = *entries;
    }
    count
}

/// Enters the first of the children met by a ray that is alone, and pushes the others on the stack, which has this
/// `height`. Returns the child, if any, and the new height.
///
/// With branches for one and two, so that the ray's next step does not wait for the stack. Mostly it is one.
#[inline(always)]
pub(super) fn enter<S: Lanes, Q: Query>(
    simd: S,
    (node, at): (&Node, Ref),
    (near, met): (f32x8<S>, mask32x8<S>),
    (stack, height): (&mut [u64], usize),
) -> (Option<Ref>, usize) {
    let mask = met.to_bitmask() as u8;
    let others = mask & mask.wrapping_sub(1);
    if mask == 0 {
        return (None, height);
    }
    let lane = |mask: u8| mask.trailing_zeros() as usize % LANES;
    let (first, second) = (lane(mask), lane(others));
    if others == 0 {
        return (Some(child_of(node, at, first)), height);
    }
    if others & (others - 1) == 0 {
        let near: [f32; LANES] = near.into();
        let is_in_order = Q::NEAREST && near[first] <= near[second];
        let (first, second) = if is_in_order { (first, second) } else { (second, first) };
        stack[height] = entry(near[second], child_of(node, at, second).bits());
        return (Some(child_of(node, at, first)), height + 1);
    }
    let (entries, mask) = entries::<S, Q>(simd, (near, met), places(simd, node, at));
    let height = height + push::<S, Q>(simd, (&entries, mask), &mut stack[height..]) - 1;
    (Some(place(stack[height])), height)
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
