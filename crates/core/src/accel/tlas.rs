//! The top-level tree over instances, and how rays walk through it.
//!
//! A binary tree, divided from the top by the surface-area heuristic at the cheapest of all places
//! along an axis. There are few instances compared with their triangles, so the tree is simple, and
//! its depth is bounded for any scene.

use glam::Vec3;

use super::Hit;
use crate::geometry::instance::Instance;
use crate::kernels::{Aabb, SlabRay};
use crate::math::Ray;
use crate::math::float::{max, min};

/// Below this depth, halves have equally many instances: a stack needs this and 32 entries.
const DEEPEST: usize = 64;

/// A node, or a leaf.
#[derive(Clone, Copy, Debug)]
struct InstanceNode {
    bounds: Aabb,
    /// The first of two children, or the instance of a leaf.
    index: u32,
    is_leaf: bool,
}

impl InstanceNode {
    /// Twice the centre of its box.
    fn middle(&self) -> Vec3 {
        self.bounds.low + self.bounds.high
    }
}

/// A tree over instances.
#[derive(Clone, Debug, Default)]
pub(super) struct Tlas {
    /// The root first; siblings are adjacent.
    nodes: Vec<InstanceNode>,
    /// The factor, relative to other boxes, by which the origins of rays are moved.
    widening: f32,
    depth: usize,
}

/// An instance that a ray may meet, or a node above one. Not packed as on other stacks, as single floats are compared.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TlasEntry {
    /// The earliest t at which the ray enters its box.
    near: f32,
    node: u32,
}

impl Tlas {
    /// The tree over `instances`; `boxes` are those of each prototype.
    pub(super) fn new(instances: &[Instance], boxes: &[Vec<Aabb>]) -> Self {
        let mut leaves: Vec<InstanceNode> = Vec::with_capacity(instances.len());
        for (index, instance) in (0..).zip(instances) {
            let of_prototype = &boxes[instance.prototype()];
            if !of_prototype.is_empty() {
                let bounds = instance.bounds(of_prototype);
                leaves.push(InstanceNode { bounds, index, is_leaf: true });
            }
        }
        let widening = instances.iter().map(Instance::widening).fold(1.0, f32::max);
        let mut tlas = Self { nodes: Vec::with_capacity(2 * leaves.len()), widening, depth: 0 };
        tlas.nodes.extend(leaves.first());
        if !leaves.is_empty() {
            tlas.nodes[0] = tlas.over(&mut leaves, 0);
        }
        tlas
    }

    /// Boxes that together contain all instances, with the widening of rays.
    pub(super) fn outline(&self) -> impl Iterator<Item = (Aabb, f32)> + use<> {
        /// Number of boxes from which on none is divided.
        const ENOUGH: usize = 32;
        let mut open: Vec<InstanceNode> = self.nodes.first().copied().into_iter().collect();
        while open.len() < ENOUGH
            && let Some(place) = open.iter().position(|node| !node.is_leaf)
        {
            // From the front: level by level.
            let first = open.remove(place).index as usize;
            open.extend_from_slice(&self.nodes[first..first + 2]);
        }
        let widening = self.widening;
        open.into_iter().map(move |node| (node.bounds, widening))
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> u64 {
        size_of_val(self.nodes.as_slice()) as u64
    }

    /// Entries needed in the stack of a ray.
    pub(super) fn stack_entries(&self) -> usize {
        self.depth + 2
    }

    /// The node over some leaves, at this depth. All below it are placed.
    fn over(&mut self, leaves: &mut [InstanceNode], depth: usize) -> InstanceNode {
        self.depth = self.depth.max(depth);
        if let [leaf] = leaves {
            return *leaf;
        }
        let bounds = leaves.iter().fold(Aabb::EMPTY, |all, leaf| all.union(leaf.bounds));
        let middle = divide(leaves, depth);
        let (left, right) = leaves.split_at_mut(middle);
        let first = self.nodes.len();
        self.nodes.extend([left[0], right[0]]);
        self.nodes[first] = self.over(left, depth + 1);
        self.nodes[first + 1] = self.over(right, depth + 1);
        InstanceNode { bounds, index: first as u32, is_leaf: false }
    }
}

/// A ray that walks from instance to instance, and its closest hit so far. The stack is elsewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    pub(super) ray: Ray,
    pub(super) best: Hit,
    slab: SlabRay,
    height: u32,
}

