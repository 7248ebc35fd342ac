//! From a binary hierarchy to nodes of eight children and leaves of up to eight triangles.
//!
//! Which binary nodes become nodes, which become leaves, and how many children a node gives to
//! either side, is decided by dynamic programming over the surface-area heuristic, as Ylitie,
//! Karras and Laine do (*Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*,
//! HPG 2017, section 3.2). A subtree can be a leaf if its triangles fit one: at most eight, over at
//! most eight vertices.

mod emit;

use super::arena::{Kind, Unit};
use super::geometry::Geometry;
use crate::kernels::slab::Aabb;
use crate::math::simd::LANES;
use emit::Emitter;

/// What a visit costs, in visits of a node.
mod cost {
    pub(super) const NODE: f32 = 1.0;
    pub(super) const PATCH: f32 = 1.0;
    pub(super) const SOUP: f32 = 2.0;
    /// Of each primitive in a list.
    pub(super) const LISTED: f32 = 1.0;
}

/// The most primitives in a list that is not a heap.
const MOST_LISTED: u32 = 4;

/// The most slots that a subtree can be given within a node.
const SLOTS: usize = LANES - 1;

/// What is in a leaf of the binary hierarchy.
#[derive(Clone, Copy, Debug)]
pub(super) enum Owner<'a> {
    /// One primitive.
    Single(u32),
    /// Many about one point: a list, whatever it costs.
    Heap(&'a [u32]),
}

/// A node of the binary hierarchy.
#[derive(Clone, Copy, Debug)]
pub(super) enum Binary {
    /// An inner node with the places of its children.
    Inner([u32; 2]),
    /// A leaf of one owner, by its number.
    Leaf(u32),
}

/// A binary node in depth-first order, so that its left child is the next.
#[derive(Clone, Copy, Debug)]
struct Ordered {
    bounds: Aabb,
    /// Place of the right child; 0 for a leaf.
    right: u32,
    /// How many leaves are below, and which is the first.
    leaves: u32,
    first: u32,
}

/// The vertices of a subtree's triangles, each once, if they are no more than eight.
#[derive(Clone, Copy, Debug)]
struct Vertices {
    all: [u32; LANES],
    count: u8,
}

/// In [`Vertices::count`]: more than eight, or not triangles alone.
const TOO_MANY: u8 = LANES as u8 + 1;

/// The cheapest ways to divide a subtree.
#[derive(Clone, Copy, Debug)]
struct Best {
    /// Cost as up to 1, 2, ... slots.
    cost: [f32; SLOTS],
    /// Slots that the left child gets of 1 (as a node, of eight), 2, ...; 0 for a leaf in one
    /// slot, or where one slot fewer is no worse.
    left: [u8; SLOTS],
}

/// A tree, or a part of one.
#[derive(Debug, Default)]
pub(super) struct Wide {
    /// In the arena's format, the root first.
    pub(super) units: Vec<Unit>,
    /// Triangle numbers of the leaves.
    pub(super) numbers: Vec<u32>,
    /// What the root is.
    pub(super) root: Option<Kind>,
    /// Its box.
    pub(super) bounds: Option<Aabb>,
}

/// Converts hierarchies one after the other, and keeps its memory.
#[derive(Debug, Default)]
pub(super) struct Converter {
    order: Vec<Ordered>,
    owners: Vec<u32>,
    vertices: Vec<Vertices>,
    best: Vec<Best>,
}

