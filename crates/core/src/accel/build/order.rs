//! An order of the primitives in which neighbours are near each other, cut into chunks.
//!
//! Primitives are counted and sorted by the cell of a coarse grid that one of their points is in;
//! cells follow each other along Morton's curve. A cell of too many is ordered by a finer grid of
//! its own, so that a scene may be as uneven as it likes.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use crate::accel::geometry::{Geometry, Primitive};
use crate::kernels::slab::Aabb;

/// Bits of an axis of the grid: its counters then stay in the second-level cache.
const BITS: u32 = 5;

/// Cells of the grid.
const CELLS: usize = 1 << (3 * BITS);

/// Parts that are counted at a time, and the least that is worth its own counters.
const BLOCKS_A_THREAD: usize = 4;
const MOST_BLOCKS: usize = 64;
const LEAST_BLOCK: usize = 1 << 14;

/// How often cells are cut into finer ones before their members are taken as they come.
const MOST_LEVELS: usize = 12;

/// Primitives, in order.
#[derive(Debug, Default)]
pub(super) struct Chunks {
    pub(super) numbers: Vec<u32>,
    /// How many of them are in each chunk; together all, and no chunk is empty.
    pub(super) lengths: Vec<usize>,
}

/// Orders the primitives, those apart that are `left_out`, and cuts them into chunks of at most `most`.
pub(super) fn chunks(geometry: &Geometry, left_out: &[u32], most: usize) -> Chunks {
    let count = geometry.own();
    if count > most && left_out.is_empty() {
        return arrange(geometry, &Members::All(count), &extents(geometry), most, 0);
    }
    let mut left_out = left_out.iter().copied().peekable();
    let is_kept = |number: &u32| left_out.next_if_eq(number).is_none();
    let numbers: Vec<u32> = (0..count as u32).filter(is_kept).collect();
    if numbers.len() > most {
        return arrange(geometry, &Members::These(&numbers), &extents(geometry), most, 0);
    }
    let lengths = if numbers.is_empty() { Vec::new() } else { vec![numbers.len()] };
    Chunks { numbers, lengths }
}

/// A box around everything.
pub(super) fn extents(geometry: &Geometry) -> Aabb {
    let none = || Aabb { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };
    let join = |a: Aabb, b: Aabb| Aabb { low: a.low.min(b.low), high: a.high.max(b.high) };
    let point = |&low: &Vec3| Aabb { low, high: low };
    let sphere =
        |&(center, radius): &(Vec3, f32)| Aabb { low: center - radius, high: center + radius };
    let fold = |all: Aabb, one: Aabb| join(all, one);
    let positions = geometry.positions.par_iter().map(point).fold(none, fold).reduce(none, join);
    let spheres = geometry.spheres.par_iter().map(sphere).fold(none, fold).reduce(none, join);
    join(positions, spheres)
}

/// Who is ordered.
enum Members<'a> {
    /// Every primitive.
    All(usize),
    /// These.
    These(&'a [u32]),
}

impl Members<'_> {
    fn count(&self) -> usize {
        match self {
            Self::All(count) => *count,
            Self::These(numbers) => numbers.len(),
        }
    }

    fn number(&self, index: usize) -> u32 {
        match self {
            Self::All(_) => index as u32,
            Self::These(numbers) => numbers[index],
        }
    }
}

/// A grid of cubes.
struct Grid {
    low: Vec3,
    scale: f32,
}

impl Grid {
    fn new(bounds: &Aabb) -> Self {
        let size = (bounds.high - bounds.low).max_element();
        Self { low: bounds.low, scale: (1 << BITS) as f32 / size }
    }

    /// The cell of the point, by its place on Morton's curve. Points outside count as at the border,
    /// and in a grid of no size all are in one cell.
    fn cell(&self, point: Vec3) -> u16 {
        let axis = |x: f32| spread((x as u16).min((1 << BITS) - 1));
        let p = (point - self.low) * self.scale;
        axis(p.x) | axis(p.y) << 1 | axis(p.z) << 2
    }
}

/// Five bits, each followed by two zeros.
fn spread(x: u16) -> u16 {
    x & 1 | (x & 2) << 2 | (x & 4) << 4 | (x & 8) << 6 | (x & 16) << 8
}

/// A point of the primitive: in what order they are is not worth looking at all of them.
#[inline]
fn point(geometry: &Geometry, number: u32) -> Vec3 {
    match geometry.primitive(number) {
        Primitive::Triangle(i) => geometry.positions[geometry.triangles[i][0] as usize],
        Primitive::Quad(i) => geometry.positions[geometry.quads[i][0] as usize],
        Primitive::Sphere(i) => geometry.spheres[i].0,
        // Instances have a tree of their own.
        Primitive::Instanced(_) => Vec3::ZERO,
    }
}

/// Sorts by cell, and cuts.
fn arrange(
    geometry: &Geometry,
    members: &Members,
    bounds: &Aabb,
    most: usize,
    level: usize,
) -> Chunks {
    let count = members.count();
    let grid = Grid::new(bounds);
    // A few for each thread, for them to finish together; the order is the same with any number.
    let blocks = (BLOCKS_A_THREAD * rayon::current_num_threads()).min(MOST_BLOCKS);
    let block = count.div_ceil(blocks).max(LEAST_BLOCK);
    let mut cells = vec![0_u16; count];
    let mut counts: Vec<Vec<u32>> = cells
        .par_chunks_mut(block)
        .enumerate()
        .map(|(b, cells)| {
            let mut counts = vec![0; CELLS];
            for (i, cell) in cells.iter_mut().enumerate() {
                *cell = grid.cell(point(geometry, members.number(b * block + i)));
                counts[*cell as usize] += 1;
            }
            counts
        })
        .collect();
    let starts = to_starts(&mut counts);
    let places: Vec<AtomicU32> = (0..starts[CELLS]).map(|_| AtomicU32::new(0)).collect();
    // Every place is written once: atomics are for the compiler, which cannot know.
    cells.par_chunks(block).zip(&mut counts).enumerate().for_each(|(b, (cells, next))| {
        for (i, &cell) in cells.iter().enumerate() {
            let place = &mut next[cell as usize];
            places[*place as usize].store(members.number(b * block + i), Ordering::Relaxed);
            *place += 1;
        }
    });
    drop((cells, counts));
    let numbers = places.into_iter().map(AtomicU32::into_inner).collect();
    refine(geometry, numbers, &starts, most, level)
}

/// Makes of each block's counts where it begins in each cell. Returns where the cells begin, and the
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

/// Cuts sorted numbers into chunks, and orders cells that are too full.
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
            // Runs that are short together are one chunk.
            match lengths.last_mut() {
                Some(last) if *last + run.len() <= most => *last += run.len(),
                _ => lengths.push(run.len()),
            }
            continue;
        }
        let full = &mut numbers[run];
        let points = |&n: &u32| {
            let point = point(geometry, n);
            Aabb { low: point, high: point }
        };
        let join = |a: Aabb, b: Aabb| Aabb { low: a.low.min(b.low), high: a.high.max(b.high) };
        let none = || Aabb { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };
        let bounds = full.par_iter().map(points).reduce(none, join);
        if level < MOST_LEVELS && bounds.low != bounds.high {
            let finer = arrange(geometry, &Members::These(full), &bounds, most, level + 1);
            full.copy_from_slice(&finer.numbers);
            lengths.extend(finer.lengths);
        } else {
            lengths.extend(full.chunks(most).map(<[u32]>::len));
        }
    }
    Chunks { numbers, lengths }
}

/// Halves the range of cells until no part has more than `most`, or is one cell.
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
