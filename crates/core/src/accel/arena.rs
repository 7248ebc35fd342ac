//! The memory of the tree: nodes of eight children and leaves in one arena of units of 128 bytes.
//!
//! | content | units | holds |
//! |---|---|---|
//! | [`Node`] | 2 | the boxes of 8 children, a plane a row, and where the children are |
//! | [`Patch`] | 1 | up to 8 triangles over up to 8 vertices that they share |
//! | [`Soup`] | 3 | up to 8 triangles that share nothing |
//! | list | 1 and more | the numbers of primitives, tested one by one |
//!
//! A node stands before its children, its leaves right behind it, and says where they are relative
//! to itself: a part of the tree can be built anywhere and copied as it is.
//!
//! This is the one module of traversal with `unsafe` code. [`Arena::new`] visits every node once and
//! proves that whatever can be reached from the root lies within the arena; after that a
//! [`Ref`], which only this module makes, needs no check.

#![allow(unsafe_code, reason = "places in the arena are proved when it is made")]

mod proof;

use bytemuck::{Pod, Zeroable};

pub use super::units::Unit;
use super::units::Units;

/// What a [`Ref`] leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Kind {
    /// A [`Node`].
    Node = 0,
    /// A [`Patch`].
    Patch = 1,
    /// A [`Soup`].
    Soup = 2,
    /// Numbers of primitives.
    List = 3,
}

/// Where something is in the arena, and what: the number of its first unit, and in the two lowest
/// bits its [`Kind`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ref(u32);

impl Ref {
    /// A place that is in no tree without a node.
    pub(super) const ROOT: Self = Self(0);

    /// The bits, as they are kept on stacks.
    #[inline(always)]
    pub(super) fn bits(self) -> u32 {
        self.0
    }

    /// From bits that [`Self::bits`] or [`base`] gave.
    #[inline(always)]
    pub(super) fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// What is there.
    #[inline(always)]
    pub fn kind(self) -> Kind {
        match self.0 & 3 {
            0 => Kind::Node,
            1 => Kind::Patch,
            2 => Kind::Soup,
            _ => Kind::List,
        }
    }

    #[inline(always)]
    fn unit(self) -> usize {
        (self.0 >> 2) as usize
    }
}

/// The largest number of units: what a [`Ref`] can count, but for the one that stands for no place.
pub const MAX_UNITS: usize = (1 << 30) - 1;

/// An inner node.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// For each axis the low planes of the eight children, and the high planes; those of absent
    /// children are infinite, so that no ray meets them.
    pub planes: [[[f32; 8]; 2]; 3],
    /// The children's places relative to this node, as the bits of a [`Ref`]; 0 where there is none.
    pub children: [u32; 8],
    /// Number of children: the first lanes.
    pub count: u32,
    /// Nothing yet.
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
    /// Coordinates of the vertices, an axis a row; unused ones repeat the first.
    pub positions: [[f32; 8]; 3],
    /// For each corner, which vertex it is in each of the triangles, four bits each; unused
    /// triangles are the first vertex alone.
    pub corners: [u32; 3],
    /// Where the triangles' numbers begin in [`Arena::numbers`].
    pub first: u32,
    /// Number of triangles.
    pub count: u32,
    /// Number of vertices.
    pub vertices: u32,
    /// How many of the triangles are halves of quads.
    pub quads: u32,
    spare: u32,
}

/// A leaf of triangles that share nothing.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Soup {
    /// For each corner and axis, the coordinate in each triangle; unused ones are zero.
    pub corners: [[[f32; 8]; 3]; 3],
    /// Where the triangles' numbers begin in [`Arena::numbers`].
    pub first: u32,
    /// Number of triangles.
    pub count: u32,
    /// How many of them are halves of quads.
    pub quads: u32,
    spare: [u32; 21],
}

impl Patch {
    /// A patch of `count` triangles over `vertices` vertices, `quads` of them halves of quads, whose numbers begin
    /// at `first`.
    pub fn new(
        positions: [[f32; 8]; 3],
        corners: [u32; 3],
        first: u32,
        [count, vertices, quads]: [u32; 3],
    ) -> Self {
        Self { positions, corners, first, count, vertices, quads, spare: 0 }
    }
}

impl Soup {
    /// A soup of `count` triangles, `quads` of them halves of quads, whose numbers begin at `first`.
    pub fn new(corners: [[[f32; 8]; 3]; 3], first: u32, [count, quads]: [u32; 2]) -> Self {
        Self { corners, first, count, quads, spare: [0; 21] }
    }
}

/// Units of a [`Node`].
pub const NODE_UNITS: usize = size_of::<Node>() / size_of::<Unit>();
/// Units of a [`Patch`].
pub const PATCH_UNITS: usize = size_of::<Patch>() / size_of::<Unit>();
/// Units of a [`Soup`].
pub const SOUP_UNITS: usize = size_of::<Soup>() / size_of::<Unit>();
/// Units of a list of `count` primitives.
pub const fn list_units(count: usize) -> usize {
    (count + 1).div_ceil(32)
}

const _: () = assert!(NODE_UNITS == 2 && PATCH_UNITS == 1 && SOUP_UNITS == 3);

/// A tree, or a part of one, in memory.
#[derive(Debug, Default)]
pub struct Arena {
    units: Units,
    numbers: Vec<u32>,
}

/// What is in an arena.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Inner nodes.
    pub nodes: u64,
    /// Children of inner nodes.
    pub children: u64,
    /// Leaves of triangles that share vertices.
    pub patches: u64,
    /// Leaves of triangles that share nothing.
    pub soups: u64,
    /// Leaves of other primitives.
    pub lists: u64,
    /// Triangles in leaves, those in more than one counted as often.
    pub triangles: u64,
    /// The largest number of inner nodes on a way down.
    pub depth: usize,
}

