//! From a binary hierarchy to nodes of eight children and leaves of up to eight triangles.
//!
//! Which binary nodes become nodes, which become leaves, and how many children a node gives to
//! either side, is decided by dynamic programming over the surface-area heuristic, as Ylitie,
//! Karras and Laine do (*Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*,
//! HPG 2017, section 3.2). A subtree can be a leaf if its triangles fit one: at most eight, over at
//! most eight vertices.
//!
//! [`Converter::evaluate`] decides, from the leaves up; [`Converter::emit`] then writes any subtree.
//! Only costs are kept between the two: what a node visited while writing is divided into is found
//! again from its children's costs, which is less work than to remember it for every node.

mod emit;
mod shared;

use obvhs::bvh2::node::Bvh2Node;

use super::arena::{Kind, Unit};
use crate::kernels::slab::Aabb;
use crate::math::simd::LANES;
pub(super) use shared::Shared;

/// What a visit costs, in visits of a node.
mod cost {
    pub(super) const NODE: f32 = 1.0;
    pub(super) const PATCH: f32 = 1.0;
    /// By how much a patch counts less for each triangle beyond one. Rays do not ask for it, but
    /// memory does: a scan of a million triangles takes 48.9 bytes for each and not 52.7, and rays
    /// visit 0.3 to 2 per cent more.
    pub(super) const FULLER: f32 = 0.06;
    pub(super) const SOUP: f32 = 2.0;
    /// Of each primitive in a list.
    pub(super) const LISTED: f32 = 1.0;
}

/// The most primitives in a list that is not a heap.
const MOST_LISTED: u8 = 4;

/// The most slots that a subtree can be given within a node.
const SLOTS: usize = LANES - 1;

/// What is in a leaf of the binary hierarchy.
#[derive(Clone, Copy, Debug)]
pub(super) enum Owner<'a> {
    /// A triangle, and the numbers of its vertices.
    Triangle(u32, [u32; 3]),
    /// Triangles that are to be a patch, and their numbers.
    Patch(&'a Shared, &'a [u32]),
    /// A primitive of another kind.
    Other(u32),
    /// Many about one point: a list, whatever it costs.
    Heap(&'a [u32]),
    /// A part of the tree that is in the arena already.
    Part(Part),
}

/// A part of a tree, as its parent sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) bounds: Aabb,
    /// What its root is, and in which unit.
    pub(super) kind: Kind,
    pub(super) unit: usize,
    /// What it costs, in visits of a node times half areas.
    pub(super) cost: f32,
}

/// A binary hierarchy: the root is the first node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hierarchy<'a> {
    pub(super) nodes: &'a [Bvh2Node],
    /// What the leaves' indices lead to: the numbers of owners.
    pub(super) owners: &'a [u32],
}

/// The cheapest ways to divide a subtree.
#[derive(Clone, Copy, Debug)]
struct Best {
    /// Cost as up to 1, 2, ... slots.
    cost: [f32; SLOTS],
    /// Whether it is a leaf in one slot.
    leaf: bool,
}

/// What would be in a subtree's leaf.
#[derive(Clone, Copy, Debug)]
struct Content {
    /// The vertices of its triangles, each once; unused ones repeat the first.
    vertices: [u32; LANES],
    /// How many they are, or [`TOO_MANY`].
    count: u8,
    /// How many binary leaves, or [`TOO_MANY`].
    leaves: u8,
    /// Which kinds of owners, of [`TRIANGLES`], [`OTHERS`] and [`ALONE`].
    kinds: u8,
}

/// More than eight.
const TOO_MANY: u8 = LANES as u8 + 1;

const TRIANGLES: u8 = 1;
const OTHERS: u8 = 2;
/// Heaps and parts, which share no leaf.
const ALONE: u8 = 4;

/// Where the parts of a tree are written.
#[derive(Debug, Default)]
pub(super) struct Output {
    /// In the arena's format.
    pub(super) units: Vec<Unit>,
    /// Triangle numbers of the leaves.
    pub(super) numbers: Vec<u32>,
    /// Where `numbers` begin in the arena.
    pub(super) first_number: u32,
}

/// Converts hierarchies one after the other, and keeps its memory.
#[derive(Debug, Default)]
pub(super) struct Converter {
    /// The nodes depth first, left children first.
    order: Vec<u32>,
    waiting: Vec<u32>,
    best: Vec<Best>,
    contents: Vec<Content>,
}

