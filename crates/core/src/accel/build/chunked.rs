//! Builds a tree in chunks: each is built and converted while it is in a core's cache, and one
//! small hierarchy joins them.
//!
//! A chunk's parts are copied into the arena as soon as all chunks before it have their places. So
//! the tree is the same for any number of threads and is never held twice.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::join;
use super::order::Chunks;
use super::piece::{Piece, Plan, UpperNodes};
use crate::accel::arena::{self, Arena, Kind, NODE_UNITS, Unit};
use crate::accel::geometry::{Geometry, Primitive};
use crate::accel::tree::{Root, Tree};
use crate::accel::units::Units;
use crate::math::simd::LANES;

/// The largest number of units that a primitive can take: its own leaf, and the node above it.
const MOST_UNITS: usize = 1 + NODE_UNITS;

/// A chunk to build.
struct Task<'a> {
    chunk: usize,
    /// The chunk's range of the tree's numbers, its start, and the number of primitives listed in
    /// it.
    numbers: &'a mut [u32],
    first: u32,
    count: usize,
}

/// Builds the tree over two or more chunks, each cut into about `parts` parts.
pub(super) fn build(plan: &Plan, chunks: Chunks, parts: usize) -> Option<Tree> {
    let (mut numbers, lengths) = with_room_for_halves(plan.geometry, chunks);
    // The nodes that join the parts come first: fewer than there are parts, plus those that
    // opening the last node may have added.
    let ahead = NODE_UNITS * (parts + LANES) * lengths.len();
    // Address space for the worst case: unwritten pages take no memory.
    let mut units = Units::zeroed(ahead + MOST_UNITS * numbers.len());
    let (top, rest) = units.as_mut_slice().split_at_mut(ahead);
    let mut ranges = Vec::with_capacity(lengths.len());
    let mut left = numbers.as_mut_slice();
    let mut first = 0;
    for &Length { count, room } in &lengths {
        let (numbers, after) = std::mem::take(&mut left).split_at_mut(room);
        ranges.push(Task { chunk: ranges.len(), first, numbers, count });
        left = after;
        first += room as u32;
    }
    let tasks = Mutex::new(ranges.into_iter());
    let assembly = Mutex::new(Assembly { rest, used: ahead, ..Assembly::default() });
    in_separate_pools(lengths.len(), || {
        let mut piece = Piece::default();
        while let Some(task) = next(&tasks) {
            build_chunk(plan, parts, &mut piece, task, &assembly);
        }
    });
    let Assembly { used, upper_nodes, .. } =
        assembly.into_inner().unwrap_or_else(PoisonError::into_inner);
    let (start, bounds) = join::join(plan.geometry, &upper_nodes, top)?;
    units.keep(start..used);
    let place = arena::root_of(Kind::Node);
    let (arena, census) = Arena::new(units, numbers, place)?;
    Some(Tree { arena, root: Some(Root { place, bounds }), census, ..Tree::default() })
}

/// Number of primitives in a chunk, and of numbers that its leaves may need.
struct Length {
    count: usize,
    room: usize,
}

/// The numbers, with room in each chunk to repeat those of quads: leaves hold the halves
/// separately.
fn with_room_for_halves(geometry: &Geometry, chunks: Chunks) -> (Vec<u32>, Vec<Length>) {
    let Chunks { numbers, lengths } = chunks;
    if geometry.quads.is_empty() {
        let lengths = lengths.into_iter().map(|count| Length { count, room: count });
        return (numbers, lengths.collect());
    }
    let mut wider = Vec::with_capacity(numbers.len() + geometry.quads.len());
    let mut rest = numbers.as_slice();
    let widen = |count| {
        let (own, after) = rest.split_at(count);
        rest = after;
        let is_quad = |&number: &u32| matches!(geometry.primitive(number), Primitive::Quad(_));
        let quads = own.iter().filter(|number| is_quad(number)).count();
        wider.extend_from_slice(own);
        wider.resize(wider.len() + quads, 0);
        Length { count, room: count + quads }
    };
    let lengths = lengths.into_iter().map(widen).collect();
    (wider, lengths)
}

/// Runs `work` once on each thread of the current pool, at most `most` times, in pools of one
/// thread. obvhs runs parallel work itself; a thread that waits for it would otherwise start
/// another chunk, with its own memory.
fn in_separate_pools(most: usize, work: impl Fn() + Sync) {
    let threads = rayon::current_num_threads().min(most);
    let pool = || rayon::ThreadPoolBuilder::new().num_threads(1).build().ok();
    let pools: Vec<_> = (0..threads).filter_map(|_| pool()).collect();
    if pools.is_empty() {
        return work();
    }
    rayon::scope(|scope| {
        for pool in &pools {
            scope.spawn(|_| pool.install(&work));
        }
    });
}

fn next<'a>(tasks: &Mutex<impl Iterator<Item = Task<'a>>>) -> Option<Task<'a>> {
    lock(tasks).next()
}

/// No thread panics while it holds a lock, and the content would still be sound if one did.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn build_chunk(
    plan: &Plan,
    parts: usize,
    piece: &mut Piece,
    task: Task,
    assembly: &Mutex<Assembly>,
) {
    piece.output.units.clear();
    piece.output.numbers.clear();
    piece.output.first_number = task.first;
    piece.build(plan, &task.numbers[..task.count]);
    let upper = piece.emit_upper(plan, parts);
    // Only triangles have their numbers there: the rest stays unchanged.
    let leaves = &piece.output.numbers;
    task.numbers[..leaves.len()].copy_from_slice(leaves);
    place(assembly, task.chunk, &mut piece.output.units, upper);
}

/// The places of chunks in the arena.
#[derive(Default)]
struct Assembly<'a> {
    /// The next chunk to place.
    next: usize,
    /// The free units, and the number of the first.
    rest: &'a mut [Unit],
    used: usize,
    /// Chunks that were finished before their turn.
    early: BTreeMap<usize, (Vec<Unit>, UpperNodes)>,
    /// The tops of the placed chunks.
    upper_nodes: Vec<UpperNodes>,
}

impl<'a> Assembly<'a> {
    /// Reserves room for the next chunk.
    fn claim(&mut self, units: usize, mut upper: UpperNodes) -> &'a mut [Unit] {
        let (room, rest) = std::mem::take(&mut self.rest).split_at_mut(units);
        self.rest = rest;
        upper.parts.iter_mut().for_each(|part| part.unit += self.used);
        self.upper_nodes.push(upper);
        self.used += units;
        self.next += 1;
        room
    }
}

/// Copies a chunk to its place, with the chunks that waited for it; or keeps it waiting.
fn place(assembly: &Mutex<Assembly>, chunk: usize, units: &mut Vec<Unit>, upper: UpperNodes) {
    let mut waited = Vec::new();
    let room = {
        let mut assembly = lock(assembly);
        if chunk != assembly.next {
            assembly.early.insert(chunk, (std::mem::take(units), upper));
            return;
        }
        let room = assembly.claim(units.len(), upper);
        let mut next = assembly.next;
        while let Some((units, upper)) = assembly.early.remove(&next) {
            waited.push((assembly.claim(units.len(), upper), units));
            next = assembly.next;
        }
        room
    };
    room.copy_from_slice(units);
    for (room, units) in waited {
        room.copy_from_slice(&units);
    }
}
