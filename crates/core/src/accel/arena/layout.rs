//! The layout of nodes and leaves.

use bytemuck::{Pod, Zeroable};

use super::Unit;
use crate::math::LANES;
use crate::math::float::{max, min};

/// An inner node.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// For each axis the low planes and the high planes of the eight children; those of absent
    /// children are infinite, so that no ray meets them.
    pub planes: [[[f32; 8]; 2]; 3],
    /// The children's places relative to this node, as the bits of a [`Ref`](super::Ref); 0 for none.
    pub children: [u32; 8],
    /// Number of children, which are the first lanes.
    pub count: u32,
    /// Unused.
    pub spare: [u32; 7],
}

impl Node {
    /// A node without children.
    pub const EMPTY: Self = Self {
        planes: [[[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]]; 3],
        children: [0; 8],
        count: 0,
        spare: [0; 7],
    };
}

/// A leaf of triangles that share vertices.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Patch {
    /// Vertex coordinates, an axis a row; unused ones repeat the first vertex.
    pub positions: [[f32; 8]; 3],
    /// For each corner, the indices of its vertices in the triangles, four bits each; unused
    /// triangles have only the first vertex.
    pub corners: [u32; 3],
    /// Unused.
    pub spare: u32,
    /// What every leaf of triangles has.
    pub head: LeafHead,
}

/// A leaf of triangles without shared vertices.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Soup {
    /// For each corner and axis, the coordinates in the triangles; unused ones are zero.
    pub corners: [[[f32; 8]; 3]; 3],
    /// What every leaf of triangles has.
    pub head: LeafHead,
    /// Unused.
    pub spare: [u32; 20],
}

/// What every leaf of triangles has.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct LeafHead {
    /// The start of the triangles' numbers in the numbers of the [`Arena`](super::Arena).
    pub first: u32,
    /// Number of triangles.
    pub count: u32,
    /// Number of triangles that are halves of quads.
    pub quads: u32,
    /// All vertices lie within this distance of the first, along each axis.
    pub extent: f32,
}

/// The largest distance along an axis between the first `count` of all points, rounded up. Each row
/// is an axis.
pub fn extent(points: &[[[f32; LANES]; 3]], count: usize) -> f32 {
    let along = |axis: usize| {
        let all = || points.iter().flat_map(|rows| &rows[axis][..count.min(LANES)]).copied();
        all().fold(f32::NEG_INFINITY, max) - all().fold(f32::INFINITY, min)
    };
    max(along(0), max(along(1), along(2))).next_up()
}

/// Units of a [`Node`].
pub const NODE_UNITS: usize = size_of::<Node>() / size_of::<Unit>();
/// Units of a list of `count` primitives.
pub const fn list_units(count: usize) -> usize {
    (count + 1).div_ceil(32)
}

const _: () = assert!(NODE_UNITS == 2 && size_of::<Patch>() == 128 && size_of::<Soup>() == 384);
