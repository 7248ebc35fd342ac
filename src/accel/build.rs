//! Building the tree: obvhs makes a binary hierarchy (PLOC of Meister and Bittner 2018, with
//! reinsertion), which is then laid out as the nodes that we traverse.
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

/// A mesh has about half as many vertices as triangles if it shares them. With more than this number
/// for four triangles, vertices are compared by their positions.
const WELD_ABOVE: usize = 3;

/// How much work goes into the tree. All but [`Preset::Brute`] are presets of obvhs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// No tree: every primitive is tested. The reference.
    Brute,
    /// The quickest build, clearly slower to trace.
    Fastest,
    /// A little reinsertion.
    VeryFast,
    /// A wider search and more reinsertion.
    Fast,
    /// More of both.
    Medium,
    /// Large triangles are split first.
    Slow,
    /// Everything is reinserted.
    VerySlow,
}

impl Preset {
    /// Every preset, quickest build first.
    pub const ALL: [Self; 7] = [
        Self::Brute,
        Self::Fastest,
        Self::VeryFast,
        Self::Fast,
        Self::Medium,
        Self::Slow,
        Self::VerySlow,
    ];

    /// The preset that is likely to finish first, for so many primitives and expected rays.
    ///
    /// A better tree costs time for each primitive and saves a few per cent of the time of each
    /// ray, so it pays from a certain number of rays for each primitive on.
    pub fn choose(primitives: u64, rays: u64) -> Self {
        match rays / primitives.max(1) {
            0..=3 => Self::VeryFast,
            4..=63 => Self::Fast,
            _ => Self::Medium,
        }
    }

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Brute => "brute",
            Self::Fastest => "fastest",
            Self::VeryFast => "very-fast",
            Self::Fast => "fast",
            Self::Medium => "medium",
            Self::Slow => "slow",
            Self::VerySlow => "very-slow",
        }
    }

    fn cut(self) -> Cut {
        match self {
            Self::Slow | Self::VerySlow => Cut { chunk: usize::MAX, parts: 1 },
            _ => Cut { chunk: 1 << 15, parts: 128 },
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

/// Builds the tree over every primitive that can be hit.
pub fn build(geometry: &Geometry, preset: Preset) -> Tree {
    build_cut(geometry, preset, preset.cut())
}

fn build_cut(geometry: &Geometry, preset: Preset, cut: Cut) -> Tree {
    let parameters = preset.parameters();
    let chunks = order::chunks(geometry, cut.chunk);
    let plan = Plan {
        geometry,
        extents: order::extents(geometry),
        parameters: &parameters,
        weld: geometry.positions.len() > WELD_ABOVE * geometry.triangles.len() / 4,
    };
    let tree = match chunks.lengths.len() {
        0 => None,
        1 => build_whole(&plan, &chunks.numbers),
        _ => chunked::build(&plan, chunks, cut.parts),
    };
    tree.unwrap_or_default()
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
    Some(Tree { arena, root: Some(Root { place, bounds: part.bounds }), census })
}

#[cfg(test)]
mod tests;
