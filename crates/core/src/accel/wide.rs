//! Converts a binary hierarchy to nodes of eight children and leaves of up to eight triangles.
//!
//! Dynamic programming over the surface-area heuristic decides which binary nodes become nodes,
//! which become leaves, and how many children a node gives to either side, as in Ylitie, Karras and
//! Laine (*Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*, HPG 2017,
//! section 3.2). A subtree can be a leaf if its triangles fit one: at most eight, over at most
//! eight vertices.
//!
//! [`Converter::evaluate`] decides from the leaves up; [`Converter::emit`] then writes any subtree.
//! Only costs are stored in between: the division of a node is recomputed from its children's costs
//! while writing, which is cheaper than storing it for every node.

mod emit;
mod shared;

use bytemuck::Zeroable;
use obvhs::bvh2::Bvh2;

use super::arena::list_units;
use super::{Kind, Unit};
use crate::kernels::Aabb;
use crate::math::LANES;
use crate::math::float::min;
pub(super) use shared::SharedVertices;

/// Costs of visits, in visits of a node.
mod cost {
    pub(super) const NODE: f32 = 1.0;
    pub(super) const PATCH: f32 = 1.0;
    /// The discount on a patch for each triangle beyond one. It is for memory, not for rays: a scan
    /// of a million triangles takes 48.9 bytes for each instead of 52.7, and rays visit 0.3 to 2
    /// per cent more.
    pub(super) const FULLER: f32 = 0.06;
    pub(super) const SOUP: f32 = 2.0;
    /// For each primitive in a list.
    pub(super) const LISTED: f32 = 1.0;
}

/// The largest list.
const MOST_LISTED: u8 = 4;

/// The largest number of slots for a subtree within a node.
const SLOTS: usize = LANES - 1;

/// The content of a leaf of the binary hierarchy.
#[derive(Clone, Copy, Debug)]
pub(super) enum Owner<'a> {
    /// A triangle, and the numbers of its vertices.
    Triangle(u32, [u32; 3]),
    /// Triangles that become a patch, and their numbers.
    Patch(&'a SharedVertices, &'a [u32]),
    /// A primitive of another kind.
    Other(u32),
    /// A part of the tree that is already in the arena.
    Part(Part),
}

/// A part of a tree, as its parent sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) bounds: Aabb,
    /// The kind and the unit of its root.
    pub(super) kind: Kind,
    pub(super) unit: usize,
    /// Its cost, in visits of a node times half areas.
    pub(super) cost: f32,
}

/// The cheapest division of a subtree.
#[derive(Clone, Copy, Debug)]
struct Division {
    /// Cost with up to 1, 2, ... slots.
    cost: [f32; SLOTS],
    /// Whether it becomes a leaf if it has one slot.
    leaf: bool,
}

/// The content of a subtree as a leaf.
#[derive(Clone, Copy, Debug)]
struct LeafContent {
    /// The vertices of its triangles, each once; unused ones repeat the first.
    vertices: [u32; LANES],
    /// Number of vertices, or [`TOO_MANY`].
    count: u8,
    /// Number of binary leaves, or [`TOO_MANY`].
    leaves: u8,
    /// The kinds of owners: [`TRIANGLES`], [`OTHERS`] and [`ALONE`].
    kinds: u8,
}

/// More than eight.
const TOO_MANY: u8 = LANES as u8 + 1;

const TRIANGLES: u8 = 1;
const OTHERS: u8 = 2;
/// Patches and parts, which cannot share a leaf.
const ALONE: u8 = 4;

/// The output of a converter.
#[derive(Debug, Default)]
pub(super) struct Output {
    /// In the arena's format.
    pub(super) units: Vec<Unit>,
    /// Triangle numbers of the leaves.
    pub(super) numbers: Vec<u32>,
    /// The start of `numbers` in the arena.
    pub(super) first_number: u32,
}

impl Output {
    /// Begins again, with numbers that start at `first` in the arena.
    pub(super) fn clear(&mut self, first: usize) {
        self.units.clear();
        self.numbers.clear();
        self.first_number = first as u32;
    }

    /// Appends a list of primitives.
    pub(super) fn list(&mut self, numbers: &[u32]) {
        let start = self.units.len();
        self.units.resize(start + list_units(numbers.len()), Unit::zeroed());
        let words: &mut [u32] = bytemuck::cast_slice_mut(&mut self.units[start..]);
        words[0] = numbers.len() as u32;
        words[1..=numbers.len()].copy_from_slice(numbers);
    }
}

/// Converts hierarchies in turn, and reuses its memory.
#[derive(Debug, Default)]
pub(super) struct Converter {
    /// The nodes depth first, left children first.
    order: Vec<u32>,
    waiting: Vec<u32>,
    best: Vec<Division>,
    contents: Vec<LeafContent>,
}

