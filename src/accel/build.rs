//! Building the tree: obvhs makes a binary hierarchy (PLOC of Meister and Bittner 2018, with
//! reinsertion), which is then laid out as the nodes that we traverse.
//!
//! obvhs sees padded boxes and decides topology alone; what is a hit, is decided by
//! [`Geometry::hit`].

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::PlocBuilder;
use obvhs::splits::split_aabbs_preset;
use rayon::prelude::*;

use super::arena::{self, Arena};
use super::coincident;
use super::geometry::Geometry;
use super::tree::{Root, Tree};
use super::units::Units;
use super::wide::{Binary, Converter, Owner};
use crate::kernels::slab::Aabb;

/// How much work goes into the tree. All but [`Preset::Brute`] are presets of obvhs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// No tree: every primitive is tested. The reference.
    Brute,
    /// The quickest build, clearly slower to trace.
    Fastest,
    /// A little reinsertion.
    VeryFast,
    /// A wider search and more reinsertion.
    Fast,
    /// More of both.
    Medium,
    /// Large triangles are split first.
    Slow,
    /// Everything is reinserted.
    VerySlow,
}

impl Preset {
    /// Every preset, quickest build first.
    pub const ALL: [Self; 7] = [
        Self::Brute,
        Self::Fastest,
        Self::VeryFast,
        Self::Fast,
        Self::Medium,
        Self::Slow,
        Self::VerySlow,
    ];

    /// The preset that is likely to finish first, for so many primitives and expected rays.
    ///
    /// A better tree costs time for each primitive and saves a few per cent of the time of each
    /// ray, so it pays from a certain number of rays for each primitive on.
    pub fn choose(primitives: u64, rays: u64) -> Self {
        match rays / primitives.max(1) {
            0..=3 => Self::VeryFast,
            4..=63 => Self::Fast,
            _ => Self::Medium,
        }
    }

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Brute => "brute",
            Self::Fastest => "fastest",
            Self::VeryFast => "very-fast",
            Self::Fast => "fast",
            Self::Medium => "medium",
            Self::Slow => "slow",
            Self::VerySlow => "very-slow",
        }
    }

    fn parameters(self) -> BvhBuildParams {
        match self {
            Self::Brute | Self::Fastest => BvhBuildParams::fastest_build(),
            Self::VeryFast => BvhBuildParams::very_fast_build(),
            Self::Fast => BvhBuildParams::fast_build(),
            Self::Medium => BvhBuildParams::medium_build(),
            Self::Slow => BvhBuildParams::slow_build(),
            Self::VerySlow => BvhBuildParams::very_slow_build(),
        }
    }
}

/// What the hierarchy is built over: boxes, and who is in each.
struct References {
    boxes: Vec<obvhs::aabb::Aabb>,
    /// For each box, its owner. The owner of box `i` is `i` itself but for the parts of split
    /// triangles, which come last: obvhs relies on this.
    owners: Vec<u32>,
    members: Members,
}

/// The primitives of each owner.
struct Members {
    /// Owners of one primitive.
    singles: Vec<u32>,
    /// The owners after them, of many.
    heaps: Vec<Vec<u32>>,
}

/// Builds the tree over every primitive that can be hit.
pub fn build(geometry: &Geometry, preset: Preset) -> Tree {
    let parameters = preset.parameters();
    let References { boxes, owners, members } = references(geometry, parameters.pre_split);
    if boxes.is_empty() {
        return Tree::default();
    }
    let bvh = hierarchy(boxes, owners, &parameters);
    lay_out(geometry, &bvh, &members)
}

/// A box for each primitive that can be hit, more than one for large triangles if `split`, one
/// together for the members of a heap.
fn references(geometry: &Geometry, split: bool) -> References {
    let mut singles: Vec<u32> = (0..geometry.len() as u32)
        .into_par_iter()
        .filter(|&number| !geometry.is_degenerate(number))
        .collect();
    let mut boxes: Vec<_> = singles.par_iter().map(|&n| to_obvhs(geometry.bounds(n))).collect();
    let heaps = gather_heaps(&mut singles, &mut boxes);
    let mut all = References {
        owners: (0..boxes.len() as u32).collect(),
        boxes,
        members: Members { singles, heaps },
    };
    if split {
        split_large_triangles(geometry, &mut all);
    }
    all
}

