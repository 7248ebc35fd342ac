//! Finds heaps: many large boxes around one point, such as concentric spheres or layers of the same
//! shape.
//!
//! A bottom-up builder does badly there: it merges one pair a round, with quadratic time and a tree
//! as deep as the heap is large. A heap therefore enters the hierarchy as one box, which afterwards
//! becomes a balanced tree ([`Heaps::open`]): its leaves are full, so that triangles are tested eight
//! at a time. So do fans ([`fans`]).
//!
//! Of opaque triangles with the same corners only the first enters the tree, and of the shapes of lights, which
//! are no members of the same heap: a ray meets all of them at the same t, where the lowest number wins. What is
//! transparent or cut out shows the others.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

use super::entries::Entry;
use super::fans;
use crate::geometry::Geometry;
use crate::math::LANES;

/// A heap has more members than this.
const LEAST: usize = 64;

/// Centres within the same of this many steps across the scene count as one point.
const STEPS: f32 = (1 << 20) as f32;

/// Boxes smaller than this many steps are not large: they are details of a vast scene.
const LARGE: f32 = 16.0;

/// Largest number of counters of the first pass.
const MOST_COUNTERS: usize = 1 << 16;

/// The heaps of a piece.
#[derive(Default)]
pub(super) struct Heaps {
    /// The members of all heaps, with their boxes.
    pub(super) members: Vec<(Entry, Aabb)>,
    /// The members of each heap.
    ranges: Vec<Range<usize>>,
}

impl Heaps {
    /// Moves the members of heaps here from the lists of primitives and of their boxes, and appends
    /// the box of each heap. `whole` is the scene's box.
    pub(super) fn gather(
        &mut self,
        geometry: &Geometry,
        whole: &Aabb,
        (singles, boxes): (&mut Vec<Entry>, &mut Vec<Aabb>),
    ) {
        self.members.clear();
        self.ranges.clear();
        let (heaps, mut fans) = (heaps(boxes, whole), fans::fans(singles));
        fans.extend(fans::large(boxes));
        if heaps.is_empty() && fans.is_empty() {
            return;
        }
        let mut is_alone = vec![true; boxes.len()];
        let heaps = heaps.into_iter().map(|heap| (heap, false));
        for (heap, is_fan) in heaps.chain(fans.into_iter().map(|fan| (fan, true))) {
            // A member of a heap may be in a fan, too.
            let own = heap.iter().filter(|&&i| std::mem::take(&mut is_alone[i as usize]));
            let members: Vec<_> = own.map(|&i| (singles[i as usize], boxes[i as usize])).collect();
            if members.is_empty() {
                continue;
            }
            let first = self.members.len();
            let members = if is_fan { fans::ordered(&members) } else { ordered(geometry, members) };
            self.members.extend(members);
            self.ranges.push(first..self.members.len());
        }
        let mut flags = is_alone.iter();
        singles.retain(|_| flags.next() == Some(&true));
        let mut flags = is_alone.iter();
        boxes.retain(|_| flags.next() == Some(&true));
        boxes.extend(self.ranges.iter().map(|range| self.around(range)));
    }

    /// Replaces each heap in the hierarchy by a balanced tree over its members. The numbers of heaps
    /// as owners begin at `first`, and so do afterwards those of the members.
    pub(super) fn open(&self, bvh: &mut Bvh2, first: usize) {
        if self.ranges.is_empty() {
            return;
        }
        let members_at = |(place, node): (usize, &Bvh2Node)| {
            let owner = bvh.primitive_indices.get(node.first_index as usize)?;
            let heap = (*owner as usize).checked_sub(first).filter(|_| node.is_leaf())?;
            Some((place, self.ranges[heap].clone()))
        };
        // The first heap comes last, so that it is opened first.
        let nodes = bvh.nodes.iter().enumerate();
        let mut waiting: Vec<_> = nodes.rev().filter_map(members_at).collect();
        while let Some((place, members)) = waiting.pop() {
            let Range { start, end } = members;
            if members.len() == 1 {
                bvh.nodes[place].first_index = bvh.primitive_indices.len() as u32;
                bvh.primitive_indices.push((first + start) as u32);
                continue;
            }
            let half = members.len().div_ceil(2);
            // Full leaves, but for the last.
            let half = if members.len() > LANES { half.next_multiple_of(LANES) } else { half };
            let children = bvh.nodes.len();
            for (child, part) in [start..start + half, start + half..end].into_iter().enumerate() {
                bvh.nodes.push(Bvh2Node::new(self.around(&part), 1, 0));
                waiting.push((children + child, part));
            }
            bvh.nodes[place].make_inner(children as u32);
        }
    }

