//! The memory of the tree: nodes of eight children and leaves, in one arena of 128-byte units.
//!
//! | content | units | holds |
//! |---|---|---|
//! | [`Node`] | 2 | the boxes of 8 children, a plane a row, and the children's places |
//! | [`Patch`] | 1 | up to 8 triangles that share up to 8 vertices |
//! | [`Soup`] | 3 | up to 8 triangles without shared vertices |
//! | list | 1 and more | the numbers of primitives to test one by one |
//!
//! A node comes before its children, with its leaves directly behind it, and stores their places
//! relative to itself. So a part of the tree can be built anywhere and copied unchanged.
//!
//! This and `arena/units.rs`, where threads append to the memory, are the only traversal modules
//! with `unsafe` code. [`Arena::new`] visits every node once and
//! proves that everything reachable from the root lies within the arena, and [`Arena::extend`] does
//! so for each part that comes later. A [`Ref`], which only this module creates, then needs no
//! check.

#![allow(unsafe_code, reason = "places in the arena are proved when it is made")]

mod layout;
mod proof;
mod units;

use std::sync::atomic::{AtomicU32, Ordering};

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::math::LANES;
pub use layout::{LeafHead, NODE_UNITS, Node, Patch, Soup, extent, list_units};
pub use units::Unit;
pub(crate) use units::Units;

/// The content that a [`Ref`] points to.
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

/// The place and kind of content in the arena: the number of its first unit, with its [`Kind`] in
/// the two lowest bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ref(u32);

impl Ref {
    /// The bits, as stored on stacks.
    #[inline(always)]
    pub(super) fn bits(self) -> u32 {
        self.0
    }

    /// From the bits of [`Self::bits`].
    #[inline(always)]
    pub(super) fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// The kind of content.
    #[inline(always)]
    pub fn kind(self) -> Kind {
        match self.0 & 3 {
            0 => Kind::Node,
            1 => Kind::Patch,
            2 => Kind::Soup,
            _ => Kind::List,
        }
    }

    /// The number of the first unit.
    #[inline(always)]
    pub(super) fn unit(self) -> usize {
        (self.0 >> 2) as usize
    }
}

/// What an empty list stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(super) enum StandIn {
    /// A chunk that the first ray to reach it builds.
    Chunk,
    /// An instance.
    Instance,
}

/// The largest number of units that a [`Ref`] can address.
pub const MAX_UNITS: usize = (1 << 30) - 1;

/// A tree in memory.
#[derive(Debug, Default)]
pub struct Arena {
    units: Units,
    /// The numbers of the primitives in leaves. Until a chunk is built, those of its entries.
    numbers: Vec<AtomicU32>,
}

/// What an arena holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct TreeContents {
    /// Inner nodes.
    pub nodes: u64,
    /// Children of inner nodes.
    pub children: u64,
    /// Leaves of triangles that share vertices.
    pub patches: u64,
    /// Leaves of triangles without shared vertices.
    pub soups: u64,
    /// Leaves of other primitives.
    pub lists: u64,
    /// Triangles in leaves; those in several leaves count several times.
    pub triangles: u64,
    /// The largest number of inner nodes on a path from the root.
    pub depth: u64,
}

impl Arena {
    /// The proved arena of `units`, with its contents: everything reachable from `root` lies within
    /// the units and `numbers`. `None` if the proof fails, which is a bug of the builder.
    pub(super) fn new(
        mut units: Units,
        numbers: Vec<AtomicU32>,
        root: Ref,
    ) -> Option<(Self, TreeContents)> {
        if units.len() > MAX_UNITS {
            return None;
        }
        let proof = proof::Proof { units: units.as_mut_slice(), numbers: numbers.len() };
        let census = proof.census(root)?;
        Some((Self { units, numbers }, census))
    }

    /// Adds another part of the tree, with its root first, of this `kind`. Returns its place and
    /// contents; `None` if the proof fails, if it is deeper than `most`, or if there is no room.
    pub(super) fn extend(
        &self,
        units: &[Unit],
        kind: Kind,
        most: u64,
    ) -> Option<(Ref, TreeContents)> {
        let proof = proof::Proof { units, numbers: self.numbers.len() };
        let (census, _) = proof.below((root_of(kind), 1))?;
        if census.depth > most {
            return None;
        }
        let place = self.units.append(units)?;
        Some((Ref((place as u32) << 2 | kind as u32), census))
    }

    /// The numbers of the primitives in leaves.
    pub(super) fn numbers(&self) -> &[AtomicU32] {
        &self.numbers
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        (self.units.len() * size_of::<Unit>() + size_of_val(self.numbers.as_slice())) as u64
    }

    /// The arena as kernels see it.
    #[inline(always)]
    pub(super) fn view(&self) -> ArenaView<'_> {
        ArenaView { units: self.units.as_ptr(), numbers: &self.numbers }
    }
}

