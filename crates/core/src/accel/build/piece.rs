//! A piece: some primitives, obvhs's hierarchy over them, and its conversion.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::PlocBuilder;

use super::coincident::Heaps;
use super::weld::weld;
use super::{CurveLeaf, Entry, LeafFinder, Preset, WELD_ABOVE};
use crate::accel::wide::{Converter, Output, Owner, Part};
use crate::geometry::Geometry;
use crate::kernels::Aabb;
use crate::math::LANES;

/// The scene, and how to build its pieces.
pub(super) struct BuildPlan<'a> {
    pub(super) geometry: &'a Geometry,
    pub(super) preset: Preset,
    /// A box around everything.
    pub(super) extents: Aabb,
    /// Whether vertices repeat positions and are compared by them.
    pub(super) weld: bool,
    /// The boxes of instances, without those that show nothing, each with the number of its instance.
    pub(super) instances: Vec<(u32, Aabb)>,
}

impl<'a> BuildPlan<'a> {
    pub(super) fn new(geometry: &'a Geometry, preset: Preset, extents: Aabb) -> Self {
        let weld = geometry.positions.len() > WELD_ABOVE * geometry.triangles.len() / 4;
        Self { geometry, preset, extents, weld, instances: Vec::new() }
    }
}

/// Builds pieces in turn, and reuses its memory.
#[derive(Default)]
pub(super) struct Piece {
    /// Those it was last built over.
    pub(super) entries: Vec<u32>,
    ploc: PlocBuilder,
    bvh: Bvh2,
    optimizer: ReinsertionOptimizer,
    boxes: Vec<obvhs::aabb::Aabb>,
    members: Members,
    finder: LeafFinder,
    /// The table of welded vertices.
    welded: Vec<u32>,
    converter: Converter,
    pub(super) output: Output,
}

/// The primitives of each owner: of leaves if they are found first, else of singles, then members of
/// heaps.
#[derive(Default)]
struct Members {
    singles: Vec<Entry>,
    heaps: Heaps,
    leaves: Vec<CurveLeaf>,
}

impl Members {
    /// The number of owners outside of heaps: either list is empty.
    #[inline(always)]
    fn alone(&self) -> usize {
        self.leaves.len() + self.singles.len()
    }

    /// The owner with that number.
    #[inline(always)]
    fn owner(&self, owner: u32) -> Owner<'_> {
        let owner = owner as usize;
        if let Some(leaf) = self.leaves.get(owner) {
            return match &leaf.shared {
                Some(shared) => Owner::Patch(shared, &leaf.numbers[..leaf.count]),
                None => Owner::Other(leaf.numbers[0]),
            };
        }
        let single = self.singles.get(owner);
        let single = single.unwrap_or_else(|| &self.heaps.members[owner - self.alone()].0);
        match single.corners {
            Some(corners) => Owner::Triangle(single.number, corners),
            None => Owner::Other(single.number),
        }
    }
}

impl Piece {
    /// Builds the hierarchy over these entries of the scene, at least one, and writes it to the
    /// output in about `parts` parts. The numbers of its leaves take the place of the entries.
    pub(super) fn parts(
        &mut self,
        plan: &BuildPlan,
        numbers: &[AtomicU32],
        entries: Range<usize>,
        parts: usize,
    ) -> Vec<Part> {
        self.output.clear(entries.start);
        let numbers = &numbers[entries];
        self.entries.clear();
        self.entries.extend(numbers.iter().map(|number| number.load(Ordering::Relaxed)));
        self.build(plan);
        // Those of a heap alone would be one to whoever joins them.
        let parts = self.emit(plan, if self.members.alone() == 0 { 1 } else { parts });
        let new = &self.output.numbers;
        numbers.iter().zip(new).for_each(|(number, &new)| number.store(new, Ordering::Relaxed));
        parts
    }

    /// Builds the hierarchy over the entries, and decides its conversion.
    fn build(&mut self, plan: &BuildPlan) {
        self.gather(plan);
        let Members { singles, heaps, leaves } = &mut self.members;
        heaps.gather(plan.geometry, &to_obvhs(plan.extents), (singles, &mut self.boxes));
        match plan.preset {
            // A terrain takes 38.9 bytes a triangle instead of 49.6, and rays visit 1 to 4 per cent
            // fewer nodes; the build of a kitchen takes 15 per cent more time.
            Preset::OnDemand => self.finder.find::<LANES>(singles, leaves, &mut self.boxes),
            Preset::Fastest => self.finder.find::<1>(singles, leaves, &mut self.boxes),
            _ => {}
        }
        // Reuses the list of the last piece.
        let mut owners = std::mem::take(&mut self.bvh.primitive_indices);
        owners.clear();
        owners.extend(0..self.boxes.len() as u32);
        let parameters = plan.preset.parameters();
        self.ploc.build_with_bvh(
            &mut self.bvh,
            parameters.ploc_search_distance,
            &self.boxes,
            owners,
            parameters.sort_precision,
            parameters.search_depth_threshold,
        );
        let ratio = parameters.reinsertion_batch_ratio;
        self.optimizer.run(&mut self.bvh, ratio, plan.preset.rounds());
        self.members.heaps.open(&mut self.bvh, self.members.alone());
        self.converter.evaluate(&self.bvh, |owner| self.members.owner(owner));
    }

