//! A first pass over every primitive, in the scene's order, while its neighbours are in cache:
//! finds degenerate triangles, and the cell of a coarse grid of each primitive.

use glam::Vec3;
use rayon::prelude::*;

use crate::accel::geometry::{Geometry, Primitive};
use crate::kernels::slab::Aabb;
use crate::kernels::triangle::is_degenerate;

/// Bits of the grid for each axis: counters of its cells then stay in the second-level cache.
const BITS: u32 = 5;

/// Cells of the grid.
pub(super) const CELLS: usize = 1 << (3 * BITS);

/// The cell of triangles without area.
const NOWHERE: u16 = u16::MAX;

/// Number of blocks of primitives for each thread, and the smallest block that is worth its own
/// counters.
const BLOCKS_A_THREAD: usize = 4;
const MOST_BLOCKS: usize = 64;
const LEAST_BLOCK: usize = 1 << 14;

/// Properties of the primitives, found before the tree is built.
#[derive(Debug)]
pub struct Survey {
    /// A box around everything.
    pub(super) extents: Aabb,
    /// The cell of each primitive.
    pub(super) cells: Vec<u16>,
    /// Number of primitives that can be hit: all except triangles without area.
    pub(super) kept: usize,
}

impl Survey {
    /// Surveys the primitives that `geometry` holds itself.
    pub fn of(geometry: &Geometry) -> Self {
        let extents = extents(geometry);
        let grid = Grid::new(&extents);
        let mut cells = vec![0; geometry.own()];
        let block = block(cells.len());
        let degenerate: usize = cells
            .par_chunks_mut(block)
            .enumerate()
            .map(|(b, cells)| {
                let mut degenerate = 0;
                for (number, cell) in (b * block..).zip(cells) {
                    *cell = match geometry.triangles.get(number) {
                        Some(_) if is_degenerate(&geometry.triangle(number)) => {
                            degenerate += 1;
                            NOWHERE
                        }
                        _ => grid.cell(geometry, number as u32),
                    };
                }
                degenerate
            })
            .sum();
        Self { extents, kept: cells.len() - degenerate, cells }
    }
}

/// The block size for a number of primitives: a few blocks for each thread, so that threads finish
/// together. It affects only time.
pub(super) fn block(count: usize) -> usize {
    let blocks = (BLOCKS_A_THREAD * rayon::current_num_threads()).min(MOST_BLOCKS);
    count.div_ceil(blocks).max(LEAST_BLOCK)
}

/// Whether a primitive with this cell can be hit.
#[inline(always)]
pub(super) fn is_kept(cell: u16) -> bool {
    cell != NOWHERE
}

/// A box around everything.
fn extents(geometry: &Geometry) -> Aabb {
    let point = |&low: &Vec3| Aabb { low, high: low };
    let sphere =
        |&(center, radius): &(Vec3, f32)| Aabb { low: center - radius, high: center + radius };
    let positions = around(geometry.positions.par_iter().map(point));
    positions.union(around(geometry.spheres.par_iter().map(sphere)))
}

/// A box around all.
pub(super) fn around(boxes: impl ParallelIterator<Item = Aabb>) -> Aabb {
    boxes.fold(|| Aabb::EMPTY, Aabb::union).reduce(|| Aabb::EMPTY, Aabb::union)
}

/// A grid of cubes.
pub(super) struct Grid {
    low: Vec3,
    scale: f32,
}

impl Grid {
    pub(super) fn new(bounds: &Aabb) -> Self {
        let size = (bounds.high - bounds.low).max_element();
        Self { low: bounds.low, scale: (1 << BITS) as f32 / size }
    }

    /// The cell that contains the centre of the primitive, as a position on Morton's curve. Centres
    /// outside count as at the border, and a grid of size zero has one cell.
    #[inline(always)]
    pub(super) fn cell(&self, geometry: &Geometry, number: u32) -> u16 {
        let axis = |x: f32| spread((x as u16).min((1 << BITS) - 1));
        let p = (middle(geometry, number) - self.low) * self.scale;
        axis(p.x) | axis(p.y) << 1 | axis(p.z) << 2
    }
}

/// Five bits, each followed by two zeros.
fn spread(x: u16) -> u16 {
    x & 1 | (x & 2) << 2 | (x & 4) << 4 | (x & 8) << 6 | (x & 16) << 8
}

/// The centre of the primitive's box.
#[inline(always)]
pub(super) fn middle(geometry: &Geometry, number: u32) -> Vec3 {
    let bounds = match geometry.primitive(number) {
        Primitive::Triangle(i) => Aabb::around(geometry.triangle(i)),
        Primitive::Quad(i) => Aabb::around(geometry.quad(i)),
        Primitive::Sphere(i) => return geometry.spheres[i].0,
        // Instances have their own tree.
        Primitive::Instanced(_) => return Vec3::ZERO,
    };
    (bounds.low + bounds.high) * 0.5
}