impl Converter {
    /// Decides the division of every node.
    pub(super) fn evaluate<'a>(&mut self, tree: &Bvh2, owner: impl Fn(u32) -> Owner<'a>) {
        self.put_in_order(tree);
        if self.best.len() < tree.nodes.len() {
            self.best.resize(tree.nodes.len(), Division { cost: [0.0; SLOTS], leaf: true });
        }
        self.contents.clear();
        for &place in self.order.iter().rev() {
            let node = &tree.nodes[place as usize];
            let area = node.aabb().half_area();
            if node.is_leaf() {
                let (content, cost) =
                    alone(owner(tree.primitive_indices[node.first_index as usize]), area);
                self.contents.push(content);
                self.best[place as usize] = Division { cost: [cost; SLOTS], leaf: true };
                continue;
            }
            // Children were visited just before, the left one last.
            let (Some(left), Some(right)) = (self.contents.pop(), self.contents.pop()) else {
                return;
            };
            let content = merge(&left, &right);
            let children = node.first_index as usize;
            let best = divide(&self.best[children], &self.best[children + 1], area, &content);
            self.best[place as usize] = best;
            self.contents.push(content);
        }
    }

    /// The cost of the subtree at `place` in one slot.
    pub(super) fn cost(&self, place: u32) -> f32 {
        self.best[place as usize].cost[0]
    }

    /// Whether the subtree at `place` becomes a leaf if it has one slot.
    pub(super) fn is_leaf(&self, place: u32) -> bool {
        self.best[place as usize].leaf
    }

    /// Lists the nodes depth first: after reinsertion the builder's own order is arbitrary.
    fn put_in_order(&mut self, tree: &Bvh2) {
        self.order.clear();
        self.waiting.clear();
        self.waiting.push(0);
        while let Some(place) = self.waiting.pop() {
            self.order.push(place);
            let node = &tree.nodes[place as usize];
            if !node.is_leaf() {
                self.waiting.push(node.first_index + 1);
                self.waiting.push(node.first_index);
            }
        }
    }
}

/// The content and cost of a binary leaf.
fn alone(owner: Owner, area: f32) -> (LeafContent, f32) {
    let other = |kinds| LeafContent { vertices: [0; LANES], count: TOO_MANY, leaves: 1, kinds };
    match owner {
        Owner::Triangle(_, [a, b, c]) => {
            let vertices = [a, b, c, a, a, a, a, a];
            let content = LeafContent { vertices, count: 3, leaves: 1, kinds: TRIANGLES };
            (content, area * cost::PATCH)
        }
        Owner::Patch(_, numbers) => (other(ALONE), area * as_patch(numbers.len())),
        Owner::Other(_) => (other(OTHERS), area * cost::LISTED),
        Owner::Part(part) => (other(ALONE), part.cost),
    }
}

/// The union of both.
#[inline]
fn merge(left: &LeafContent, right: &LeafContent) -> LeafContent {
    let leaves = (left.leaves + right.leaves).min(TOO_MANY);
    let kinds = left.kinds | right.kinds;
    let mut merged = LeafContent { leaves, kinds, ..*left };
    if leaves == TOO_MANY || left.count == TOO_MANY || right.count == TOO_MANY {
        merged.count = TOO_MANY;
        return merged;
    }
    for &v in &right.vertices[..right.count as usize] {
        // Over all lanes, so that they are compared together.
        if merged.vertices.iter().fold(false, |known, &k| known | (k == v)) {
            continue;
        }
        if merged.count as usize == LANES {
            merged.count = TOO_MANY;
            return merged;
        }
        merged.vertices[merged.count as usize] = v;
        merged.count += 1;
    }
    merged
}

/// The cost of visiting a patch of this many triangles.
#[inline(always)]
pub(super) fn as_patch(triangles: usize) -> f32 {
    cost::PATCH - cost::FULLER * (triangles - 1) as f32
}

/// The cost of visiting a leaf with this content; infinite if it cannot be a leaf.
fn as_leaf(content: &LeafContent) -> f32 {
    match (content.leaves, content.kinds) {
        (TOO_MANY, _) => f32::INFINITY,
        (_, TRIANGLES) if content.count != TOO_MANY => as_patch(content.leaves.into()),
        (_, TRIANGLES) => cost::SOUP,
        (1..=MOST_LISTED, OTHERS) => cost::LISTED * f32::from(content.leaves),
        _ => f32::INFINITY,
    }
}

/// The best divisions of an inner node's slots among its children, whose best divisions are known.
#[inline]
fn divide(left: &Division, right: &Division, area: f32, content: &LeafContent) -> Division {
    let (l, r) = (&left.cost, &right.cost);
    let leaf = area * as_leaf(content);
    if content.leaves == 2 {
        // Half of all inner nodes have no choice.
        let apart = l[0] + r[0];
        let node = area * cost::NODE + apart;
        let one = min(leaf, node);
        let mut best = Division { cost: [min(apart, one); SLOTS], leaf: leaf <= node };
        best.cost[0] = one;
        return best;
    }
    // As 2, 3, ... 8 children; the loops are unrolled.
    let mut apart = [f32::INFINITY; SLOTS];
    for k in 0..SLOTS {
        for other in 0..SLOTS - k {
            apart[k + other] = min(apart[k + other], l[k] + r[other]);
        }
    }
    let node = area * cost::NODE + apart[SLOTS - 1];
    let one = min(leaf, node);
    let mut best = Division { cost: [one; SLOTS], leaf: leaf <= node };
    for slots in 2..=SLOTS {
        best.cost[slots - 1] = min(apart[slots - 2], one);
    }
    best
}
