//! A piece: some primitives, obvhs's hierarchy over them, and its conversion.

use std::ops::Range;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::PlocBuilder;
use obvhs::splits::split_aabbs_preset;

use super::leaves::{Finder, Leaf};
use super::weld::Welder;
use crate::accel::coincident;
use crate::accel::geometry::{Geometry, Primitive};
use crate::accel::wide::{Converter, Hierarchy, Output, Owner, Part};
use crate::kernels::quad;
use crate::kernels::slab::Aabb;

/// The scene, and how to build its pieces.
pub(super) struct Plan<'a> {
    pub(super) geometry: &'a Geometry,
    /// A box around everything.
    pub(super) extents: Aabb,
    pub(super) parameters: &'a BvhBuildParams,
    /// Rounds of reinsertion: see [`super::Preset::rounds`].
    pub(super) rounds: Option<Vec<f32>>,
    /// Whether there is only one piece: memory is then freed as soon as possible.
    pub(super) once: bool,
    /// Whether vertices repeat positions and are compared by them.
    pub(super) weld: bool,
    /// Whether to find leaves before the hierarchy.
    pub(super) leaves_first: bool,
}

/// Builds pieces in turn, and reuses its memory.
#[derive(Default)]
pub(super) struct Piece {
    ploc: PlocBuilder,
    bvh: Bvh2,
    optimizer: ReinsertionOptimizer,
    boxes: Vec<obvhs::aabb::Aabb>,
    members: Members,
    finder: Finder,
    welder: Welder,
    converter: Converter,
    cut: Vec<u32>,
    pub(super) output: Output,
}

/// The primitives of each owner.
#[derive(Default)]
pub(super) struct Members {
    /// Owners of one primitive.
    pub(super) singles: Vec<Single>,
    /// The following owners, of several primitives.
    heaps: Vec<Vec<u32>>,
    /// Number of triangles and quads, which come first.
    pub(super) flat: u32,
    /// Cut-outs among these: tested alone, in lists.
    pub(super) cutouts: Vec<Range<u32>>,
    /// Owners instead of `singles` if leaves are found first, and the numbers in them.
    pub(super) leaves: Vec<Leaf>,
    pub(super) numbers: Vec<u32>,
}

/// A primitive with the vertices of triangles.
#[derive(Clone, Copy)]
pub(super) struct Single {
    pub(super) number: u32,
    pub(super) corners: [u32; 3],
}

impl Members {
    /// Whether the primitive is tested in lanes, as triangles are.
    #[inline(always)]
    pub(super) fn is_in_lanes(&self, number: u32) -> bool {
        is_in_lanes(number, self.flat, &self.cutouts)
    }

    /// The owner with that number.
    #[inline(always)]
    fn owner(&self, owner: u32) -> Owner<'_> {
        match self.singles.get(owner as usize) {
            Some(s) if self.is_in_lanes(s.number) => Owner::Triangle(s.number, s.corners),
            Some(s) => Owner::Other(s.number),
            None => Owner::Heap(&self.heaps[owner as usize - self.singles.len()]),
        }
    }

    /// As [`Self::owner`], if leaves were found first.
    #[inline(always)]
    fn leaf(&self, owner: u32) -> Owner<'_> {
        let Some(leaf) = self.leaves.get(owner as usize) else {
            return Owner::Heap(&self.heaps[owner as usize - self.leaves.len()]);
        };
        let numbers = &self.numbers[leaf.first as usize..][..leaf.count as usize];
        if self.is_in_lanes(numbers[0]) {
            Owner::Patch(&leaf.shared, numbers)
        } else {
            Owner::Other(numbers[0])
        }
    }
}

/// Whether the primitive is one of the first `flat` and not a cut-out.
#[inline(always)]
pub(super) fn is_in_lanes(number: u32, flat: u32, cutouts: &[Range<u32>]) -> bool {
    let is_cut_out = || {
        let after = cutouts.partition_point(|range| range.start <= number);
        after > 0 && cutouts[after - 1].contains(&number)
    };
    number < flat && (cutouts.is_empty() || !is_cut_out())
}

