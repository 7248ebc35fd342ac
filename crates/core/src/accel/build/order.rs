//! A spatial order of what leaves hold, cut into chunks.
//!
//! A pass over every entry, in the scene's order, finds triangles without area, and the cell of a
//! coarse grid that contains the centre of each other entry. Cells follow Morton's curve. A cell with
//! too many entries is ordered by a finer grid of its own, so that the scene may be very uneven.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use obvhs::ploc::morton::morton_encode_u32;
use rayon::prelude::*;

use crate::geometry::{Geometry, sphere_bounds};
use crate::kernels::slab::Aabb;
use crate::kernels::triangle::is_degenerate;

/// Bits of the grid for each axis: counters of its cells then stay in the second-level cache.
const BITS: u32 = 5;

/// Cells of the grid.
const CELLS: usize = 1 << (3 * BITS);

/// The cell of triangles without area.
const NOWHERE: u16 = u16::MAX;

/// Number of blocks of entries for each thread, so that threads finish together, and the smallest
/// block that is worth its own counters. They affect only time.
const BLOCKS_A_THREAD: usize = 4;
const MOST_BLOCKS: usize = 64;
const LEAST_BLOCK: usize = 1 << 14;

/// Entries in order.
#[derive(Default)]
pub(super) struct Chunks {
    pub(super) entries: Vec<u32>,
    /// Number of entries in each chunk; their sum is the number of all, and no chunk is empty.
    pub(super) lengths: Vec<usize>,
}

/// A box around everything that `geometry` holds itself.
pub(super) fn extents(geometry: &Geometry) -> Aabb {
    let spheres = geometry.spheres.par_iter().map(|&sphere| sphere_bounds(sphere));
    around(geometry.positions.par_iter().copied().map(point)).union(around(spheres))
}

/// Orders the entries that can be hit, all but triangles without area, and cuts them into chunks of
/// at most `most`.
pub(super) fn chunks(geometry: &Geometry, extents: &Aabb, most: usize) -> Chunks {
    let mut entries: Vec<u32> = (0..geometry.entries() as u32).collect();
    if entries.len() > most {
        return arrange(geometry, &entries, extents, most);
    }
    entries.retain(|&entry| is_met(geometry, entry));
    let lengths = if entries.is_empty() { Vec::new() } else { vec![entries.len()] };
    Chunks { entries, lengths }
}

#[inline(always)]
fn is_met(geometry: &Geometry, entry: u32) -> bool {
    let index = entry as usize;
    index >= geometry.triangles.len() || !is_degenerate(&geometry.triangle(index))
}

/// Sorts by the cells of a grid in `bounds`, and cuts.
fn arrange(geometry: &Geometry, members: &[u32], bounds: &Aabb, most: usize) -> Chunks {
    let scale = (1 << BITS) as f32 / (bounds.high - bounds.low).max_element();
    let cell = |&entry: &u32| {
        if !is_met(geometry, entry) {
            return NOWHERE;
        }
        // Centres outside count as at the border. In a grid of size zero, 0 x inf is NaN, and
        // counts as 0.
        let at = (middle(geometry, entry) - bounds.low) * scale;
        let [x, y, z] = at.to_array().map(|x| (x as u16).min((1 << BITS) - 1));
        morton_encode_u32(x, y, z) as u16
    };
    let blocks = (BLOCKS_A_THREAD * rayon::current_num_threads()).min(MOST_BLOCKS);
    let block = members.len().div_ceil(blocks).max(LEAST_BLOCK);
    let count = |members: &[u32]| {
        let cells: Vec<u16> = members.iter().map(cell).collect();
        let mut counts = vec![0_u32; CELLS];
        let kept = cells.iter().filter(|&&cell| cell != NOWHERE);
        kept.for_each(|&cell| counts[cell as usize] += 1);
        (cells, counts)
    };
    let mut blocks: Vec<_> = members.par_chunks(block).map(count).collect();
    // Counts become the start of each block in each cell.
    let mut sum = 0;
    let mut starts = Vec::with_capacity(CELLS + 1);
    for cell in 0..CELLS {
        starts.push(sum as usize);
        for (_, counts) in &mut blocks {
            sum += std::mem::replace(&mut counts[cell], sum);
        }
    }
    starts.push(sum as usize);
    let places: Vec<AtomicU32> = (0..sum).map(|_| AtomicU32::new(0)).collect();
    // Every place is written once: the atomics are only for the compiler, which cannot know this.
    members.par_chunks(block).zip(&mut blocks).for_each(|(members, (cells, next))| {
        for (&entry, &cell) in members.iter().zip(&*cells).filter(|&(_, &cell)| cell != NOWHERE) {
            let place = &mut next[cell as usize];
            places[*place as usize].store(entry, Ordering::Relaxed);
            *place += 1;
        }
    });
    drop(blocks);
    let mut entries: Vec<u32> = places.into_iter().map(AtomicU32::into_inner).collect();
    let mut runs = Vec::new();
    cut(&starts, 0..CELLS, most, &mut runs);
    let mut lengths: Vec<usize> = Vec::new();
    for run in runs {
        let own = &mut entries[run];
        if own.len() <= most {
            // Short runs share a chunk.
            match lengths.last_mut() {
                Some(last) if *last + own.len() <= most => *last += own.len(),
                _ => lengths.push(own.len()),
            }
            continue;
        }
        let bounds = around(own.par_iter().map(|&entry| point(middle(geometry, entry))));
        if bounds.low == bounds.high {
            lengths.extend(own.chunks(most).map(<[u32]>::len));
            continue;
        }
        // The ends of the longest axis are in different cells, so this comes to an end.
        let finer = arrange(geometry, own, &bounds, most);
        own.copy_from_slice(&finer.entries);
        lengths.extend(finer.lengths);
    }
    Chunks { entries, lengths }
}

/// Halves the range of cells until each part has at most `most` or is one cell.
fn cut(starts: &[usize], cells: Range<usize>, most: usize, runs: &mut Vec<Range<usize>>) {
    let run = starts[cells.start]..starts[cells.end];
    if run.len() <= most || cells.len() == 1 {
        runs.extend((!run.is_empty()).then_some(run));
        return;
    }
    let middle = cells.start.midpoint(cells.end);
    cut(starts, cells.start..middle, most, runs);
    cut(starts, middle..cells.end, most, runs);
}

/// A box around all.
fn around(boxes: impl ParallelIterator<Item = Aabb>) -> Aabb {
    boxes.fold(|| Aabb::EMPTY, Aabb::union).reduce(|| Aabb::EMPTY, Aabb::union)
}

fn point(low: Vec3) -> Aabb {
    Aabb { low, high: low }
}

/// The centre of the entry's box.
#[inline(always)]
fn middle(geometry: &Geometry, entry: u32) -> Vec3 {
    let bounds = geometry.box_of(entry);
    (bounds.low + bounds.high) * 0.5
}