impl Arena {
    /// An arena of `units`, proved: everything that can be reached from `root` lies within, and
    /// within `numbers`. Also says what is there. `None` where the proof fails, which is a mistake
    /// of the builder's.
    pub(super) fn new(units: Units, numbers: Vec<u32>, root: Ref) -> Option<(Self, Census)> {
        if units.len() > MAX_UNITS {
            return None;
        }
        let proof = proof::Proof { units: &units, numbers: numbers.len() };
        let census = proof.census(root)?;
        Some((Self { units, numbers }, census))
    }

    /// Number of units.
    pub fn units(&self) -> usize {
        self.units.len()
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&*self.units) + size_of_val(self.numbers.as_slice())) as u64
    }

    /// Everything it has.
    #[cfg(test)]
    pub(super) fn parts(&self) -> (&[Unit], &[u32]) {
        (&self.units, &self.numbers)
    }

    /// The arena as kernels see it.
    #[inline(always)]
    pub(super) fn view(&self) -> View<'_> {
        View { units: &self.units, numbers: &self.numbers }
    }
}

/// A proved arena, for kernels.
#[derive(Clone, Copy, Debug)]
pub(super) struct View<'a> {
    units: &'a [Unit],
    numbers: &'a [u32],
}

impl<'a> View<'a> {
    /// The node at `place`.
    #[inline(always)]
    pub(super) fn node(self, place: Ref) -> &'a Node {
        debug_assert!(place.kind() == Kind::Node);
        self.at(place)
    }

    /// The patch at `place`.
    #[inline(always)]
    pub(super) fn patch(self, place: Ref) -> &'a Patch {
        debug_assert!(place.kind() == Kind::Patch);
        self.at(place)
    }

    /// The soup at `place`.
    #[inline(always)]
    pub(super) fn soup(self, place: Ref) -> &'a Soup {
        debug_assert!(place.kind() == Kind::Soup);
        self.at(place)
    }

    /// The list at `place`.
    #[inline]
    pub(super) fn list(self, place: Ref) -> &'a [u32] {
        debug_assert!(place.kind() == Kind::List);
        let words: &[u32] = bytemuck::cast_slice(&self.units[place.unit()..]);
        &words[1..=words[0] as usize]
    }

    /// The number of the primitive that is the `lane`th of those that begin at `first`.
    #[inline(always)]
    pub(super) fn number(self, first: u32, lane: usize) -> u32 {
        self.numbers[first as usize + lane]
    }

    /// The numbers of `count` primitives that begin at `first`.
    pub(super) fn numbers(self, first: u32, count: u32) -> &'a [u32] {
        &self.numbers[first as usize..][..count as usize]
    }

    /// Asks for the cache lines of what is at `place`.
    #[inline(always)]
    pub(super) fn prefetch(self, place: Ref) {
        let start = self.units.as_ptr().wrapping_add(place.unit()).cast::<i8>();
        prefetch(start);
        prefetch(start.wrapping_add(64));
        // The other half of a node; without a branch, which would be mispredicted.
        let rest = start.wrapping_add(usize::from(place.kind() == Kind::Node) * 128);
        prefetch(rest);
        prefetch(rest.wrapping_add(64));
    }

    /// Asks for the cache line of the numbers from `first` on.
    #[inline(always)]
    pub(super) fn prefetch_numbers(self, first: u32) {
        prefetch(self.numbers.as_ptr().wrapping_add(first as usize).cast());
    }

    #[inline(always)]
    fn at<T: Pod>(self, place: Ref) -> &'a T {
        const { assert!(align_of::<T>() <= align_of::<Unit>()) };
        debug_assert!(
            (place.unit() + size_of::<T>().div_ceil(size_of::<Unit>())) <= self.units.len()
        );
        // SAFETY: `place` was reached from the root, since nothing else makes a `Ref` while tracing,
        // and `Arena::new` has proved that what it leads to, of this kind, lies within `units`,
        // which cannot change afterwards. Any bits are a `T`, and units are aligned for it.
        unsafe { &*self.units.as_ptr().add(place.unit()).cast::<T>() }
    }
}

/// A child's bits from those in its parent.
fn absolute(relative: u32, parent: Ref) -> Option<u32> {
    relative.checked_add((parent.unit() as u32) << 2)
}

/// What to add to the bits of the children in the node at `place` to make them those of a [`Ref`].
#[inline(always)]
pub(super) fn base(place: Ref) -> u32 {
    place.0 & !3
}

/// The `lane`th child of the node at `place`.
pub(super) fn child_of(node: &Node, place: Ref, lane: usize) -> Ref {
    Ref(node.children[lane] + base(place))
}

/// Asks for a cache line.
#[cfg(all(target_arch = "x86_64", not(miri)))]
#[inline(always)]
pub(super) fn prefetch(address: *const i8) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    // SAFETY: a hint, which reads nothing and faults nowhere.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(address) };
}

/// Asks for a cache line, where that can be said.
#[cfg(any(not(target_arch = "x86_64"), miri))]
#[inline(always)]
pub(super) fn prefetch(_: *const i8) {}

/// A reference to the first unit, of a `kind`.
pub fn root_of(kind: Kind) -> Ref {
    Ref(kind as u32)
}

/// The bits in a node at unit `parent` for a child of `kind` at unit `child`, behind it.
pub fn relative(parent: usize, child: usize, kind: Kind) -> u32 {
    ((child - parent) as u32) << 2 | kind as u32
}

#[cfg(test)]
mod tests;
