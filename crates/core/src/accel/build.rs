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

/// Largest number of triangles in a chunk; halves of quads count as such. Measured: trees of 4, 8 and 16 Ki, each with 8
/// to 64 parts, were as good and built as fast. Chunks of 4 Ki that rays build took 2 to 4 per cent less time than of 8 Ki.
pub const CHUNK: usize = 1 << 12;

/// Approximate number of parts of a chunk that are joined.
const PARTS: usize = 8;

/// Bytes of a tree to reserve for each triangle. Measured: 46 to 53 in meshes that share vertices.
const ROOM: usize = 64;

/// Bytes of a tree to reserve for each primitive in a list: a list alone and its share of a node.
const ROOM_OF_LISTED: usize = 192;

/// A mesh with shared vertices has about half as many vertices as triangles. With more than this
/// number for four triangles, vertices are compared by position.
const WELD_ABOVE: usize = 3;

/// How many times farther out than instances the origins of packets may be: their boxes are padded for it.
const NEAR: f32 = 2.0;

/// Rays for each primitive below which [`Preset::OnDemand`] is chosen: part of the scene is likely never reached. Where
/// all of it was, in meshes of 4 and 10 million triangles, it took 3 to 4 per cent longer than [`Preset::Fastest`], and
/// the tree a fifth less memory.
const ON_DEMAND_BELOW: u64 = 2;

/// Rays for each primitive out of view below which [`Preset::OnDemand`] is chosen. Measured in the first of two and four
/// kitchens side by side, of 2.9 and 5.8 million triangles: it took 0.90 and 0.77 of the time. In one kitchen, with 16
/// rays for each primitive out of view, it took 3 per cent longer.
const OUT_OF_VIEW_BELOW: u64 = 16;

/// Rays for each primitive from which [`Preset::Fast`] pays. Measured on scans, a terrain, a kitchen and a coffee maker
/// of 0.2 to 2 million triangles: up to 20 it took 4 to 9 per cent longer than [`Preset::Fastest`], from 70 on 1 to 4 less.
/// [`Preset::VeryFast`] was never better than both by more than 1 per cent.
const FAST_FROM: u64 = 32;

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
    /// The preset whose tree, complete before the first ray, is likely to finish first, for this number of primitives
    /// and expected rays: a better tree costs time for each primitive, and saves some of each ray.
    pub fn choose(primitives: u64, rays: u64) -> Self {
        if rays < FAST_FROM * primitives { Self::Fastest } else { Self::Fast }
    }

    /// As [`Self::choose`], where rays may build what they reach, and so many primitives are `out_of_view`.
    pub fn choose_for_part(primitives: u64, out_of_view: u64, rays: u64) -> Self {
        let least = (ON_DEMAND_BELOW * primitives).max(OUT_OF_VIEW_BELOW * out_of_view);
        if rays < least { Self::OnDemand } else { Self::choose(primitives, rays) }
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
    let mut order = || {
        let order = order::order(geometry, &extents, cut.chunk);
        left_out = geometry.entries() - order.entries.len();
        Some(order).filter(|order| order.groups() + plan.instances.len() > 0)
    };
    let tree = is_later.then(|| chunked::on_demand(&plan, order()?)).flatten();
    let most = Demand::MOST_UNITS * size_of::<Unit>();
    let whole = |room| chunked::build(&plan, order()?, ChunkSizes { room, ..cut });
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
