//! Builds a tree in chunks: each is built and converted while it is in a core's cache, and one
//! small hierarchy joins them.
//!
//! A chunk's parts are copied into the arena as soon as all chunks before it have their places. So
//! the tree is the same for any number of threads and is in memory only once. A tree with unusually
//! many bytes for each entry is the exception: at the end it moves to a larger arena.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::Cut;
use super::join::join;
use super::order::Chunks;
use super::piece::{Piece, Plan};
use crate::accel::arena::{self, Arena, NODE_UNITS, Unit};
use crate::accel::tree::{Root, Tree};
use crate::accel::units::Units;
use crate::accel::wide::Part;
use crate::math::simd::LANES;

/// Builds the tree; there is none over nothing. A tree that needs more room than `cut` gives
/// moves to a larger arena at the end.
pub(super) fn build(plan: &Plan, chunks: Chunks, cut: Cut) -> Option<Tree> {
    let Chunks { mut entries, lengths } = chunks;
    if lengths.is_empty() {
        return None;
    }
    let parts = if lengths.len() == 1 { 1 } else { cut.parts };
    // The nodes that join the parts come first: fewer than there are parts, plus those that
    // opening the last node may have added.
    let ahead = NODE_UNITS * (parts + LANES) * lengths.len();
    // Unwritten pages take address space but no memory.
    let room = entries.len() * cut.room * if plan.weld { 2 } else { 1 };
    let mut units = Units::zeroed(ahead + room.div_ceil(size_of::<Unit>()));
    let (_, rest) = units.as_mut_slice().split_at_mut(ahead);
    let assembly = Mutex::new(Assembly { rest, used: ahead, ..Assembly::default() });
    let mut left = entries.as_mut_slice();
    let mut start = 0;
    let in_turn = lengths.iter().enumerate().map(|(chunk, &length)| {
        let (own, after) = std::mem::take(&mut left).split_at_mut(length);
        (left, start) = (after, start + length);
        (chunk, start - length, own)
    });
    in_turn.par_bridge().for_each_init(Piece::default, |piece, (chunk, first, entries)| {
        piece.output.units.clear();
        piece.output.numbers.clear();
        piece.output.first_number = first as u32;
        piece.build(plan, entries);
        let parts = piece.emit(plan, parts);
        // The leaves' numbers take the place of the entries.
        let leaves = &piece.output.numbers;
        entries[..leaves.len()].copy_from_slice(leaves);
        place(&assembly, chunk, &mut piece.output.units, parts);
    });
    let Assembly { used, parts, late, .. } =
        assembly.into_inner().unwrap_or_else(PoisonError::into_inner);
    if !late.is_empty() {
        units = lengthened(units, ahead, used, late);
    }
    let (top, _) = units.as_mut_slice().split_at_mut(ahead);
    let (start, kind, bounds) = join(plan.geometry, &parts, top)?;
    units.keep(start..used);
    let place = arena::root_of(kind);
    let (arena, census) = Arena::new(units, entries, place)?;
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
    /// The parts of the placed chunks.
    parts: Vec<Part>,
}

/// Copies a chunk to its place, with the chunks that waited for it; or keeps it waiting.
fn place(assembly: &Mutex<Assembly>, chunk: usize, units: &mut Vec<Unit>, parts: Vec<Part>) {
    let mut placed = Vec::new();
    {
        // No thread panics while it holds the lock.
        let assembly = &mut *assembly.lock().unwrap_or_else(PoisonError::into_inner);
        assembly.early.insert(chunk, (std::mem::take(units), parts));
        while let Some((units, parts)) = assembly.early.remove(&assembly.next) {
            let moved = |part: Part| Part { unit: part.unit + assembly.used, ..part };
            assembly.parts.extend(parts.into_iter().map(moved));
            assembly.used += units.len();
            assembly.next += 1;
            match std::mem::take(&mut assembly.rest).split_at_mut_checked(units.len()) {
                Some((room, rest)) => {
                    assembly.rest = rest;
                    placed.push((room, units));
                }
                None => assembly.late.push(units),
            }
        }
    }
    for (room, from) in placed {
        room.copy_from_slice(&from);
        // Kept for the next chunk.
        *units = from;
    }
}
