//! A spatial order of what leaves hold, cut into chunks.
//!
//! A pass over every entry, in the scene's order, finds triangles without area, and the cell of a
//! coarse grid that contains the centre of each other entry. Cells follow Morton's curve. A cell with
//! too many entries is ordered by a finer grid of its own, so that the scene may be very uneven. Entries larger than a
//! cell are put apart: their boxes would make those of chunks as large.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use obvhs::ploc::morton::morton_encode_u32;

use crate::geometry::{Geometry, Surfaces};
use crate::kernels::Aabb;
use crate::kernels::triangle::is_degenerate;
use wavecrest_base::parallel;

/// Bits of a grid for each axis, at most: counters of its cells then stay in the second-level
/// cache.
const MOST_BITS: u32 = 5;

/// The cell of triangles without area.
const NOWHERE: u16 = u16::MAX;

/// Number of blocks of entries for each thread, so that threads finish together, and the smallest
/// block that is worth its own counters. They affect only time.
const BLOCKS_A_THREAD: usize = 4;
const MOST_BLOCKS: usize = 64;
const LEAST_BLOCK: usize = 1 << 16;

/// If large entries would fill more chunks than this, they are cut into chunks as others are.
const MOST_LARGE: usize = 4;

/// Entries in order, by kind of surfaces. Chunks write the numbers of their leaves in place of their own.
pub(super) struct Order {
    pub(super) entries: Vec<AtomicU32>,
    pub(super) surfaces: [Chunks; Surfaces::ALL.len()],
}

/// The entries of a kind of surfaces.
#[derive(Clone, Default)]
pub(super) struct Chunks {
    /// The entries of each chunk, and a box around them. No chunk is empty.
    pub(super) boxed: Vec<(Range<usize>, Aabb)>,
    /// Entries larger than the cells, few: in a chunk each would make a box as large as itself.
    pub(super) large: Range<usize>,
}

impl Order {
    /// The number of chunks and of groups of large entries.
    pub(super) fn groups(&self) -> usize {
        let groups = |of: &Chunks| of.boxed.len() + usize::from(!of.large.is_empty());
        self.surfaces.iter().map(groups).sum()
    }

    /// The number of large entries.
    pub(super) fn large(&self) -> usize {
        self.surfaces.iter().map(|of| of.large.len()).sum()
    }
}

/// A box around everything that `geometry` holds itself.
pub(super) fn extents(geometry: &Geometry) -> Aabb {
    let Geometry { positions, quadrics, .. } = geometry;
    around(positions.len(), |i| Aabb::around([positions[i]]))
        .union(around(quadrics.len(), |i| quadrics[i].bounds()))
}

/// Orders the entries that can be hit, all but triangles without area, by kind of surfaces, and cuts
/// them into chunks of at most `most` of a kind.
pub(super) fn order(geometry: &Geometry, extents: &Aabb, most: usize) -> Order {
    let kinds = if geometry.passed.is_empty() { 1 } else { Surfaces::ALL.len() };
    let mut all = Order { entries: Vec::new(), surfaces: Default::default() };
    for surfaces in Surfaces::ALL.into_iter().take(kinds) {
        let of_surfaces = EntryOrder { geometry, surfaces, most };
        let (entries, chunks) = of_surfaces.cut(extents);
        all.surfaces[surfaces as usize] = chunks.moved(all.entries.len());
        all.entries.extend(entries);
    }
    all
}

impl Chunks {
    /// The same behind that many entries.
    fn moved(mut self, by: usize) -> Self {
        let all = self.boxed.iter_mut().map(|(own, _)| own);
        all.chain([&mut self.large]).for_each(|own| *own = own.start + by..own.end + by);
        self
    }
}

/// How to order the entries of a scene, those of a kind of surfaces.
struct EntryOrder<'a> {
    geometry: &'a Geometry,
    surfaces: Surfaces,
    most: usize,
}

