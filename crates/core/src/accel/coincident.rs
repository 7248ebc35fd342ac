//! Finds heaps: many large boxes around one point, such as concentric spheres or layers of the same
//! shape.
//!
//! No hierarchy helps there, and a bottom-up builder does worst of all: it merges one pair a round,
//! with quadratic time and a tree as deep as the heap is large. A heap therefore enters the tree as
//! one box, and its members are tested one by one.

use std::collections::HashMap;

use glam::Vec3A;
use obvhs::aabb::Aabb;

/// A heap has more members than this.
const LEAST: usize = 64;

/// Centres within the same of this many steps across the scene count as one point.
const STEPS: f32 = (1 << 20) as f32;

/// Boxes smaller than this many steps are not large: they are details of a vast scene.
const LARGE: f32 = 16.0;

/// Largest number of counters of the first pass.
const MOST_COUNTERS: usize = 1 << 16;

/// The heaps among `boxes`, as lists of indices in rising order. `whole` is the scene's box.
pub(super) fn heaps(boxes: &[Aabb], whole: &Aabb) -> Vec<Vec<u32>> {
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