impl Piece {
    /// Builds the hierarchy over the primitives with these numbers, at least one, and decides its
    /// conversion.
    pub(super) fn build(&mut self, plan: &Plan, numbers: &[u32]) {
        self.gather(plan, numbers);
        self.gather_heaps(&plan.extents);
        if plan.leaves_first {
            self.finder.find(&mut self.members, &mut self.boxes);
        }
        // Reuses the list of the last piece.
        let mut owners = std::mem::take(&mut self.bvh.primitive_indices);
        owners.clear();
        owners.extend(0..self.boxes.len() as u32);
        if plan.parameters.pre_split {
            self.split_large_triangles(plan.geometry, &mut owners);
        }
        let Plan { parameters, rounds, .. } = plan;
        self.ploc.build_with_bvh(
            &mut self.bvh,
            parameters.ploc_search_distance,
            &self.boxes,
            owners,
            parameters.sort_precision,
            parameters.search_depth_threshold,
        );
        self.bvh.uses_spatial_splits = parameters.pre_split;
        let ratio = parameters.reinsertion_batch_ratio;
        self.optimizer.run(&mut self.bvh, ratio, rounds.clone());
        if plan.once {
            self.ploc = PlocBuilder::new();
            self.optimizer = ReinsertionOptimizer::default();
            self.boxes = Vec::new();
        }
        let (members, tree) = (&self.members, view(&self.bvh));
        if plan.leaves_first {
            self.converter.evaluate(tree, |owner| members.leaf(owner));
        } else {
            self.converter.evaluate(tree, |owner| members.owner(owner));
        }
    }

    /// Computes a box for each primitive.
    fn gather(&mut self, plan: &Plan, numbers: &[u32]) {
        let geometry = plan.geometry;
        self.members.flat = (geometry.triangles.len() + geometry.quads.len()) as u32;
        let cutouts = geometry.cutouts.iter().map(|cutout| cutout.primitives.clone());
        self.members.cutouts = cutouts.collect();
        self.members.singles.clear();
        self.boxes.clear();
        for &number in numbers {
            match geometry.primitive(number) {
                Primitive::Triangle(i) => self.add(number, geometry.triangles[i], Aabb::EMPTY),
                Primitive::Quad(i) => {
                    let corners = quad::halves(&geometry.quads[i]);
                    for (half, corners) in quad::halves(&geometry.quad(i)).into_iter().zip(corners)
                    {
                        self.add(number, corners, geometry.padded(Aabb::around(half)));
                    }
                }
                _ => self.add(number, [0; 3], geometry.bounds(number)),
            }
        }
        // Triangles' boxes in a separate loop, short enough for the processor to have many loads
        // in flight.
        let triangles = geometry.triangles.len() as u32;
        for (single, bounds) in self.members.singles.iter().zip(&mut self.boxes) {
            if single.number < triangles {
                let corners = single.corners.map(|v| geometry.positions[v as usize]);
                *bounds = to_obvhs(geometry.padded(Aabb::around(corners)));
            }
        }
        if plan.weld {
            let count = self.members.singles.len();
            let triangles = self.members.singles.iter_mut();
            let triangles = triangles.filter(|s| s.number < self.members.flat);
            self.welder.weld(&geometry.positions, triangles.map(|s| &mut s.corners), count);
        }
    }

    /// Removes the members of heaps from both lists and appends the box of each heap.
    fn gather_heaps(&mut self, extents: &Aabb) {
        self.members.heaps.clear();
        let heaps = coincident::heaps(&self.boxes, &to_obvhs(*extents));
        if heaps.is_empty() {
            return;
        }
        let (boxes, singles) = (&mut self.boxes, &mut self.members.singles);
        let mut in_heap = vec![false; boxes.len()];
        heaps.iter().flatten().for_each(|&i| in_heap[i as usize] = true);
        let unions: Vec<_> = heaps
            .iter()
            .map(|heap| {
                let all = |u: obvhs::aabb::Aabb, &i: &u32| u.union(&boxes[i as usize]);
                heap.iter().fold(obvhs::aabb::Aabb::INVALID, all)
            })
            .collect();
        let numbers = |heap: &Vec<u32>| heap.iter().map(|&i| singles[i as usize].number).collect();
        self.members.heaps = heaps.iter().map(numbers).collect();
        let mut flags = in_heap.iter();
        singles.retain(|_| flags.next() == Some(&false));
        let mut flags = in_heap.iter();
        boxes.retain(|_| flags.next() == Some(&false));
        boxes.extend(unions);
    }

    fn add(&mut self, number: u32, corners: [u32; 3], bounds: Aabb) {
        self.members.singles.push(Single { number, corners });
        self.boxes.push(to_obvhs(bounds));
    }

