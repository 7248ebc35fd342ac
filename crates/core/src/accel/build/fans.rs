//! Finds fans: many triangles around one vertex, such as needles, or around no vertex, but as large as the piece.
//!
//! Their boxes overlap as those of a heap do ([`super::coincident`]), and a bottom-up builder takes as long: the smallest
//! box is the best partner of all others. So a fan is opened like a heap, along Morton's curve.

use std::collections::HashMap;

use obvhs::aabb::Aabb;

use super::entries::Entry;
use super::leaves::sort;

/// A fan has more triangles than this: so many rounds of the builder take no longer than all else.
const LEAST: u32 = 256;

/// Bits of the number of counters of the first pass, which stay in the first-level cache: of a chunk of a usual mesh each
/// counts a dozen corners.
const COUNTER_BITS: u32 = 12;

/// A box is large whose surface is more than that of the box around all, divided by this.
const LARGE: f32 = 64.0;

/// So many large boxes take the builder some milliseconds. With more, a ray into the piece meets dozens, however they are joined.
const MOST_LARGE: usize = 1024;

/// The fans among `singles`, as lists of indices in rising order. A triangle is in the largest of its corners.
pub(super) fn fans(singles: &[Entry]) -> Vec<Vec<u32>> {
    // Nearly every scene has none, and a pass over few counters proves it.
    let mut counters = [0_u32; 1 << COUNTER_BITS];
    let slot =
        |vertex: u32| (vertex.wrapping_mul(0x9E37_79B1) >> (u32::BITS - COUNTER_BITS)) as usize;
    let corners = || singles.iter().filter_map(|single| single.corners);
    corners().flatten().for_each(|vertex| counters[slot(vertex)] += 1);
    if counters.iter().all(|&count| count <= LEAST) {
        return Vec::new();
    }
    let mut counts: HashMap<u32, u32> = HashMap::new();
    for vertex in corners().flatten().filter(|&vertex| counters[slot(vertex)] > LEAST) {
        *counts.entry(vertex).or_default() += 1;
    }
    counts.retain(|_, count| *count > LEAST);
    let mut members: HashMap<u32, Vec<u32>> = HashMap::new();
    for (index, single) in singles.iter().enumerate() {
        let known = single.corners.into_iter().flatten();
        let known = known.filter_map(|vertex| Some((*counts.get(&vertex)?, vertex)));
        if let Some((_, vertex)) = known.max() {
            members.entry(vertex).or_default().push(index as u32);
        }
    }
    let mut fans: Vec<_> = members.into_values().collect();
    fans.sort_unstable_by_key(|members| members[0]);
    fans
}

/// The boxes that are large, if they are many.
pub(super) fn large(boxes: &[Aabb]) -> Option<Vec<u32>> {
    let around = boxes.iter().fold(Aabb::INVALID, |all, own| all.union(own));
    let least = around.half_area() / LARGE;
    let is_large = |own: &Aabb| own.half_area() > least;
    let count = boxes.iter().filter(|own| is_large(own)).count();
    let found = || (0..).zip(boxes).filter(|(_, own)| is_large(own)).map(|(index, _)| index);
    (count > MOST_LARGE).then(|| found().collect())
}

/// The members of a fan along the curve.
pub(super) fn ordered(members: &[(Entry, Aabb)]) -> Vec<(Entry, Aabb)> {
    let boxes: Vec<_> = members.iter().map(|(_, own)| *own).collect();
    let mut keys = Vec::new();
    sort(&boxes, &mut keys, &mut Vec::new());
    keys.into_iter().map(|key| members[key as u32 as usize]).collect()
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::*;

    #[test]
    fn a_fan_is_found_among_others() {
        let entry = |number, corners| Entry { number, corners: Some(corners) };
        let strip = |i: u32| entry(i, [i, i + 1, i + 2]);
        let mut singles: Vec<Entry> = (0..5000).map(strip).collect();
        assert!(fans(&singles).is_empty());
        singles.extend((5000..5300).map(|i| entry(i, [2 * i, 7000, 2 * i + 1])));
        // Too few.
        singles.extend((5300..5400).map(|i| entry(i, [3 * i, 8000, 3 * i + 1])));
        assert_eq!(fans(&singles), vec![(5000..5300).collect::<Vec<u32>>()]);
    }

    #[test]
    fn many_large_boxes_are_found() {
        let row =
            |size: f32| move |i| Aabb::new(Vec3A::splat(i as f32), Vec3A::splat(i as f32 + size));
        let mut boxes: Vec<_> = (0..2000).map(row(1.0)).collect();
        boxes.extend((0..1000).map(row(1000.0)));
        assert_eq!(large(&boxes), None);
        boxes.extend((0..1000).map(row(1000.0)));
        assert_eq!(large(&boxes), Some((2000..4000).collect()));
    }
}