/// Takes the members of heaps out of both lists and appends the box of each heap.
fn gather_heaps(singles: &mut Vec<u32>, boxes: &mut Vec<obvhs::aabb::Aabb>) -> Vec<Vec<u32>> {
    let heaps = coincident::heaps(boxes);
    if heaps.is_empty() {
        return heaps;
    }
    let mut in_heap = vec![false; boxes.len()];
    heaps.iter().flatten().for_each(|&i| in_heap[i as usize] = true);
    let numbers = |heap: &Vec<u32>| heap.iter().map(|&i| singles[i as usize]).collect();
    let members = heaps.iter().map(numbers).collect();
    let unions: Vec<_> = heaps
        .iter()
        .map(|heap| {
            let all = |u: obvhs::aabb::Aabb, &i: &u32| u.union(&boxes[i as usize]);
            heap.iter().fold(obvhs::aabb::Aabb::INVALID, all)
        })
        .collect();
    let mut flags = in_heap.iter();
    singles.retain(|_| flags.next() == Some(&false));
    let mut flags = in_heap.iter();
    boxes.retain(|_| flags.next() == Some(&false));
    boxes.extend(unions);
    members
}

/// Splits the boxes of triangles that are much larger than the average, as obvhs's own presets do.
fn split_large_triangles(geometry: &Geometry, all: &mut References) {
    let singles = &all.members.singles;
    let end = singles.partition_point(|&n| (n as usize) < geometry.triangles.len());
    if end == 0 {
        return;
    }
    let triangles: Vec<obvhs::triangle::Triangle> = singles[..end]
        .par_iter()
        .map(|&number| {
            let [v0, v1, v2] = geometry.triangle(number as usize).map(Vec3A::from);
            obvhs::triangle::Triangle { v0, v1, v2 }
        })
        .collect();
    let mut parts = all.boxes[..end].to_vec();
    let mut owners = all.owners[..end].to_vec();
    let areas = || parts.iter().map(obvhs::aabb::Aabb::half_area);
    let (sum, largest) = areas().fold((0.0_f64, 0.0_f32), |(s, l), a| (s + f64::from(a), l.max(a)));
    let average = (sum / end as f64) as f32;
    split_aabbs_preset(&mut parts, &mut owners, &triangles, average, largest);
    // A part's box ends at points that were computed: the bound is added to it once more.
    parts.par_iter_mut().for_each(|b| *b = to_obvhs(from_obvhs(b).padded()));
    all.boxes[..end].copy_from_slice(&parts[..end]);
    all.boxes.extend_from_slice(&parts[end..]);
    all.owners.extend_from_slice(&owners[end..]);
}

/// obvhs's binary hierarchy.
fn hierarchy(boxes: Vec<obvhs::aabb::Aabb>, owners: Vec<u32>, parameters: &BvhBuildParams) -> Bvh2 {
    let mut bvh = PlocBuilder::with_capacity(boxes.len()).build(
        parameters.ploc_search_distance,
        &boxes,
        owners,
        parameters.sort_precision,
        parameters.search_depth_threshold,
    );
    drop(boxes);
    bvh.uses_spatial_splits = parameters.pre_split;
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut bvh, parameters.reinsertion_batch_ratio, None);
    bvh
}

/// Turns the hierarchy into our nodes.
fn lay_out(geometry: &Geometry, bvh: &Bvh2, members: &Members) -> Tree {
    let node = |index: u32| {
        let node = &bvh.nodes[index as usize];
        let kind = if node.is_leaf() {
            Binary::Leaf(bvh.primitive_indices[node.first_index as usize])
        } else {
            Binary::Inner([node.first_index, node.first_index + 1])
        };
        (from_obvhs(node.aabb()), kind)
    };
    let wide = Converter::default().convert(geometry, 0, node, |owner| members.owner(owner), 0);
    let (Some(kind), Some(bounds)) = (wide.root, wide.bounds) else { return Tree::default() };
    let place = arena::root_of(kind);
    let mut units = Units::zeroed(wide.units.len());
    units.as_mut_slice().copy_from_slice(&wide.units);
    match Arena::new(units, wide.numbers, place) {
        Some((arena, census)) => Tree { arena, root: Some(Root { place, bounds }), census },
        None => Tree::default(),
    }
}

impl Members {
    /// What the owner of that number is.
    fn owner(&self, owner: u32) -> Owner<'_> {
        match self.singles.get(owner as usize) {
            Some(&number) => Owner::Single(number),
            None => Owner::Heap(&self.heaps[owner as usize - self.singles.len()]),
        }
    }
}

fn to_obvhs(b: Aabb) -> obvhs::aabb::Aabb {
    obvhs::aabb::Aabb::new(b.low.into(), b.high.into())
}

fn from_obvhs(b: &obvhs::aabb::Aabb) -> Aabb {
    Aabb { low: b.min.into(), high: b.max.into() }
}

#[cfg(test)]
mod tests;