impl Converter {
    /// Decides what becomes of every node.
    pub(super) fn evaluate<'a>(&mut self, tree: Hierarchy, owner: impl Fn(u32) -> Owner<'a>) {
        self.put_in_order(tree);
        if self.best.len() < tree.nodes.len() {
            self.best.resize(tree.nodes.len(), Best { cost: [0.0; SLOTS], leaf: true });
        }
        self.contents.clear();
        for &place in self.order.iter().rev() {
            let node = &tree.nodes[place as usize];
            let area = node.aabb().half_area();
            if node.is_leaf() {
                let (content, cost) = alone(owner(tree.owners[node.first_index as usize]), area);
                self.contents.push(content);
                self.best[place as usize] = Best { cost: [cost; SLOTS], leaf: true };
                continue;
            }
            // Children were met just before: the left one last.
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

    /// What the subtree at `place` costs in one slot.
    pub(super) fn cost(&self, place: u32) -> f32 {
        self.best[place as usize].cost[0]
    }

    /// Whether the subtree at `place` becomes a leaf in one slot.
    pub(super) fn is_leaf(&self, place: u32) -> bool {
        self.best[place as usize].leaf
    }

    /// Lists the nodes depth first: after reinsertion the builder's own order has none.
    fn put_in_order(&mut self, tree: Hierarchy) {
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

/// A binary leaf: what is in it, and what it costs.
fn alone(owner: Owner, area: f32) -> (Content, f32) {
    let other = |kinds| Content { vertices: [0; LANES], count: TOO_MANY, leaves: 1, kinds };
    match owner {
        Owner::Triangle(_, [a, b, c]) => {
            let vertices = [a, b, c, a, a, a, a, a];
            let content = Content { vertices, count: 3, leaves: 1, kinds: TRIANGLES };
            (content, area * cost::PATCH)
        }
        Owner::Patch(_, numbers) => (other(ALONE), area * as_patch(numbers.len())),
        Owner::Other(_) => (other(OTHERS), area * cost::LISTED),
        Owner::Heap(numbers) => (other(ALONE), area * cost::LISTED * numbers.len() as f32),
        Owner::Part(part) => (other(ALONE), part.cost),
    }
}

/// What is in both.
#[inline]
fn merge(left: &Content, right: &Content) -> Content {
    let leaves = (left.leaves + right.leaves).min(TOO_MANY);
    let kinds = left.kinds | right.kinds;
    let mut merged = Content { leaves, kinds, ..*left };
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

/// What a visit of a patch of so many triangles costs.
#[inline(always)]
pub(super) fn as_patch(triangles: usize) -> f32 {
    cost::PATCH - cost::FULLER * (triangles - 1) as f32
}

/// What a visit of a leaf of this content would cost; infinite where there can be none.
fn as_leaf(content: &Content) -> f32 {
    match (content.leaves, content.kinds) {
        (TOO_MANY, _) => f32::INFINITY,
        (_, TRIANGLES) if content.count != TOO_MANY => as_patch(content.leaves.into()),
        (_, TRIANGLES) => cost::SOUP,
        (1..=MOST_LISTED, OTHERS) => cost::LISTED * f32::from(content.leaves),
        _ => f32::INFINITY,
    }
}

/// The best ways to divide an inner node's slots among its children, whose best ways are known.
#[inline]
fn divide(left: &Best, right: &Best, area: f32, content: &Content) -> Best {
    let (l, r) = (&left.cost, &right.cost);
    let leaf = area * as_leaf(content);
    if content.leaves == 2 {
        // Half of all inner nodes: there is nothing to choose.
        let apart = l[0] + r[0];
        let node = area * cost::NODE + apart;
        let one = lesser(leaf, node);
        let mut best = Best { cost: [lesser(apart, one); SLOTS], leaf: leaf <= node };
        best.cost[0] = one;
        return best;
    }
    // As 2, 3, ... 8 children; the loops are unrolled.
    let mut apart = [f32::INFINITY; SLOTS];
    for k in 0..SLOTS {
        for other in 0..SLOTS - k {
            apart[k + other] = lesser(apart[k + other], l[k] + r[other]);
        }
    }
    let node = area * cost::NODE + apart[SLOTS - 1];
    let one = lesser(leaf, node);
    let mut best = Best { cost: [one; SLOTS], leaf: leaf <= node };
    for slots in 2..=SLOTS {
        best.cost[slots - 1] = lesser(apart[slots - 2], one);
    }
    best
}

/// The minimum, as one instruction: nothing here is not a number.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
