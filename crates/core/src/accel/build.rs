//! Building the tree: obvhs makes binary hierarchies (PLOC of Meister and Bittner 2018, with
//! reinsertion), which are then laid out as the nodes that we traverse.
//!
//! Large scenes are cut into chunks ([`order`]) that are built on all threads, each while it is in a
//! core's cache ([`piece`]), placed in one arena ([`chunked`]) and joined by a small hierarchy above
//! ([`join`]).
//!
//! obvhs sees padded boxes and decides topology alone; what is a hit, is decided by
//! [`Geometry::hit`].

mod chunked;
mod join;
mod order;
mod piece;
mod weld;

use obvhs::BvhBuildParams;

use super::arena::{self, Arena};
use super::geometry::Geometry;
use super::tree::{Root, Tree};
use super::units::Units;
use piece::{Piece, Plan};

/// The most primitives in a chunk. Measured: with 32 Ki and 64 Ki a build took a sixth longer, and
/// rays visited at most 2 per cent fewer nodes.
const CHUNK: usize = 1 << 14;

/// About how many parts of a chunk are joined: 48 and 400 made trees as good, 16 worse ones.
const PARTS: usize = 64;

/// A mesh has about half as many vertices as triangles if it shares them. With more than this number
/// for four triangles, vertices are compared by their positions.
const WELD_ABOVE: usize = 3;

/// Rays for each primitive from which on [`Preset::VeryFast`] pays. Over [`Preset::Fastest`] it took
/// 0.08 microseconds more of a core for each triangle, and diffuse rays, of 0.1 to 0.2 microseconds,
/// saved 2 per cent in a scan and up to 18 in rooms, where triangles differ most in size.
const VERY_FAST_FROM: u64 = 4;

/// Rays for each primitive from which on [`Preset::Fast`] and [`Preset::Medium`] pay. Measured on a
/// scan of a million triangles and diffuse rays: over [`Preset::VeryFast`] they took 0.05 and 0.2
/// microseconds more of a core for each triangle, and each ray, of 0.2 microseconds, saved 1.5 and 3
/// per cent.
const FAST_FROM: u64 = 16;
const MEDIUM_FROM: u64 = 32;

wavecrest_base::choices! {
    /// How much work goes into the tree. All but [`Preset::Brute`] are presets of obvhs.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Preset {
        /// No tree: every primitive is tested. The reference.
        Brute = "brute",
        /// The quickest build, clearly slower to trace.
        Fastest = "fastest",
        /// A little reinsertion.
        VeryFast = "very-fast",
        /// A wider search and more reinsertion.
        Fast = "fast",
        /// More of both.
        Medium = "medium",
        /// Large triangles are split first.
        Slow = "slow",
        /// Everything is reinserted.
        VerySlow = "very-slow",
    }
}

impl Preset {
    /// The preset that is likely to finish first, for so many primitives and expected rays.
    ///
    /// A better tree costs time for each primitive and saves a few per cent of the time of each
    /// ray, so it pays from a certain number of rays for each primitive on.
    pub fn choose(primitives: u64, rays: u64) -> Self {
        match rays / primitives.max(1) {
            0..VERY_FAST_FROM => Self::Fastest,
            VERY_FAST_FROM..FAST_FROM => Self::VeryFast,
            FAST_FROM..MEDIUM_FROM => Self::Fast,
            _ => Self::Medium,
        }
    }

    /// Why [`Self::choose`] chooses as it does.
    pub fn reason(primitives: u64, rays: u64) -> String {
        let why = match Self::choose(primitives, rays) {
            Self::Fastest => format!("a better tree pays from {VERY_FAST_FROM} on"),
            Self::VeryFast => format!("a better tree pays from {FAST_FROM} on"),
            Self::Fast => format!("enough for a better tree, the next pays from {MEDIUM_FROM} on"),
            _ => format!("{MEDIUM_FROM} and more pay for a good tree"),
        };
        format!("{} for each primitive: {why}", rays / primitives.max(1))
    }

    /// How many primitives are built at a time: larger scenes are cut. Of presets that split large
    /// triangles or reinsert everything, and so look at the whole, there is no such number.
    pub fn chunk(self) -> usize {
        self.cut().chunk
    }

    fn cut(self) -> Cut {
        match self {
            Self::Slow | Self::VerySlow => Cut { chunk: usize::MAX, parts: 1 },
            _ => Cut { chunk: CHUNK, parts: PARTS },
        }
    }

    fn parameters(self) -> BvhBuildParams {
        match self {
            Self::Brute | Self::Fastest => BvhBuildParams::fastest_build(),
            Self::VeryFast => BvhBuildParams::very_fast_build(),
            Self::Fast => BvhBuildParams::fast_build(),
            Self::Medium => BvhBuildParams::medium_build(),
            Self::Slow => BvhBuildParams::slow_build(),
            Self::VerySlow => BvhBuildParams::very_slow_build(),
        }
    }
}

/// How a tree is cut.
#[derive(Clone, Copy, Debug)]
struct Cut {
    /// The most primitives in a chunk.
    chunk: usize,
    /// The most parts that each of several chunks is cut into.
    parts: usize,
}

/// Builds the tree over every primitive that can be hit: all but those of the `degenerate` triangles, in
/// rising order, that are no seals.
pub fn build(geometry: &Geometry, degenerate: &[u32], preset: Preset) -> Tree {
    build_cut(geometry, degenerate, preset, preset.cut())
}

fn build_cut(geometry: &Geometry, degenerate: &[u32], preset: Preset, cut: Cut) -> Tree {
    let parameters = preset.parameters();
    let left_out = degenerate.iter().copied().filter(|&number| geometry.seal(number).is_none());
    let chunks = order::chunks(geometry, &left_out.collect::<Vec<_>>(), cut.chunk);
    let plan = Plan {
        geometry,
        extents: order::extents(geometry),
        parameters: &parameters,
        once: chunks.lengths.len() == 1,
        weld: geometry.positions.len() > WELD_ABOVE * geometry.triangles.len() / 4,
    };
    let kept = chunks.numbers.len() as u64;
    let tree = match chunks.lengths.len() {
        0 => None,
        1 => build_whole(&plan, &chunks.numbers),
        _ => chunked::build(&plan, chunks, cut.parts),
    };
    Tree { kept, ..tree.unwrap_or_default() }
}

/// Builds the tree in one piece.
fn build_whole(plan: &Plan, numbers: &[u32]) -> Option<Tree> {
    let mut piece = Piece::default();
    piece.build(plan, numbers);
    let part = piece.emit_whole(plan.geometry);
    let output = std::mem::take(&mut piece.output);
    drop(piece);
    let mut units = Units::zeroed(output.units.len());
    units.as_mut_slice().copy_from_slice(&output.units);
    drop(output.units);
    let place = arena::root_of(part.kind);
    let (arena, census) = Arena::new(units, output.numbers, place)?;
    Some(Tree { arena, root: Some(Root { place, bounds: part.bounds }), census, ..Tree::default() })
}

#[cfg(test)]
mod tests;