    /// The box of some members.
    fn around(&self, members: &Range<usize>) -> Aabb {
        let boxes = self.members[members.clone()].iter().map(|(_, own)| own);
        boxes.fold(Aabb::INVALID, |all, own| all.union(own))
    }
}

/// The members of a heap by size, without copies that others hide. Around one another, the outer ones hide
/// the inner.
fn ordered(geometry: &Geometry, mut members: Vec<(Entry, Aabb)>) -> Vec<(Entry, Aabb)> {
    members.sort_unstable_by_key(|(single, _)| single.number);
    let mut known = HashSet::new();
    members.retain(|(single, _)| {
        let Some(corners) = single.corners else { return true };
        let has_holes = !geometry.cutouts.is_empty() && geometry.cutout(single.number).is_some();
        if has_holes || geometry.is_transparent(single.number) {
            return true;
        }
        // Zeros of both signs are one place.
        let bits = |v: u32| (geometry.positions[v as usize] + 0.0).to_array().map(f32::to_bits);
        let mut corners = corners.map(bits);
        corners.sort_unstable();
        known.insert(corners)
    });
    members.sort_by(|(_, a), (_, b)| a.half_area().total_cmp(&b.half_area()));
    members
}

/// The heaps among `boxes`, as lists of indices in rising order. `whole` is the scene's box.
fn heaps(boxes: &[Aabb], whole: &Aabb) -> Vec<Vec<u32>> {
    if boxes.len() <= LEAST {
        return Vec::new();
    }
    let step = whole.diagonal().max_element() / STEPS;
    // Nearly every scene has none, and a pass over small counters proves it.
    let mask = (boxes.len() / 2).next_power_of_two().min(MOST_COUNTERS) - 1;
    let mut counters = vec![0_u32; mask + 1];
    let cells = || boxes.iter().map(|b| cell(b, whole.min, step));
    for cell in cells().flatten() {
        counters[hash(cell) & mask] += 1;
    }
    let usual = LEAST + 8 * (boxes.len() / (mask + 1));
    if counters.iter().all(|&count| count as usize <= usual) {
        return Vec::new();
    }
    let suspicious = |cell: [i32; 3]| counters[hash(cell) & mask] as usize > usual;
    let mut members: HashMap<[i32; 3], Vec<u32>> = HashMap::new();
    for (index, cell) in cells().enumerate() {
        if let Some(cell) = cell.filter(|&c| suspicious(c)) {
            members.entry(cell).or_default().push(index as u32);
        }
    }
    let mut heaps: Vec<_> = members.into_values().filter(|m| m.len() > LEAST).collect();
    heaps.sort_unstable_by_key(|m| m[0]);
    heaps
}

/// The centre of a large box in steps, rounded: no centre is left of `low`.
fn cell(b: &Aabb, low: Vec3A, step: f32) -> Option<[i32; 3]> {
    let large = b.diagonal().max_element() > LARGE * step;
    large.then(|| ((b.center() - low) / step + 0.5).to_array().map(|x| x as i32))
}

fn hash(cell: [i32; 3]) -> usize {
    let mix = |h: u32, &x: &i32| (h ^ x as u32).wrapping_mul(0x9E37_79B1).rotate_left(15);
    cell.iter().fold(0, mix) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(center: Vec3A, half: f32) -> Aabb {
        Aabb::new(center - half, center + half)
    }

    fn heaps(boxes: &[Aabb]) -> Vec<Vec<u32>> {
        super::heaps(boxes, &boxes.iter().fold(Aabb::INVALID, |all, b| all.union(b)))
    }

    #[test]
    fn a_heap_is_found_among_others() {
        let mut boxes: Vec<Aabb> =
            (0..1000).map(|i| cube(Vec3A::new(i as f32 * 0.37, 0.0, 0.0), 0.1)).collect();
        assert!(heaps(&boxes).is_empty());
        let center = Vec3A::new(77.5, 0.0, 0.0);
        boxes.extend((1..=100).map(|i| cube(center, i as f32 * 0.01 + 0.05)));
        assert_eq!(heaps(&boxes), vec![(1000..1100).collect::<Vec<u32>>()]);
    }

    #[test]
    fn detail_in_a_vast_scene_is_no_heap() {
        let mut boxes = vec![cube(Vec3A::ZERO, 1e7)];
        boxes.extend((0..10_000).map(|i| cube(Vec3A::new(i as f32 * 1e-4, 0.0, 0.0), 1e-4)));
        assert!(heaps(&boxes).is_empty());
    }
}
