//! Finds leaves before the tree, for the quickest build. Along Morton's curve each triangle joins
//! one of the last leaves as long as that costs rays hardly more than a new leaf. The hierarchy is
//! then over leaves, a fifth of the number of triangles.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::ploc::morton::morton_encode_u32;

use super::piece::{Members, Single};
use crate::accel::wide::{Shared, as_patch};
use crate::math::simd::LANES;

/// How much more a joint leaf may cost than two separate ones, as a share of the smaller one's
/// cost. This makes fewer leaves and nodes: compared with 0, building a scan takes a seventh less
/// time and rays are no slower; with 1 they were slower by 3 per cent.
const SLACK: f32 = 0.6;

/// The number of last leaves that a triangle may join, for the curve soon comes back. More make
/// fuller leaves, and take longer to look at: with 1 a terrain takes 49.6 bytes a triangle, with 6
/// 39.5, with 16 37.7. Rays visit 1 to 4 per cent fewer nodes with 6 than with 1, more with 16.
const OPEN: usize = 6;

/// Bits of the curve for each axis.
const BITS: u32 = 10;

/// Finds the leaves of a piece, and reuses its memory.
#[derive(Default)]
pub(super) struct Finder {
    /// Positions on the curve, with the index of the primitive in the low bits, and room to sort
    /// them.
    keys: Vec<u64>,
    spare: Vec<u64>,
    /// The boxes of the leaves.
    leaves: Vec<Aabb>,
}

/// A leaf.
#[derive(Clone, Copy)]
pub(super) struct Leaf {
    /// The vertices of triangles; other primitives are alone.
    pub(super) shared: Option<Shared>,
    /// The numbers of its primitives; the first `count` are used.
    pub(super) numbers: [u32; LANES],
    pub(super) count: usize,
}

impl Finder {
    /// Replaces the `boxes` of single primitives, which come first, by those of their leaves.
    pub(super) fn find(&mut self, members: &mut Members, boxes: &mut Vec<Aabb>) {
        let Members { singles, leaves, .. } = members;
        let (own, heaps) = boxes.split_at(singles.len());
        sort(own, &mut self.keys, &mut self.spare);
        self.leaves.clear();
        for &key in &self.keys {
            let index = key as u32 as usize;
            let (Single { number, corners }, bounds) = (singles[index], own[index]);
            let first = leaves.len().saturating_sub(OPEN);
            let open = leaves[first..].iter().zip(&self.leaves[first..]);
            let found = corners.and_then(|corners| cheapest(open, corners, &bounds));
            if let Some((place, shared, union)) = found {
                let leaf = &mut leaves[first + place];
                leaf.numbers[leaf.count] = number;
                (leaf.shared, leaf.count) = (Some(shared), leaf.count + 1);
                self.leaves[first + place] = union;
            } else {
                let shared = corners.map(Shared::of);
                leaves.push(Leaf { shared, numbers: [number; LANES], count: 1 });
                self.leaves.push(bounds);
            }
        }
        singles.clear();
        self.leaves.extend_from_slice(heaps);
        std::mem::swap(boxes, &mut self.leaves);
    }
}

/// Where a triangle costs least among `open` leaves with their boxes, and that leaf with it. `None`
/// if none has room and costs less with it than beside a leaf of its own.
#[inline]
fn cheapest<'a>(
    open: impl Iterator<Item = (&'a Leaf, &'a Aabb)>,
    corners: [u32; 3],
    bounds: &Aabb,
) -> Option<(usize, Shared, Aabb)> {
    let alone = bounds.half_area();
    let mut least = f32::INFINITY;
    let mut found = None;
    for (place, (leaf, around)) in open.enumerate() {
        let (union, before) = (around.union(bounds), around.half_area());
        let more = union.half_area() * as_patch(leaf.count + 1) - before * as_patch(leaf.count);
        let most = alone * as_patch(1) + SLACK * before.min(alone);
        if leaf.count < LANES
            && more <= most
            && more < least
            && let Some(mut shared) = leaf.shared
            && shared.add(leaf.count, corners)
        {
            least = more;
            found = Some((place, shared, union));
        }
    }
    found
}

/// Writes the boxes' positions on the curve and their indices to `keys`, in rising order.
fn sort(boxes: &[Aabb], keys: &mut Vec<u64>, spare: &mut Vec<u64>) {
    let center = |b: &Aabb| b.min + b.max;
    let low = boxes.iter().map(center).fold(Vec3A::INFINITY, Vec3A::min);
    let high = boxes.iter().map(center).fold(Vec3A::NEG_INFINITY, Vec3A::max);
    let scale = (1 << BITS) as f32 / (high - low).max_element();
    keys.clear();
    keys.extend(boxes.iter().enumerate().map(|(index, b)| {
        // If all are at one place, 0 x inf is NaN, and counts as 0.
        let at = ((center(b) - low) * scale).to_array();
        let [x, y, z] = at.map(|x| (x as u16).min((1 << BITS) - 1));
        u64::from(morton_encode_u32(x, y, z)) << 32 | index as u64
    }));
    sort_keys(keys, spare);
}

/// Sorts by the upper half, which has [`BITS`] for each axis: a radix sort from the lowest digit
/// up.
fn sort_keys(keys: &mut Vec<u64>, spare: &mut Vec<u64>) {
    spare.resize(keys.len(), 0);
    for shift in (0..3 * BITS).step_by(BITS as usize).map(|digit| 32 + digit) {
        let digit = |key: u64| (key >> shift) as usize & ((1 << BITS) - 1);
        let mut places = [0_u32; 1 << BITS];
        keys.iter().for_each(|&key| places[digit(key)] += 1);
        let mut sum = 0;
        places.iter_mut().for_each(|place| sum += std::mem::replace(place, sum));
        for &key in &*keys {
            let place = &mut places[digit(key)];
            spare[*place as usize] = key;
            *place += 1;
        }
        std::mem::swap(keys, spare);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_sorted_by_place_and_keep_their_order_at_one_place() {
        let place = |i: u64| (i * 0x9E37_79B9) >> 7 & ((1 << (3 * BITS)) - 1) & !0xF_FFFF;
        let mut keys: Vec<u64> = (0..5000).map(|i| place(i) << 32 | i).collect();
        let mut expected = keys.clone();
        expected.sort_unstable();
        assert!(expected.windows(2).any(|pair| pair[0] >> 32 == pair[1] >> 32));
        sort_keys(&mut keys, &mut Vec::new());
        assert_eq!(keys, expected);
    }
}