impl Converter {
    /// Converts the subtree of `root`. `node` tells a binary node's box and what it is, `owner` what
    /// an owner is. Numbers begin at `first_number` in the arena.
    pub(super) fn convert<'a>(
        &mut self,
        geometry: &Geometry,
        root: u32,
        node: impl Fn(u32) -> (Aabb, Binary),
        owner: impl Fn(u32) -> Owner<'a>,
        first_number: u32,
    ) -> Wide {
        self.put_in_order(root, node);
        self.find_best(geometry, &owner);
        let mut emitter =
            Emitter { geometry, converter: self, owner, first_number, wide: Wide::default() };
        emitter.emit();
        emitter.wide
    }

    /// Lists the nodes depth first: after reinsertion the builder's own order has none.
    fn put_in_order(&mut self, root: u32, node: impl Fn(u32) -> (Aabb, Binary)) {
        self.order.clear();
        self.owners.clear();
        // Who waits for a place, and the parent to tell if it is a right child.
        let mut waiting = vec![(root, u32::MAX)];
        while let Some((source, parent)) = waiting.pop() {
            let place = self.order.len() as u32;
            if let Some(parent) = self.order.get_mut(parent as usize) {
                parent.right = place;
            }
            let (bounds, kind) = node(source);
            let first = self.owners.len() as u32;
            self.order.push(Ordered { bounds, right: 0, leaves: 1, first });
            match kind {
                Binary::Inner([left, right]) => {
                    waiting.push((right, place));
                    waiting.push((left, u32::MAX));
                }
                Binary::Leaf(owner) => self.owners.push(owner),
            }
        }
        for place in (0..self.order.len()).rev() {
            let right = self.order[place].right as usize;
            if right != 0 {
                self.order[place].leaves = self.order[place + 1].leaves + self.order[right].leaves;
            }
        }
    }

    /// Fills `best`, from the leaves up.
    fn find_best<'a>(&mut self, geometry: &Geometry, owner: &impl Fn(u32) -> Owner<'a>) {
        let none = Vertices { all: [0; LANES], count: TOO_MANY };
        self.vertices.clear();
        self.vertices.resize(self.order.len(), none);
        self.best.clear();
        self.best.resize(self.order.len(), Best { cost: [0.0; SLOTS], left: [0; SLOTS] });
        for place in (0..self.order.len()).rev() {
            let node = self.order[place];
            let area = half_area(&node.bounds);
            if node.right == 0 {
                let (vertices, visit) = match owner(self.owners[node.first as usize]) {
                    Owner::Single(number) if (number as usize) < geometry.triangles.len() => {
                        (corners(geometry.triangles[number as usize]), cost::PATCH)
                    }
                    Owner::Single(_) => (none, cost::LISTED),
                    Owner::Heap(numbers) => (none, cost::LISTED * numbers.len() as f32),
                };
                self.vertices[place] = vertices;
                self.best[place].cost = [area * visit; SLOTS];
                continue;
            }
            let (left, right) = (place + 1, node.right as usize);
            let leaf = self.as_leaf(geometry, place, owner);
            let mut best = divide(&self.best[left], &self.best[right], area * cost::NODE);
            if area * leaf < best.cost[0] {
                best.cost[0] = area * leaf;
                best.left[0] = 0;
            }
            for slots in 1..SLOTS {
                if best.cost[slots] >= best.cost[slots - 1] {
                    best.cost[slots] = best.cost[slots - 1];
                    best.left[slots] = 0;
                }
            }
            self.best[place] = best;
        }
    }

    /// What a visit of the inner node at `place` would cost if it were a leaf; infinite where it
    /// cannot be one.
    fn as_leaf<'a>(
        &mut self,
        geometry: &Geometry,
        place: usize,
        owner: &impl Fn(u32) -> Owner<'a>,
    ) -> f32 {
        let node = self.order[place];
        if node.leaves > LANES as u32 {
            return f32::INFINITY;
        }
        let merged = merge(&self.vertices[place + 1], &self.vertices[node.right as usize]);
        self.vertices[place] = merged;
        if merged.count != TOO_MANY {
            return cost::PATCH;
        }
        let range = node.first as usize..(node.first + node.leaves) as usize;
        let owners = || self.owners[range.clone()].iter().map(|&o| owner(o));
        let triangles = geometry.triangles.len();
        let is_triangle = |o: &Owner| matches!(o, Owner::Single(n) if (*n as usize) < triangles);
        if owners().all(|o| is_triangle(&o)) {
            return cost::SOUP;
        }
        let listed = |o: &Owner| matches!(o, Owner::Single(n) if *n as usize >= triangles);
        if node.leaves <= MOST_LISTED && owners().all(|o| listed(&o)) {
            return cost::LISTED * node.leaves as f32;
        }
        f32::INFINITY
    }
}

/// The best ways to divide an inner node's slots among its children, whose best ways are known.
fn divide(left: &Best, right: &Best, node: f32) -> Best {
    let mut best = Best { cost: [f32::INFINITY; SLOTS], left: [0; SLOTS] };
    for slots in 2..=SLOTS {
        for k in 1..slots {
            let cost = left.cost[k - 1] + right.cost[slots - k - 1];
            if cost < best.cost[slots - 1] {
                best.cost[slots - 1] = cost;
                best.left[slots - 1] = k as u8;
            }
        }
    }
    for k in 1..LANES {
        let cost = node + left.cost[k - 1] + right.cost[LANES - k - 1];
        if cost < best.cost[0] {
            best.cost[0] = cost;
            best.left[0] = k as u8;
        }
    }
    best
}

fn half_area(b: &Aabb) -> f32 {
    let d = b.high - b.low;
    d.x * d.y + d.y * d.z + d.z * d.x
}

fn corners([a, b, c]: [u32; 3]) -> Vertices {
    Vertices { all: [a, b, c, 0, 0, 0, 0, 0], count: 3 }
}

/// The vertices of both.
fn merge(left: &Vertices, right: &Vertices) -> Vertices {
    let mut merged = *left;
    if left.count == TOO_MANY || right.count == TOO_MANY {
        merged.count = TOO_MANY;
        return merged;
    }
    for &v in &right.all[..right.count as usize] {
        let known = &merged.all[..merged.count as usize];
        if known.contains(&v) {
            continue;
        }
        if merged.count as usize == LANES {
            merged.count = TOO_MANY;
            return merged;
        }
        merged.all[merged.count as usize] = v;
        merged.count += 1;
    }
    merged
}