impl Walk {
    /// The ray before its first instance.
    #[inline]
    pub(super) fn new(tlas: &Tlas, ray: &Ray, best: Hit, stack: &mut [TlasEntry]) -> Self {
        let slab = SlabRay::widened(ray, tlas.widening);
        let mut walk = Self { ray: *ray, best, slab, height: 0 };
        if !tlas.nodes.is_empty() {
            walk.push(tlas, 0, stack);
        }
        walk
    }

    /// The next instance that the ray may meet before its closest hit, usually nearer ones first.
    #[inline]
    pub(super) fn next(&mut self, tlas: &Tlas, stack: &mut [TlasEntry]) -> Option<u32> {
        while self.height > 0 {
            self.height -= 1;
            let TlasEntry { near, node } = stack[self.height as usize];
            if near > self.slab.reach(self.reach()) {
                continue;
            }
            let node = tlas.nodes[node as usize];
            if node.is_leaf {
                return Some(node.index);
            }
            let before = self.height as usize;
            self.push(tlas, node.index, stack);
            self.push(tlas, node.index + 1, stack);
            let has_both = self.height as usize == before + 2;
            if has_both && stack[before].near < stack[before + 1].near {
                stack.swap(before, before + 1);
            }
        }
        None
    }

    /// The distance up to which boxes are visited.
    #[inline]
    fn reach(&self) -> f32 {
        min(self.best.t, self.ray.t_max)
    }

    /// Pushes a node if the ray meets its box.
    #[inline]
    fn push(&mut self, tlas: &Tlas, node: u32, stack: &mut [TlasEntry]) {
        let [near, far] = self.slab.interval(&tlas.nodes[node as usize].bounds);
        let near = max(near, self.ray.t_min);
        if near <= min(far, self.slab.reach(self.reach())) {
            stack[self.height as usize] = TlasEntry { near, node };
            self.height += 1;
        }
    }
}

/// Sorts the leaves by their centres along the longest axis and returns the number of the left half,
/// which has the least cost by the surface-area heuristic: neither all nor none.
fn divide(leaves: &mut [InstanceNode], depth: usize) -> usize {
    let low = leaves.iter().map(InstanceNode::middle).fold(Vec3::INFINITY, Vec3::min);
    let high = leaves.iter().map(InstanceNode::middle).fold(Vec3::NEG_INFINITY, Vec3::max);
    let extent = high - low;
    let axis = extent.max_position();
    // Of equal centres, the lower numbers come first.
    leaves.sort_unstable_by(|a, b| {
        a.middle()[axis].total_cmp(&b.middle()[axis]).then(a.index.cmp(&b.index))
    });
    if depth >= DEEPEST || extent[axis] <= 0.0 {
        return leaves.len() / 2;
    }
    let costs = |leaves: &mut dyn Iterator<Item = &InstanceNode>| -> Vec<f32> {
        let mut bounds = Aabb::EMPTY;
        let grown = leaves.zip(1_u32..).map(|(leaf, count)| {
            bounds = bounds.union(leaf.bounds);
            half_area(&bounds) * count as f32
        });
        grown.collect()
    };
    let (left, right) = (costs(&mut leaves.iter()), costs(&mut leaves.iter().rev()));
    let cost = |count: usize| left[count - 1] + right[leaves.len() - count - 1];
    (2..leaves.len()).fold(1, |best, k| if cost(k) < cost(best) { k } else { best })
}

fn half_area(bounds: &Aabb) -> f32 {
    let size = bounds.high - bounds.low;
    size.x * size.y + size.y * size.z + size.z * size.x
}
