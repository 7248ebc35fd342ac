//! The tree's layout: binary, each inner node holding the boxes of both its children, so that one
//! cache line decides where a ray goes next.

use crate::kernels::slab::Aabb;

/// A node or a range of primitives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Child {
    /// The node's number, or the first of its places in [`Tree::primitives`].
    pub index: u32,
    /// Number of primitives; 0 for a node.
    pub count: u32,
}

impl Child {
    /// A leaf of nothing.
    pub(super) const EMPTY: Self = Self { index: 0, count: 0 };
}

/// An inner node: 64 bytes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// The children's boxes, padded.
    pub bounds: [Aabb; 2],
    /// What they are.
    pub children: [Child; 2],
}

/// A bounding volume hierarchy over the primitives of a [`super::geometry::Geometry`].
///
/// Built whole by [`super::build`], which proves that every index is in range.
#[derive(Clone, Debug)]
pub struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) primitives: Vec<u32>,
    pub(super) root: Option<(Aabb, Child)>,
    pub(super) depth: usize,
    pub(super) splits: bool,
}

impl Tree {
    /// The inner nodes; a node stands before its children.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Primitive numbers in the order of the leaves.
    pub fn primitives(&self) -> &[u32] {
        &self.primitives
    }

    /// The root and its box, unless the tree is empty.
    pub fn root(&self) -> Option<(Aabb, Child)> {
        self.root
    }

    /// The largest number of inner nodes on a way down.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Whether leaves can hold parts of primitives, whose boxes are smaller than the primitives.
    pub fn has_splits(&self) -> bool {
        self.splits
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.nodes.as_slice()) + size_of_val(self.primitives.as_slice())) as u64
    }
}
