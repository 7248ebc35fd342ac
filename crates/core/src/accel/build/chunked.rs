//! Builds a tree in chunks: each is built and converted while it is in a core's cache, and one
//! small hierarchy joins them.
//!
//! A chunk's parts are copied into the arena as soon as all chunks before it have their places. So
//! the tree is the same for any number of threads and is in memory only once. A tree with unusually
//! many bytes for each primitive is the exception: at the end it moves to a larger arena.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::join;
use super::order::Chunks;
use super::piece::{Piece, Plan};
use crate::accel::arena::{self, Arena, Kind, NODE_UNITS, Unit};
use crate::accel::geometry::{Geometry, Primitive};
use crate::accel::tree::{Root, Tree};
use crate::accel::units::Units;
use crate::accel::wide::Part;
use crate::math::simd::LANES;

/// A chunk to build.
struct Task<'a> {
    chunk: usize,
    /// The chunk's range of the tree's numbers, its start, and the number of primitives listed in
    /// it.
    numbers: &'a mut [u32],
    first: u32,
    count: usize,
}

/// Builds the tree over two or more chunks, each cut into about `parts` parts. Reserves `room` bytes
/// for each primitive; a tree that needs more moves to a larger arena at the end.
pub(super) fn build(plan: &Plan, chunks: Chunks, parts: usize, room: usize) -> Option<Tree> {
    let (mut numbers, lengths) = with_room_for_halves(plan.geometry, chunks);
    // The nodes that join the parts come first: fewer than there are parts, plus those that
    // opening the last node may have added.
    let ahead = NODE_UNITS * (parts + LANES) * lengths.len();
    // Unwritten pages take address space but no memory.
    let mut units = Units::zeroed(ahead + (numbers.len() * room).div_ceil(size_of::<Unit>()));
    let (_, rest) = units.as_mut_slice().split_at_mut(ahead);
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
    let Assembly { used, parts, late, .. } =
        assembly.into_inner().unwrap_or_else(PoisonError::into_inner);
    if !late.is_empty() {
        units = lengthened(units, ahead, used, late);
    }
    let (top, _) = units.as_mut_slice().split_at_mut(ahead);
    let (start, bounds) = join::join(plan.geometry, &parts, top)?;
    units.keep(start..used);
    let place = arena::root_of(Kind::Node);
    let (arena, census) = Arena::new(units, numbers, place)?;
    Some(Tree { arena, root: Some(Root { place, bounds }), census, ..Tree::default() })
}

/// Copies the arena to one of `used` units and appends the chunks `late`. The first `ahead` units stay
/// zero.
fn lengthened(units: Units, ahead: usize, used: usize, late: Vec<Vec<Unit>>) -> Units {
    let mut longer = Units::zeroed(used);
    let mut end = used - late.iter().map(Vec::len).sum::<usize>();
    let all = longer.as_mut_slice();
    all[ahead..end].copy_from_slice(&units[ahead..end]);
    drop(units);
    for chunk in late {
        all[end..end + chunk.len()].copy_from_slice(&chunk);
        end += chunk.len();
    }
    longer
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
    let parts = piece.emit_parts(plan, parts);
    // Only triangles have their numbers there: the rest stays unchanged.
    let leaves = &piece.output.numbers;
    task.numbers[..leaves.len()].copy_from_slice(leaves);
    place(assembly, task.chunk, &mut piece.output.units, parts);
}

/// The places of chunks in the arena.
#[derive(Default)]
struct Assembly<'a> {
    /// The next chunk to place.
    next: usize,
    /// The free units, and the number of units used, including those of `late`.
    rest: &'a mut [Unit],
    used: usize,
    /// The chunks for which no room was left, in order.
    late: Vec<Vec<Unit>>,
    /// Chunks that were finished before their turn.
    early: BTreeMap<usize, (Vec<Unit>, Vec<Part>)>,
    /// The tops of the placed chunks.
    parts: Vec<Part>,
}

impl<'a> Assembly<'a> {
    /// Reserves room for the next chunk: returns the units and their destination, or keeps the units
    /// in `late` if no room is left.
    fn claim(
        &mut self,
        units: Vec<Unit>,
        mut parts: Vec<Part>,
    ) -> Option<(&'a mut [Unit], Vec<Unit>)> {
        parts.iter_mut().for_each(|part| part.unit += self.used);
        self.parts.append(&mut parts);
        self.used += units.len();
        self.next += 1;
        match std::mem::take(&mut self.rest).split_at_mut_checked(units.len()) {
            Some((room, rest)) => {
                self.rest = rest;
                Some((room, units))
            }
            None => {
                self.late.push(units);
                None
            }
        }
    }
}

/// Copies a chunk to its place, with the chunks that waited for it; or keeps it waiting.
fn place(assembly: &Mutex<Assembly>, chunk: usize, units: &mut Vec<Unit>, parts: Vec<Part>) {
    let own = std::mem::take(units);
    let mut waited = Vec::new();
    let claimed = {
        let mut assembly = lock(assembly);
        if chunk != assembly.next {
            assembly.early.insert(chunk, (own, parts));
            return;
        }
        let claimed = assembly.claim(own, parts);
        let mut next = assembly.next;
        while let Some((units, parts)) = assembly.early.remove(&next) {
            waited.extend(assembly.claim(units, parts));
            next = assembly.next;
        }
        claimed
    };
    if let Some((room, own)) = claimed {
        room.copy_from_slice(&own);
        // Kept for the next chunk.
        *units = own;
    }
    for (room, units) in waited {
        room.copy_from_slice(&units);
    }
}
