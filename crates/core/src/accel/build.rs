//! Builds the tree: obvhs makes binary hierarchies (PLOC of Meister and Bittner 2018, with
//! reinsertion), which are then converted to our wide nodes.
//!
//! Large scenes are cut into chunks ([`order`]). All threads build chunks, each while it is in a
//! core's cache ([`piece`]), place them in one arena and join them by a small hierarchy
//! above ([`chunked`]). The quickest build finds leaves before the hierarchy ([`leaves`]), and chunks may be left to the
//! rays that reach them ([`demand`]).
//!
//! obvhs sees boxes and decides only the topology; [`Geometry::hit`] decides hits.

mod chunked;
mod coincident;
mod demand;
mod entries;
mod fans;
mod leaves;
mod order;
mod piece;
mod weld;

use obvhs::BvhBuildParams;

use super::{Demand, Tree, Unit};
use crate::geometry::Geometry;
use crate::geometry::instance::Instance;
use crate::kernels::Aabb;
use crate::kernels::slab::PADDING;
use crate::math::float::{max, max_abs};
use entries::Entry;
use leaves::{CurveLeaf, LeafFinder};
use piece::{BuildPlan, Piece};

/// Largest number of triangles in a chunk; halves of quads count as such. Measured: with 32 Ki and 64 Ki a build took a sixth
/// longer, and rays visited at most 2 per cent fewer nodes.
pub const CHUNK: usize = 1 << 14;

/// Approximate number of parts of a chunk that are joined: 48 and 400 made trees as good, 16 worse
/// ones.
const PARTS: usize = 64;

/// Bytes of a tree to reserve for each triangle. Measured: 46 to 53 in meshes that share vertices.
const ROOM: usize = 64;

/// Bytes of a tree to reserve for each primitive in a list: a list alone and its share of a node.
const ROOM_OF_LISTED: usize = 192;

/// A mesh with shared vertices has about half as many vertices as triangles. With more than this
/// number for four triangles, vertices are compared by position.
const WELD_ABOVE: usize = 3;

/// How many times farther out than instances the origins of packets may be: their boxes are padded for it.
const NEAR: f32 = 2.0;

/// Rays for each primitive from which [`Preset::Fastest`] pays: with fewer, part of the scene is
/// likely never reached. Where all of it was, in a terrain of 10 million triangles,
/// [`Preset::OnDemand`] took as long; its rays, of 0.2 microseconds, took 3 to 10 per cent longer.
const FASTEST_FROM: u64 = 2;

/// Rays for each primitive from which [`Preset::VeryFast`] and [`Preset::Fast`] pay. Measured on a
/// scan, a kitchen and a coffee maker of 0.2 to 1.4 million triangles: compared with
/// [`Preset::Fastest`], the first took 0.07 microseconds more of a core for each triangle, and
/// diffuse rays, of 0.2 microseconds, saved 3 to 8 per cent; the second took another 0.06, and rays
/// saved 3 per cent. [`Preset::Medium`] took another 0.13 and saved nothing.
const VERY_FAST_FROM: u64 = 6;
const FAST_FROM: u64 = 16;

wavecrest_base::choices! {
    /// How much work goes into the tree. From [`Preset::VeryFast`] on, they are presets of obvhs.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Preset {
        /// No BVH: tests every primitive, for reference.
        Brute = "brute",
        /// As the next, with fuller leaves; chunks are built by the first ray that reaches them.
        OnDemand = "on-demand",
        /// Leaves along a Morton curve: fastest build, slightly slower rays.
        Fastest = "fastest",
        /// Little reinsertion.
        VeryFast = "very-fast",
        /// Wider search and more reinsertion.
        Fast = "fast",
        /// More of both; rays are rarely faster.
        Medium = "medium",
    }
}

impl Preset {
    /// The preset that is likely to finish first, for this number of primitives and expected rays.
    ///
    /// A better tree costs time for each primitive and saves a few per cent of the time of each
    /// ray, so it pays above a certain number of rays for each primitive.
    pub fn choose(primitives: u64, rays: u64) -> Self {
        match rays / primitives.max(1) {
            0..FASTEST_FROM => Self::OnDemand,
            FASTEST_FROM..VERY_FAST_FROM => Self::Fastest,
            VERY_FAST_FROM..FAST_FROM => Self::VeryFast,
            _ => Self::Fast,
        }
    }