/// A proved arena, for kernels.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArenaView<'a> {
    units: *const Unit,
    numbers: &'a [AtomicU32],
}

impl<'a> ArenaView<'a> {
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
        let Unit([count, ..]) = self.at(place);
        let words = self.units.wrapping_add(place.unit()).cast::<u32>();
        // SAFETY: as in `at`; the proof covers all of the list.
        unsafe { std::slice::from_raw_parts(words.add(1), *count as usize) }
    }

    /// The number of the chunk or instance for which the list at `place` stands; `None` for others.
    #[inline(always)]
    pub(super) fn stands_for(self, what: StandIn, place: Ref) -> Option<usize> {
        if place.kind() != Kind::List {
            return None;
        }
        let Unit([count, of, number, ..]) = self.at(place);
        (*count == 0 && *of == what as u32).then_some(*number as usize)
    }

    /// The number of the primitive in `lane`, of those that start at `first`.
    #[inline(always)]
    pub(super) fn number(self, first: u32, lane: usize) -> u32 {
        self.numbers[first as usize + lane].load(Ordering::Relaxed)
    }

    #[inline(always)]
    pub(super) fn number_of(self, leaf: Ref, entry: usize) -> u32 {
        match leaf.kind() {
            Kind::Patch | Kind::Soup => self.number(self.head(leaf).first, entry),
            Kind::List | Kind::Node => self.list(leaf)[entry],
        }
    }

    /// What a patch or a soup has.
    #[inline(always)]
    pub(super) fn head(self, leaf: Ref) -> &'a LeafHead {
        if leaf.kind() == Kind::Soup { &self.soup(leaf).head } else { &self.patch(leaf).head }
    }

    /// The corners of a triangle of a patch or a soup.
    // Written out: `map` would copy whole rows.
    #[inline(always)]
    pub(super) fn triangle(self, leaf: Ref, entry: usize) -> [Vec3; 3] {
        let entry = entry % LANES;
        if leaf.kind() == Kind::Soup {
            let [a, b, c] = &self.soup(leaf).corners;
            let corner = |[x, y, z]: &[[f32; LANES]; 3]| Vec3::new(x[entry], y[entry], z[entry]);
            return [corner(a), corner(b), corner(c)];
        }
        let Patch { positions: [x, y, z], corners: [a, b, c], .. } = self.patch(leaf);
        let vertex = |corner: u32| {
            let v = (corner >> (4 * entry)) as usize % LANES;
            Vec3::new(x[v], y[v], z[v])
        };
        [vertex(*a), vertex(*b), vertex(*c)]
    }

    /// Prefetches the cache lines at `place`: those of a node, whatever the kind, which would take as long to tell.
    #[inline(always)]
    pub(super) fn prefetch(self, place: Ref) {
        let start = self.units.cast::<i8>().wrapping_add(place.unit() * size_of::<Unit>());
        prefetch(start);
        prefetch(start.wrapping_add(64));
        prefetch(start.wrapping_add(128));
        prefetch(start.wrapping_add(192));
    }

    /// Prefetches the cache line of the numbers from `first` on.
    #[inline(always)]
    pub(super) fn prefetch_numbers(self, first: u32) {
        prefetch(self.numbers.as_ptr().wrapping_add(first as usize).cast());
    }

    #[inline(always)]
    fn at<T: Pod>(self, place: Ref) -> &'a T {
        const { assert!(align_of::<T>() <= align_of::<Unit>()) };
        // SAFETY: `place` was reached from the root or is that of a chunk, since nothing else
        // creates a `Ref` while tracing, and `Arena::new` or `Arena::extend` proved that the
        // content of this kind at `place` lies within units that are no longer written. Any bits
        // are a valid `T`, and units are aligned for it.
        unsafe { &*self.units.add(place.unit()).cast::<T>() }
    }
}

/// The `lane`th child of the node at `place`: the bits of both add up, as a node's kind is 0.
pub(super) fn child_of(node: &Node, place: Ref, lane: usize) -> Ref {
    Ref(node.children[lane] + place.0)
}

/// Prefetches a cache line, on targets with such an instruction.
#[inline(always)]
#[cfg_attr(any(not(target_arch = "x86_64"), miri), allow(unused_variables))]
pub(crate) fn prefetch(address: *const i8) {
    #[cfg(all(target_arch = "x86_64", not(miri)))]
    // SAFETY: a hint, which reads nothing and faults nowhere.
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(address);
    }
}

/// A reference to the first unit, of this `kind`.
pub fn root_of(kind: Kind) -> Ref {
    Ref(kind as u32)
}

/// The bits in a node at unit `parent` for a child of `kind` at the later unit `child`.
pub fn relative(parent: usize, child: usize, kind: Kind) -> u32 {
    ((child - parent) as u32) << 2 | kind as u32
}

#[cfg(test)]
mod tests;