    /// Splits the boxes of triangles that are much larger than the average, as obvhs's own presets
    /// do. The owner of box `i` is `i`, except for parts of split triangles, which come last: obvhs
    /// relies on this.
    fn split_large_triangles(&mut self, geometry: &Geometry, owners: &mut Vec<u32>) {
        let Members { singles, flat, .. } = &self.members;
        let end = singles.partition_point(|s| s.number < *flat);
        if end == 0 {
            return;
        }
        let triangles: Vec<obvhs::triangle::Triangle> = singles[..end]
            .iter()
            .map(|single| {
                let corners = single.corners.map(|v| geometry.positions[v as usize]);
                let [v0, v1, v2] = corners.map(Vec3A::from);
                obvhs::triangle::Triangle { v0, v1, v2 }
            })
            .collect();
        let mut parts = self.boxes[..end].to_vec();
        let mut part_owners = owners[..end].to_vec();
        let areas = || parts.iter().map(obvhs::aabb::Aabb::half_area);
        let (sum, largest) =
            areas().fold((0.0_f64, 0.0_f32), |(s, l), a| (s + f64::from(a), l.max(a)));
        let average = (sum / end as f64) as f32;
        split_aabbs_preset(&mut parts, &mut part_owners, &triangles, average, largest);
        for (part, &owner) in parts.iter_mut().zip(&part_owners) {
            let whole = from_obvhs(&self.boxes[owner as usize]);
            *part = to_obvhs(geometry.padded_as_part(from_obvhs(part), &whole));
        }
        self.boxes[..end].copy_from_slice(&parts[..end]);
        self.boxes.extend_from_slice(&parts[end..]);
        owners.extend_from_slice(&part_owners[end..]);
    }

    /// Writes the piece as one, to `output`.
    pub(super) fn emit_whole(&mut self, plan: &Plan) -> Part {
        self.emit(plan, 0)
    }

    /// Cuts the piece into about `parts` parts and writes each to `output`.
    ///
    /// Parts are nodes and leaves as in the whole piece, so that a tree with other nodes above them
    /// has about the same below. The largest boxes are opened first, so that a large triangle does
    /// not share a box with small ones.
    pub(super) fn emit_parts(&mut self, plan: &Plan, parts: usize) -> Vec<Part> {
        self.cut_off(parts);
        let places = std::mem::take(&mut self.cut);
        let parts = places.iter().map(|&place| self.emit(plan, place)).collect();
        self.cut = places;
        parts
    }

    /// Writes the places of about `parts` parts to `cut`, in rising order.
    fn cut_off(&mut self, parts: usize) {
        let nodes = &self.bvh.nodes;
        let area = |place: u32| nodes[place as usize].aabb().half_area();
        let mut open = vec![(area(0), 0)];
        self.cut.clear();
        while open.len() + self.cut.len() < parts && !open.is_empty() {
            // Few enough to find the largest by a linear search.
            let larger = |a: usize, b: usize| if open[b].0 > open[a].0 { b } else { a };
            let largest = (0..open.len()).fold(0, larger);
            let (_, place) = open.swap_remove(largest);
            if self.converter.is_leaf(place) {
                self.cut.push(place);
            } else {
                let children = self.converter.children(view(&self.bvh), place);
                open.extend(children.places().iter().map(|&child| (area(child), child)));
            }
        }
        self.cut.extend(open.iter().map(|&(_, place)| place));
        self.cut.sort_unstable();
    }

    fn emit(&mut self, plan: &Plan, place: u32) -> Part {
        let unit = self.output.units.len();
        let (members, tree, output) = (&self.members, view(&self.bvh), &mut self.output);
        let kind = if plan.leaves_first {
            self.converter.emit(plan.geometry, tree, |owner| members.leaf(owner), place, output)
        } else {
            self.converter.emit(plan.geometry, tree, |owner| members.owner(owner), place, output)
        };
        let bounds = from_obvhs(self.bvh.nodes[place as usize].aabb());
        Part { bounds, kind, unit, cost: self.converter.cost(place) }
    }
}

/// The hierarchy in the form of the converter.
pub(super) fn view(bvh: &Bvh2) -> Hierarchy<'_> {
    Hierarchy { nodes: &bvh.nodes, owners: &bvh.primitive_indices }
}

pub(super) fn to_obvhs(b: Aabb) -> obvhs::aabb::Aabb {
    obvhs::aabb::Aabb::new(b.low.into(), b.high.into())
}

pub(super) fn from_obvhs(b: &obvhs::aabb::Aabb) -> Aabb {
    Aabb { low: b.min.into(), high: b.max.into() }
}
