//! A spatial order of the primitives, cut into chunks.
//!
//! Primitives are counted and sorted by the cell of a coarse grid that contains their centre
//! ([`super::survey`]); cells follow Morton's curve. A cell with too many primitives is ordered by
//! a finer grid of its own, so that the scene may be very uneven.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::survey::{CELLS, Grid, Survey, around, block, is_kept, middle};
use crate::accel::geometry::Geometry;
use crate::kernels::slab::Aabb;

/// How often cells are refined before their members are taken in the given order.
const MOST_LEVELS: usize = 12;

/// Primitives in order.
#[derive(Debug, Default)]
pub(super) struct Chunks {
    pub(super) numbers: Vec<u32>,
    /// Number of primitives in each chunk; their sum is the number of all, and no chunk is empty.
    pub(super) lengths: Vec<usize>,
}

/// Orders the `count` primitives that can be hit, and cuts them into chunks of at most `most`.
pub(super) fn chunks(geometry: &Geometry, survey: &Survey, count: usize, most: usize) -> Chunks {
    if count > most {
        return arrange(geometry, &Members::All, &survey.cells, most, 0);
    }
    let numbers = survey.cells.iter().zip(0..).filter(|&(&cell, _)| is_kept(cell));
    let lengths = if count == 0 { Vec::new() } else { vec![count] };
    Chunks { numbers: numbers.map(|(_, number)| number).collect(), lengths }
}

/// The primitives to order.
enum Members<'a> {
    /// Every primitive that can be hit.
    All,
    /// These.
    These(&'a [u32]),
}

impl Members<'_> {
    fn number(&self, index: usize) -> u32 {
        match self {
            Self::All => index as u32,
            Self::These(numbers) => numbers[index],
        }
    }
}

/// Sorts by cell and cuts.
fn arrange(
    geometry: &Geometry,
    members: &Members,
    cells: &[u16],
    most: usize,
    level: usize,
) -> Chunks {
    let block = block(cells.len());
    let count = |cells: &[u16]| {
        let mut counts = vec![0; CELLS];
        cells.iter().filter(|&&cell| is_kept(cell)).for_each(|&cell| counts[cell as usize] += 1);
        counts
    };
    let mut counts: Vec<Vec<u32>> = cells.par_chunks(block).map(count).collect();
    let starts = to_starts(&mut counts);
    let places: Vec<AtomicU32> = (0..starts[CELLS]).map(|_| AtomicU32::new(0)).collect();
    // Every place is written once: the atomics are only for the compiler, which cannot know
    // this.
    cells.par_chunks(block).zip(&mut counts).enumerate().for_each(|(b, (cells, next))| {
        for (i, &cell) in cells.iter().enumerate().filter(|&(_, &cell)| is_kept(cell)) {
            let place = &mut next[cell as usize];
            places[*place as usize].store(members.number(b * block + i), Ordering::Relaxed);
            *place += 1;
        }
    });
    drop(counts);
    let numbers = places.into_iter().map(AtomicU32::into_inner).collect();
    refine(geometry, numbers, &starts, most, level)
}

/// Turns each block's counts into its start in each cell. Returns the starts of the cells and the
/// end of all.
fn to_starts(counts: &mut [Vec<u32>]) -> Vec<u32> {
    let mut sum = 0;
    let mut starts = Vec::with_capacity(CELLS + 1);
    for cell in 0..CELLS {
        starts.push(sum);
        for block in &mut *counts {
            sum += std::mem::replace(&mut block[cell], sum);
        }
    }
    starts.push(sum);
    starts
}

/// Cuts sorted numbers into chunks, and orders cells with too many primitives.
fn refine(
    geometry: &Geometry,
    mut numbers: Vec<u32>,
    starts: &[u32],
    most: usize,
    level: usize,
) -> Chunks {
    let mut runs = Vec::new();
    cut(starts, 0..CELLS, most, &mut runs);
    let mut lengths: Vec<usize> = Vec::new();
    for run in runs {
        if run.len() <= most {
            // Short runs share a chunk.
            match lengths.last_mut() {
                Some(last) if *last + run.len() <= most => *last += run.len(),
                _ => lengths.push(run.len()),
            }
            continue;
        }
        let full = &mut numbers[run];
        let bounds = around(full.par_iter().map(|&number| {
            let low = middle(geometry, number);
            Aabb { low, high: low }
        }));
        if level < MOST_LEVELS && bounds.low != bounds.high {
            let grid = Grid::new(&bounds);
            let cells: Vec<u16> =
                full.par_iter().map(|&number| grid.cell(geometry, number)).collect();
            let finer = arrange(geometry, &Members::These(full), &cells, most, level + 1);
            full.copy_from_slice(&finer.numbers);
            lengths.extend(finer.lengths);
        } else {
            lengths.extend(full.chunks(most).map(<[u32]>::len));
        }
    }
    Chunks { numbers, lengths }
}

/// Halves the range of cells until each part has at most `most` or is one cell.
fn cut(starts: &[u32], cells: Range<usize>, most: usize, runs: &mut Vec<Range<usize>>) {
    let run = starts[cells.start] as usize..starts[cells.end] as usize;
    if run.is_empty() {
        return;
    }
    if run.len() <= most || cells.len() == 1 {
        runs.push(run);
        return;
    }
    let middle = cells.start.midpoint(cells.end);
    cut(starts, cells.start..middle, most, runs);
    cut(starts, middle..cells.end, most, runs);
}
