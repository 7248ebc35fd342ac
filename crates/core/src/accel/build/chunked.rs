//! Builds a tree in chunks: each is built, converted and copied to its place while it is in a core's
//! cache. One hierarchy above the parts of all joins them, improved by reinsertion, and converted as if
//! there were no chunks.
//!
//! The tree is the same for any number of threads, but for the order of the chunks in memory.

use std::ops::Range;
use std::sync::OnceLock;
use std::sync::atomic::AtomicU32;

use bytemuck::Zeroable;
use obvhs::BvhBuildParams;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance};
use rayon::prelude::*;

use super::order::{Chunks, Order};
use super::piece::{from_obvhs, to_obvhs};
use super::{BuildPlan, ChunkSizes, Piece, ROOM_OF_LISTED};
use crate::accel::arena::{self, MAX_UNITS, NODE_UNITS, StandIn};
use crate::accel::wide::{Converter, Output, Owner, Part};
use crate::accel::{Arena, Chunk, Demand, Kind, Root, Tree, Unit, Units};
use crate::geometry::{Geometry, Surfaces};
use crate::kernels::Aabb;
use crate::math::LANES;
use wavecrest_base::progress;

/// The share of the nodes above the parts that is reinserted at a time: more gained nothing.
const REINSERTED: f32 = 0.2;

/// Most instances that are joined at a time, and parts of large entries: a bottom-up builder takes quadratic time over
/// boxes that are nested.
const JOINED: usize = 1024;

/// Builds the tree; there is none over nothing, nor over a scene that needs more room than `cut`
/// gives.
pub(super) fn build(plan: &BuildPlan, order: Order, cut: ChunkSizes) -> Option<Tree> {
    let instances = plan.instances.len();
    let parts = if order.groups() + instances == 1 { 1 } else { cut.parts };
    // A piece may open its last node for more parts than were asked for.
    let ahead = ahead((parts + LANES) * order.groups() + order.large() + joined_apart(instances));
    let listed = plan.geometry.quadrics.len() * ROOM_OF_LISTED;
    let few_shared = if plan.weld { 2 } else { 1 };
    let room = (order.entries.len() * cut.room * few_shared + listed).div_ceil(size_of::<Unit>());
    let units = Units::zeroed(ahead + room + instances, ahead);
    progress::expect(order.entries.len() as u64);
    let build = |piece: &mut Piece, (own, _): &(Range<usize>, Aabb)| {
        append(plan, &order.entries, own.clone(), parts, (piece, &units))
    };
    let of_chunks = |chunks: &Chunks| {
        let all = chunks.boxed.par_iter().map_init(Piece::default, build);
        Some(all.collect::<Option<Vec<_>>>()?.concat())
    };
    let parts = with_large(plan, &order, &units, of_chunks)?;
    joined(plan, (units, ahead), order.entries, parts)
}

/// A tree whose chunks are built by the rays that reach them; `None` if there is no room for it and
/// as much for everything else.
pub(super) fn on_demand(plan: &BuildPlan, order: Order) -> Option<Tree> {
    let instances = plan.instances.len();
    let ahead = ahead(order.groups() + order.large() + joined_apart(instances));
    let room = order.groups() + instances + order.entries.len() * Demand::MOST_UNITS;
    // A root stands for no chunk.
    if ahead + room > MAX_UNITS || order.groups() + instances == 1 {
        return None;
    }
    let units = Units::mapped(ahead + room, ahead)?;
    // Where address space is limited, all else must find room too: a probe, unmapped at once.
    drop(Units::mapped(ahead + room, 0)?);
    let chunks = order.surfaces.iter().flat_map(|of| &of.boxed);
    let unbuilt =
        |(own, _): &(Range<usize>, _)| Chunk { entries: own.clone(), built: OnceLock::new() };
    let unbuilt = chunks.map(unbuilt).collect();
    let mut numbers = 0..;
    let of_chunks = |chunks: &Chunks| {
        let boxes = chunks.boxed.iter().map(|&(_, bounds)| bounds);
        let numbered = boxes.zip(numbers.by_ref());
        numbered
            .map(|(bounds, number)| stand_in(&units, StandIn::Chunk, (number, bounds)))
            .collect()
    };
    let parts = with_large(plan, &order, &units, of_chunks)?;
    let tree = joined(plan, (units, ahead), order.entries, parts)?;
    Some(Tree { demand: Some(Demand { extents: plan.extents, chunks: unbuilt }), ..tree })
}

/// The parts of each kind of surfaces: those that chunks become, and those of large entries, as small as may be.
fn with_large(
    plan: &BuildPlan,
    order: &Order,
    units: &Units,
    mut of_chunks: impl FnMut(&Chunks) -> Option<Vec<Part>>,
) -> Option<[Vec<Part>; Surfaces::ALL.len()]> {
    let [a, b, c] = order.surfaces.each_ref().map(|chunks| {
        let mut parts = of_chunks(chunks)?;
        let large = chunks.large.clone();
        if !large.is_empty() {
            let (most, place) = (large.len().min(JOINED), (&mut Piece::default(), units));
            parts.extend(append(plan, &order.entries, large, most, place)?);
        }
        Some(parts)
    });
    Some([a?, b?, c?])
}

/// Builds some entries, at least one, and appends them in about `parts` parts.
fn append(
    plan: &BuildPlan,
    entries: &[AtomicU32],
    own: Range<usize>,
    parts: usize,
    (piece, units): (&mut Piece, &Units),
) -> Option<Vec<Part>> {
    progress::add(own.len() as u64);
    let mut parts = piece.parts(plan, entries, own, parts);
    let place = units.append(&piece.output.units)?;
    parts.iter_mut().for_each(|part| part.unit += place);
    Some(parts)
}