    /// Computes a box for each entry.
    fn gather(&mut self, plan: &BuildPlan) {
        let entries = &self.entries;
        let geometry = plan.geometry;
        let Members { singles, leaves, .. } = &mut self.members;
        leaves.clear();
        singles.clear();
        singles.extend(entries.iter().map(|&entry| Entry {
            number: geometry.number_of(entry),
            corners: geometry.corners_of(entry),
        }));
        // In a separate loop, short enough for the processor to have many loads in flight.
        self.boxes.clear();
        self.boxes.extend(singles.iter().zip(entries).map(|(single, &entry)| {
            let around = match single.corners {
                Some(corners) => Aabb::around(corners.map(|v| geometry.positions[v as usize])),
                None => geometry.box_of(entry),
            };
            to_obvhs(around)
        }));
        if plan.weld {
            let triangles = singles.iter_mut().filter_map(|single| single.corners.as_mut());
            weld(&geometry.positions, triangles, entries.len(), &mut self.welded);
        }
    }

    /// Cuts the piece into about `parts` parts and writes each to `output`.
    ///
    /// Parts are nodes and leaves as in the whole piece, so that a tree with other nodes above them
    /// has about the same below. The largest boxes are opened first, so that a large triangle does
    /// not share a box with small ones.
    fn emit(&mut self, plan: &BuildPlan, parts: usize) -> Vec<Part> {
        let part = |place: u32| {
            let (unit, owner) = (self.output.units.len(), |owner| self.members.owner(owner));
            let output = &mut self.output;
            let kind = self.converter.emit(plan.geometry, &self.bvh, owner, place, output);
            let bounds = from_obvhs(self.bvh.nodes[place as usize].aabb());
            Part { bounds, kind, unit, cost: self.converter.cost(place) }
        };
        cut_off(&self.bvh, &self.converter, parts).into_iter().map(part).collect()
    }
}

/// The places of about `parts` parts, in rising order.
fn cut_off(bvh: &Bvh2, converter: &Converter, parts: usize) -> Vec<u32> {
    let area = |place: u32| bvh.nodes[place as usize].aabb().half_area();
    let mut open = vec![(area(0), 0)];
    let (mut cut, mut children) = (Vec::new(), Vec::new());
    while open.len() + cut.len() < parts && !open.is_empty() {
        // Few enough to find the largest by a linear search.
        let larger = |a: usize, b: usize| if open[b].0 > open[a].0 { b } else { a };
        let largest = (0..open.len()).fold(0, larger);
        let (_, place) = open.swap_remove(largest);
        if converter.is_leaf(place) {
            cut.push(place);
        } else {
            converter.children(bvh, place, &mut children);
            open.extend(children.iter().map(|&child| (area(child as u32), child as u32)));
        }
    }
    cut.extend(open.iter().map(|&(_, place)| place));
    cut.sort_unstable();
    cut
}

pub(super) fn to_obvhs(b: Aabb) -> obvhs::aabb::Aabb {
    obvhs::aabb::Aabb::new(b.low.into(), b.high.into())
}

pub(super) fn from_obvhs(b: &obvhs::aabb::Aabb) -> Aabb {
    Aabb { low: b.min.into(), high: b.max.into() }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use obvhs::bvh2::DEFAULT_MAX_STACK_DEPTH;

    use super::*;

    /// Needles from one corner to a line, and such as begin beside it: each box is in the next, more or less.
    #[test]
    fn a_fan_takes_few_rounds() {
        for begin in [0.0, 0.01] {
            check_rounds(begin);
        }
    }

    fn check_rounds(begin: f32) {
        const COUNT: u32 = 5000;
        let end = |i: u32| Vec3::new(1.0, i as f32 / COUNT as f32, 0.0);
        let mut positions: Vec<_> = (0..=COUNT).map(end).collect();
        positions.extend((0..COUNT).map(|i| end(i) * begin));
        let needle = |i| [if begin > 0.0 { COUNT + 1 + i } else { COUNT + 1 }, i, i + 1];
        let triangles = (0..COUNT).map(needle).collect();
        let geometry = Geometry { positions: positions.into(), triangles, ..Geometry::default() };
        let numbers: Vec<_> = (0..COUNT).map(AtomicU32::new).collect();
        let extents = Aabb { low: Vec3::ZERO, high: Vec3::ONE };
        for preset in Preset::ALL {
            let mut piece = Piece::default();
            let plan = BuildPlan::new(&geometry, preset, extents);
            piece.parts(&plan, &numbers, 0..numbers.len(), 1);
            // obvhs notes the rounds above that number.
            assert_eq!(piece.bvh.max_depth, DEFAULT_MAX_STACK_DEPTH, "{preset}");
        }
    }
}
