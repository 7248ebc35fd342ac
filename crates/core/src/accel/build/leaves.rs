//! Finds leaves before the tree, for the quickest build. Along Morton's curve each triangle joins
//! one of the last leaves as long as that costs rays hardly more than a new leaf. The hierarchy is
//! then over leaves, a fifth of the number of triangles.

use std::array::from_fn;

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::ploc::morton::morton_encode_u32;

use super::entries::Entry;
use crate::accel::wide::{SharedVertices, as_patch};
use crate::math::LANES;
use crate::math::float::{max, min};

/// How much more a joint leaf may cost than two separate ones, as a share of the smaller one's
/// cost. This makes fewer leaves and nodes: compared with 0, building a scan takes a seventh less
/// time and rays are no slower; with 1 they were slower by 3 per cent.
const SLACK: f32 = 0.6;

/// The key of a leaf that a triangle cannot join.
const NO_ROOM: i32 = i32::MAX;

/// Bits of the curve for each axis.
const BITS: u32 = 10;

/// Finds the leaves of a piece, and reuses its memory.
#[derive(Default)]
pub(super) struct LeafFinder {
    /// Positions on the curve, with the index of the primitive in the low bits, and room to sort
    /// them.
    keys: Vec<u64>,
    spare: Vec<u64>,
    /// The boxes of the leaves.
    leaves: Vec<Aabb>,
}

/// A leaf of triangles that follow each other on the curve, or of another primitive.
#[derive(Clone, Copy)]
pub(super) struct CurveLeaf {
    /// The vertices of triangles; other primitives are alone.
    pub(super) shared: Option<SharedVertices>,
    /// The numbers of its primitives; the first `count` are used.
    pub(super) numbers: [u32; LANES],
    pub(super) count: usize,
}

impl LeafFinder {
    /// Moves `singles` into `leaves`, and replaces their `boxes`, which come first, by those of the leaves. A
    /// triangle may join one of the last `N` leaves, of which there are a power of two.
    pub(super) fn find<const N: usize>(
        &mut self,
        singles: &mut Vec<Entry>,
        leaves: &mut Vec<CurveLeaf>,
        boxes: &mut Vec<Aabb>,
    ) {
        let (own, heaps) = boxes.split_at(singles.len());
        sort(own, &mut self.keys, &mut self.spare);
        self.leaves.clear();
        let mut open = LastLeaves::<N>::default();
        for &key in &self.keys {
            let index = key as u32 as usize;
            let (Entry { number, corners }, bounds) = (singles[index], own[index]);
            let mut keys = open.keys(&bounds);
            let joined = corners.and_then(|corners| {
                loop {
                    let lane = *keys.iter().min().filter(|&&key| key != NO_ROOM)? as usize % N;
                    let leaf = &leaves[open.leaves[lane]];
                    let mut shared = leaf.shared?;
                    if shared.add(leaf.count, corners) {
                        return Some((lane, shared));
                    }
                    keys[lane] = NO_ROOM;
                }
            });
            if let Some((lane, shared)) = joined {
                let leaf = &mut leaves[open.leaves[lane]];
                leaf.shared = Some(shared);
                leaf.numbers[leaf.count] = number;
                leaf.count += 1;
                let around = &mut self.leaves[open.leaves[lane]];
                *around = around.union(&bounds);
                open.put(lane, around, leaf.count);
            } else {
                let lane = leaves.len() % N;
                open.leaves[lane] = leaves.len();
                open.put(lane, &bounds, if corners.is_some() { 1 } else { LANES });
                let shared = corners.map(|corners| {
                    let mut shared = SharedVertices::default();
                    shared.add(0, corners);
                    shared
                });
                leaves.push(CurveLeaf { shared, numbers: [number; LANES], count: 1 });
                self.leaves.push(bounds);
            }
        }
        singles.clear();
        self.leaves.extend_from_slice(heaps);
        std::mem::swap(boxes, &mut self.leaves);
    }
}

/// The last leaves, which a triangle may join, for the curve soon comes back.
struct LastLeaves<const N: usize> {
    /// The numbers of the leaves.
    leaves: [usize; N],
    /// Their boxes, an axis a row.
    low: [[f32; N]; 3],
    high: [[f32; N]; 3],
    /// The half areas of the boxes, and the leaves' costs.
    area: [f32; N],
    cost: [f32; N],
    /// The cost of visiting each with one triangle more; infinite if it has no room.
    fuller: [f32; N],
}

impl<const N: usize> Default for LastLeaves<N> {
    fn default() -> Self {
        let (zero, none) = ([0.0; N], [f32::INFINITY; N]);
        let leaves = [0; N];
        Self { leaves, low: [zero; 3], high: [zero; 3], area: zero, cost: zero, fuller: none }
    }
}

impl<const N: usize> LastLeaves<N> {
    /// Puts a leaf of `count` triangles into a lane.
    fn put(&mut self, lane: usize, bounds: &Aabb, count: usize) {
        for axis in 0..3 {
            self.low[axis][lane] = bounds.min[axis];
            self.high[axis][lane] = bounds.max[axis];
        }
        self.area[lane] = bounds.half_area();
        self.cost[lane] = self.area[lane] * as_patch(count);
        self.fuller[lane] = if count < LANES { as_patch(count + 1) } else { f32::INFINITY };
    }

    /// A key for each leaf, in the order of what it costs more with a triangle in `bounds`, with the
    /// lane in its low bits; [`NO_ROOM`] if that is too much, compared with a leaf of its own.
    #[inline(always)]
    fn keys(&self, bounds: &Aabb) -> [i32; N] {
        let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
        let alone = bounds.half_area();
        from_fn(|lane| {
            let size = |axis: usize| {
                max(self.high[axis][lane], high[axis]) - min(self.low[axis][lane], low[axis])
            };
            let [x, y, z] = [size(0), size(1), size(2)];
            let more = ((x + y) * z + x * y) * self.fuller[lane] - self.cost[lane];
            let most = alone * as_patch(1) + SLACK * self.area[lane].min(alone);
            // Ordered as the numbers are: those below zero are turned round.
            let bits = more.to_bits() as i32;
            let ordered = bits ^ (bits >> 31) & i32::MAX;
            let key = ordered & !(N as i32 - 1) | lane as i32;
            if more <= most { key } else { NO_ROOM }
        })
    }
}

/// Writes the boxes' positions on the curve and their indices to `keys`, in rising order.
pub(super) fn sort(boxes: &[Aabb], keys: &mut Vec<u64>, spare: &mut Vec<u64>) {
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
