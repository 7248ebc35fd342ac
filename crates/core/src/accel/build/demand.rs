//! Chunks that are built when a ray first reaches them: an image meets few of the triangles of a
//! large scene.
//!
//! The tree above the chunks is built at once, over their boxes. In it an empty list stands for each
//! chunk. The first ray at such a list builds the chunk, while other rays that reach it wait, and the
//! rest of the tree goes on. What was built is proved and appended to the arena before its place
//! is published. Answers are as if everything had been there: a hit does not depend on the tree.

use std::cell::RefCell;
use std::ops::Range;
use std::sync::OnceLock;

use bytemuck::Zeroable;

use super::{BuildPlan, Piece, Preset};
use crate::accel::wide::Part;
use crate::accel::{Arena, Chunk, Demand, Kind, Ref, Searched, Unit};
use crate::geometry::Geometry;
use crate::kernels::Aabb;

thread_local! {
    static PIECE: RefCell<Piece> = RefCell::default();
}

impl Demand {
    /// Units that an entry takes at most: a leaf of its own, and a node of two children. The three
    /// units of a soup hold at least three triangles.
    pub(super) const MOST_UNITS: usize = 3;

    /// Chunks of these entries, of which none is built.
    pub(super) fn new(plan: &BuildPlan, chunks: Vec<(Range<usize>, Aabb)>) -> Self {
        let chunk = |(entries, _)| Chunk { entries, built: OnceLock::new() };
        let chunks = chunks.into_iter().map(chunk).collect();
        Self { extents: plan.extents, chunks }
    }

    /// What stands for a chunk in the tree.
    pub(super) fn place(chunk: usize) -> Unit {
        let mut unit = Unit::zeroed();
        unit.0[1] = chunk as u32;
        unit
    }

    /// The part of the tree with such a `unit`. No part shares a leaf or can be divided, so costs do
    /// not matter.
    pub(super) fn part(bounds: Aabb, unit: usize) -> Part {
        Part { bounds, kind: Kind::List, unit, cost: 0.0 }
    }

    /// The root of a chunk, which is built first if need be; `None` if there is no such chunk.
    pub(super) fn root(&self, arena: &Arena, geometry: &Geometry, chunk: usize) -> Option<Ref> {
        let Chunk { entries, built } = self.chunks.get(chunk)?;
        let build = |piece: &mut Piece| {
            let plan = BuildPlan::new(geometry, Preset::OnDemand, self.extents);
            let parts = piece.parts(&plan, arena.numbers(), entries.clone(), 1);
            let kind = parts.first().map(|part| part.kind);
            let whole =
                kind.and_then(|kind| arena.extend(&piece.output.units, kind, Self::MOST_DEPTH));
            whole.or_else(|| {
                // Too deep: its primitives are tested one by one.
                let numbers: Vec<_> = piece.numbers(geometry).collect();
                piece.output.clear(0);
                piece.output.list(&numbers);
                arena.extend(&piece.output.units, Kind::List, 0)
            })
        };
        let whole = || match PIECE.with_borrow_mut(build) {
            Some(whole) => whole,
            // Without it, the image would silently lack its hits.
            None => unreachable!("a list of all is sound, and there is room for the worst case"),
        };
        Some(built.get_or_init(whole).0)
    }
}

impl Searched<'_> {
    /// The root of the chunk that `place` stands for; `None` for other places.
    #[inline(always)]
    pub(crate) fn chunk(&self, place: Ref) -> Option<Ref> {
        let demand = self.tree.demand.as_ref().filter(|_| place.kind() == Kind::List)?;
        self.root_of(demand, place)
    }

    #[inline(never)]
    fn root_of(&self, demand: &Demand, place: Ref) -> Option<Ref> {
        let arena = &self.tree.arena;
        demand.root(arena, self.geometry, arena.view().chunk(place)?)
    }
}
