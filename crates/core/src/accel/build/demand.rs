//! Chunks that are built when a ray first reaches them: an image meets few of the triangles of a
//! large scene.
//!
//! The tree above the chunks is built at once, over their boxes and over what is too large for them. In it an empty list stands for each
//! chunk. The first ray at such a list builds the chunk, while other rays that reach it wait, and the
//! rest of the tree goes on. What was built is proved and appended to the arena before its place
//! is published. Answers are as if everything had been there: a hit does not depend on the tree.

use std::cell::RefCell;

use super::{BuildPlan, Piece, Preset};
use crate::accel::arena::StandIn;
use crate::accel::{Chunk, Demand, Kind, Ref, Searched};

thread_local! {
    static PIECE: RefCell<Piece> = RefCell::default();
}

impl Demand {
    /// Units that an entry takes at most: a leaf of its own, and a node of two children. The three
    /// units of a soup hold at least three triangles.
    pub(super) const MOST_UNITS: usize = 3;
}

impl Searched<'_> {
    /// The root of the chunk that `place` stands for, which is built first if need be; `None` for
    /// other places.
    #[inline(always)]
    pub(crate) fn chunk(&self, place: Ref) -> Option<Ref> {
        let demand = self.tree.demand.as_ref().filter(|_| place.kind() == Kind::List)?;
        self.root_of(demand, place)
    }

    #[inline(never)]
    fn root_of(&self, demand: &Demand, place: Ref) -> Option<Ref> {
        let (arena, geometry) = (&self.tree.arena, self.geometry);
        let Chunk { entries, built } =
            demand.chunks.get(arena.view().stands_for(StandIn::Chunk, place)?)?;
        let build = |piece: &mut Piece| {
            let plan = BuildPlan::new(geometry, Preset::OnDemand, demand.extents);
            let parts = piece.parts(&plan, arena.numbers(), entries.clone(), 1);
            let whole = parts
                .first()
                .and_then(|part| arena.extend(&piece.output.units, part.kind, Demand::MOST_DEPTH));
            whole.or_else(|| {
                // Too deep: its primitives are tested one by one.
                let numbers = piece.entries.iter().map(|&entry| geometry.number_of(entry));
                let mut numbers: Vec<_> = numbers.collect();
                // Both halves of a quad.
                numbers.sort_unstable();
                numbers.dedup();
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