    /// The preset that builds the same before the first ray, for measurements of rays.
    pub fn at_once(self) -> Self {
        if self == Self::OnDemand { Self::Fastest } else { self }
    }

    /// The rounds of reinsertion: the share of nodes in each, relative to the first. `None` stands
    /// for obvhs's own sixteen. With these six a build took a twentieth less time, for as good a
    /// tree.
    fn rounds(self) -> Option<Vec<f32>> {
        let quick = matches!(self, Self::OnDemand | Self::Fastest | Self::VeryFast);
        quick.then(|| [1, 6, 11, 16, 21, 26].map(|n: u8| 1.0 / f32::from(n)).to_vec())
    }

    fn parameters(self) -> BvhBuildParams {
        match self {
            Self::Brute | Self::OnDemand | Self::Fastest | Self::VeryFast => {
                BvhBuildParams::very_fast_build()
            }
            Self::Fast => BvhBuildParams::fast_build(),
            Self::Medium => BvhBuildParams::medium_build(),
        }
    }
}

/// Chunk and part sizes of a build. Of chunks and parts, 0 counts as 1.
#[derive(Clone, Copy, Debug)]
pub struct ChunkSizes {
    /// Largest number of entries in a chunk: primitives, of which a quad has two.
    pub chunk: usize,
    /// Largest number of parts that each of several chunks is cut into.
    pub parts: usize,
    /// Bytes to reserve for each entry. A tree that needs more is built again with enough.
    pub room: usize,
}

impl Default for ChunkSizes {
    fn default() -> Self {
        Self { chunk: CHUNK, parts: PARTS, room: ROOM }
    }
}

/// Builds the tree over every primitive that can be hit, all except triangles without area, and over
/// instances, whose prototypes have the trees `blas`.
pub fn build(geometry: &Geometry, blas: &[Tree], preset: Preset, cut: ChunkSizes) -> Tree {
    let cut = ChunkSizes { chunk: cut.chunk.max(1), parts: cut.parts.max(1), ..cut };
    let extents = order::extents(geometry);
    let (instances, near) = instances(geometry, blas);
    let plan = BuildPlan { instances, ..BuildPlan::new(geometry, preset, extents) };
    let is_later = preset == Preset::OnDemand && geometry.entries() > cut.chunk;
    let mut left_out = 0;
    let mut chunks = |with_boxes| {
        let chunks = order::chunks(geometry, &extents, (cut.chunk, with_boxes));
        left_out = geometry.entries() - chunks.entries.len();
        let parts = chunks.chunks.len() + plan.instances.len();
        Some(chunks).filter(|_| parts > usize::from(with_boxes))
    };
    let tree = is_later.then(|| chunked::on_demand(&plan, chunks(true)?)).flatten();
    let most = Demand::MOST_UNITS * size_of::<Unit>();
    let whole = |room| chunked::build(&plan, chunks(false)?, ChunkSizes { room, ..cut });
    let tree = tree.or_else(|| [cut.room, most].into_iter().find_map(whole));
    let widening = geometry.instances.iter().map(Instance::widening).fold(0.0, max);
    Tree { left_out: left_out as u64, widening, near, ..tree.unwrap_or_default() }
}

/// The boxes of instances, each with the number of its instance, and the largest coordinate of the origins
/// of rays for which they are wide enough.
fn instances(geometry: &Geometry, blas: &[Tree]) -> (Vec<(u32, Aabb)>, f32) {
    let outlines: Vec<_> = blas.iter().map(|tree| tree.outline(1)).collect();
    let shown = (0..).zip(&geometry.instances).filter_map(|(number, instance)| {
        let outline = &outlines[instance.prototype()];
        (!outline.is_empty()).then(|| (number, instance.bounds(outline)))
    });
    let mut boxes: Vec<(u32, Aabb)> = shown.collect();
    let farthest = |(_, Aabb { low, high }): &(u32, Aabb)| max(max_abs(*low), max_abs(*high));
    let near = NEAR * boxes.iter().map(farthest).fold(0.0, max);
    for (number, Aabb { low, high }) in &mut boxes {
        let pad = geometry.instances[*number as usize].widening() * PADDING * near;
        (*low, *high) = (*low - pad, *high + pad);
    }
    (boxes, near)
}