/// The part that stands for a chunk or an instance with that number and box: an empty list. It shares no
/// leaf and cannot be divided, so costs do not matter.
fn stand_in(units: &Units, what: StandIn, (number, bounds): (u32, Aabb)) -> Option<Part> {
    let mut list = Unit::zeroed();
    (list.0[1], list.0[2]) = (what as u32, number);
    let unit = units.append(&[list])?;
    Some(Part { bounds, kind: Kind::List, unit, cost: 0.0 })
}

/// The units that the nodes above this many parts need at most: fewer nodes than parts, plus those
/// that opening the last node may have added.
fn ahead(parts: usize) -> usize {
    NODE_UNITS * (parts + LANES)
}

/// So many parts need as many nodes as these instances: those that opening the last nodes may add are far fewer.
fn joined_apart(instances: usize) -> usize {
    instances + instances / LANES
}

/// The tree of the parts of each kind of surfaces, which are in `units` behind the room `ahead`, and of instances,
/// which are opaque.
fn joined(
    plan: &BuildPlan,
    (mut units, ahead): (Units, usize),
    numbers: Vec<AtomicU32>,
    mut parts: [Vec<Part>; 3],
) -> Option<Tree> {
    let instances = plan.instances.iter();
    let instances = instances.map(|&instance| stand_in(&units, StandIn::Instance, instance));
    let mut instances = instances.collect::<Option<Vec<_>>>()?;
    let mut above = Above { units: Vec::new(), start: ahead };
    while instances.len() > JOINED {
        instances = above.join_apart(plan.geometry, &mut instances)?;
    }
    parts[Surfaces::Opaque as usize].extend(instances);
    // From the last to the first, as each is written before those that are there.
    let mut own = [None; Surfaces::ALL.len()];
    for (own, parts) in own.iter_mut().zip(&parts).rev() {
        *own = above.join(plan.geometry, parts);
    }
    let whole = above.join(plan.geometry, &own.into_iter().flatten().collect::<Vec<_>>())?;
    units.begin_with(&above.units, ahead)?;
    let root = Root { place: arena::root_of(whole.kind), bounds: whole.bounds };
    let (arena, census) = Arena::new(units, numbers, root.place)?;
    let mut tree = Tree { arena, root: Some(root), census, ..Tree::default() };
    let parts: Vec<_> = match own.iter().flatten().count() {
        1 => vec![root],
        _ => tree.below(root),
    };
    for (surfaces, part) in tree.surfaces.iter_mut().zip(own) {
        let is_there =
            |root: &&Root| Some(root.place.unit() + above.start) == part.map(|of| of.unit);
        *surfaces = parts.iter().find(is_there).copied();
    }
    Some(tree)
}

/// The nodes above parts.
struct Above {
    units: Vec<Unit>,
    /// The place of the first.
    start: usize,
}

impl Above {
    /// Joins parts that are near to each other, up to [`JOINED`] at a time.
    fn join_apart(&mut self, geometry: &Geometry, parts: &mut [Part]) -> Option<Vec<Part>> {
        if parts.len() <= JOINED {
            return Some(vec![self.join(geometry, parts)?]);
        }
        let middle = |part: &Part| part.bounds.low + part.bounds.high;
        let centers = parts.iter().map(|part| Aabb::around([middle(part)]));
        let around = centers.fold(Aabb::EMPTY, Aabb::union);
        let axis = (around.high - around.low).max_position();
        let half = parts.len() / 2;
        parts.select_nth_unstable_by(half, |a, b| {
            middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.unit.cmp(&b.unit))
        });
        let (left, right) = parts.split_at_mut(half);
        let mut joined = self.join_apart(geometry, left)?;
        joined.extend(self.join_apart(geometry, right)?);
        Some(joined)
    }

    /// Joins some parts by nodes, which come before those that are there; `None` without parts.
    fn join(&mut self, geometry: &Geometry, parts: &[Part]) -> Option<Part> {
        if let [] | [_] = parts {
            return parts.first().copied();
        }
        let boxes: Vec<_> = parts.iter().map(|part| to_obvhs(part.bounds)).collect();
        let mut bvh = PlocBuilder::new().build(
            PlocSearchDistance::Low,
            &boxes,
            (0..boxes.len() as u32).collect(),
            BvhBuildParams::medium_build().sort_precision,
            0,
        );
        ReinsertionOptimizer::default().run(&mut bvh, REINSERTED, None);
        let mut converter = Converter::default();
        converter.evaluate(&bvh, |owner| Owner::Part(parts[owner as usize]));
        let bounds = from_obvhs(bvh.nodes.first()?.aabb());
        // The start of the nodes follows from their number: they are written twice.
        let (mut unit, mut kind) = (0, Kind::Node);
        let mut output = Output::default();
        for _ in 0..2 {
            output.units.clear();
            let moved = |owner: u32| {
                let part = parts[owner as usize];
                Owner::Part(Part { unit: part.unit - unit, ..part })
            };
            kind = converter.emit(geometry, &bvh, moved, 0, &mut output);
            unit = self.start.checked_sub(output.units.len())?;
        }
        self.start = unit;
        self.units.splice(..0, output.units);
        Some(Part { bounds, kind, unit, cost: converter.cost(0) })
    }
}