/// Some entries in the scene's order.
struct Block {
    members: Range<usize>,
    /// The cell of each.
    cells: Vec<u16>,
    /// The number of entries in each cell; later the place of the next.
    counts: Vec<u32>,
    /// A box around the entries of each cell.
    boxes: Vec<Aabb>,
}

impl EntryOrder<'_> {
    /// Those that can be hit.
    fn cut(&self, extents: &Aabb) -> (Vec<AtomicU32>, Chunks) {
        if self.geometry.entries() > self.most {
            return self.arrange(None, extents);
        }
        let entries = (0..self.geometry.entries() as u32).filter(|&entry| self.is_met(entry));
        let entries: Vec<_> = entries.map(AtomicU32::new).collect();
        let whole = (0..entries.len(), *extents);
        let chunks = if entries.is_empty() { Vec::new() } else { vec![whole] };
        (entries, Chunks { boxed: chunks, large: 0..0 })
    }

    #[inline(always)]
    fn is_met(&self, entry: u32) -> bool {
        let (geometry, index) = (self.geometry, entry as usize);
        let has_area =
            index >= geometry.triangles.len() || !is_degenerate(&geometry.triangle(index));
        let is_own = geometry.passed.is_empty()
            || geometry.surfaces_of(geometry.number_of(entry)) == self.surfaces;
        has_area && is_own
    }

    /// Sorts `members`, or all entries, by the cells of a grid in `bounds`, and cuts.
    fn arrange(&self, members: Option<&[AtomicU32]>, bounds: &Aabb) -> (Vec<AtomicU32>, Chunks) {
        let count = members.map_or(self.geometry.entries(), <[_]>::len);
        let member = |i: usize| members.map_or(i as u32, |all| all[i].load(Ordering::Relaxed));
        // Over a surface, as many cells as chunks, and a few times more.
        let bits = (count.div_ceil(self.most).ilog2() / 2 + 2).min(MOST_BITS);
        let grid = 1 << (3 * bits);
        // The last is that of the large ones.
        let all_cells = grid + 1;
        let scale = (1 << bits) as f32 / (bounds.high - bounds.low).max_element();
        // Members are a part of entries of which all are met.
        let is_known = members.is_some();
        let blocks = (BLOCKS_A_THREAD * rayon::current_num_threads()).min(MOST_BLOCKS);
        let size = count.div_ceil(blocks).max(LEAST_BLOCK);
        let block = |first: usize| {
            let members = first * size..((first + 1) * size).min(count);
            let mut counts = vec![0; all_cells];
            let mut boxes = vec![Aabb::EMPTY; all_cells];
            let cell = |i: usize| {
                let entry = member(i);
                if !is_known && !self.is_met(entry) {
                    return NOWHERE;
                }
                let own = self.geometry.box_of(entry);
                // Centres outside count as at the border. In a grid of size zero, 0 x inf is NaN,
                // and counts as 0.
                let at = (middle(&own) - bounds.low) * scale;
                let [x, y, z] = at.to_array().map(|x| (x as u16).min((1 << bits) - 1));
                let is_large = !is_known && (own.high - own.low).max_element() * scale > 1.0;
                let cell = if is_large { grid } else { morton_encode_u32(x, y, z) as usize };
                counts[cell] += 1;
                boxes[cell] = boxes[cell].union(own);
                cell as u16
            };
            let cells = members.clone().map(cell).collect();
            Block { members, cells, counts, boxes }
        };
        let mut blocks: Vec<_> = parallel::map(0..count.div_ceil(size), block);
        // Counts become the start of each block in each cell.
        let mut sum = 0;
        let mut starts = Vec::with_capacity(all_cells + 1);
        for cell in 0..all_cells {
            starts.push(sum as usize);
            for Block { counts, .. } in &mut blocks {
                sum += std::mem::replace(&mut counts[cell], sum);
            }
        }
        starts.push(sum as usize);
        // Every place is written once.
        let entries: Vec<AtomicU32> = (0..sum).map(|_| AtomicU32::new(0)).collect();
        parallel::each(blocks.iter_mut(), |Block { members, cells, counts: next, .. }| {
            let kept = members.zip(&*cells).filter(|&(_, &cell)| cell != NOWHERE);
            for (i, &cell) in kept {
                let place = &mut next[cell as usize];
                entries[*place as usize].store(member(i), Ordering::Relaxed);
                *place += 1;
            }
        });
        let mut runs = Vec::new();
        cut(&starts, 0..grid, self.most, &mut runs);
        let mut large = starts[grid]..starts[all_cells];
        if large.len() > MOST_LARGE * self.most {
            large = 0..0;
            runs.push(grid..all_cells);
        }
        let chunks_of = |cells: Range<usize>| {
            let boxes = blocks.iter().flat_map(|block| &block.boxes[cells.clone()]);
            let bounds = boxes.fold(Aabb::EMPTY, |all, &own| all.union(own));
            self.chunks_of(&entries, starts[cells.start]..starts[cells.end], bounds)
        };
        let found: Vec<_> = parallel::map(runs.into_iter(), chunks_of);
        let mut chunks: Vec<(Range<usize>, Aabb)> = Vec::new();
        for (run, bounds) in found.into_iter().flatten() {
            // Short runs share a chunk, unless the curve has jumped between them.
            let join = |(last, around): &mut (Range<usize>, Aabb)| {
                let both = around.union(bounds);
                let fits = last.len() + run.len() <= self.most
                    && both.half_area() <= around.half_area() + bounds.half_area();
                if fits {
                    (last.end, *around) = (run.end, both);
                }
                fits
            };
            if !chunks.last_mut().is_some_and(join) {
                chunks.push((run, bounds));
            }
        }
        (entries, Chunks { boxed: chunks, large })
    }

    /// The chunks of a run of `entries`, in a box.
    fn chunks_of(
        &self,
        entries: &[AtomicU32],
        run: Range<usize>,
        bounds: Aabb,
    ) -> Vec<(Range<usize>, Aabb)> {
        if run.len() <= self.most {
            return vec![(run, bounds)];
        }
        let own = &entries[run.clone()];
        let center = |i: usize| {
            Aabb::around([middle(&self.geometry.box_of(own[i].load(Ordering::Relaxed)))])
        };
        let centers = around(own.len(), center);
        if centers.low == centers.high {
            let ends = run.clone().step_by(self.most);
            return ends.map(|start| (start..(start + self.most).min(run.end), bounds)).collect();
        }
        // The ends of the longest axis are in different cells, so this comes to an end.
        let (entries, finer) = self.arrange(Some(own), &centers);
        own.iter().zip(entries).for_each(|(entry, new)| {
            entry.store(new.into_inner(), Ordering::Relaxed);
        });
        finer.moved(run.start).boxed
    }
}

/// Halves the range of cells until each part has at most `most` entries or is one cell. Returns the
/// cells of each part that is not empty.
fn cut(starts: &[usize], cells: Range<usize>, most: usize, runs: &mut Vec<Range<usize>>) {
    let count = starts[cells.end] - starts[cells.start];
    if count <= most || cells.len() == 1 {
        runs.extend((count > 0).then_some(cells));
        return;
    }
    let middle = cells.start.midpoint(cells.end);
    cut(starts, cells.start..middle, most, runs);
    cut(starts, middle..cells.end, most, runs);
}

/// A box around so many others.
fn around(count: usize, of: impl Fn(usize) -> Aabb + Sync) -> Aabb {
    parallel::reduce(count, Aabb::EMPTY, of, Aabb::union)
}

/// The centre of the box.
#[inline(always)]
fn middle(bounds: &Aabb) -> Vec3 {
    (bounds.low + bounds.high) * 0.5
}
