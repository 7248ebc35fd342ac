//! Hits of parallel rays through a file along its axes: enough to tell a room from a statue, and a
//! floor from a wall.
//!
//! The box around the file is cut into columns along each axis. The triangles that meet the ray
//! through the centre of each column are found triangle by triangle, so that no tree is needed and
//! every triangle is read once.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::Scenery;

/// Columns along each side of a face of the box.
pub(super) const COLUMNS: usize = 24;
/// Triangles in a batch.
const BATCH: usize = 1 << 16;
/// Largest total number of ray-triangle tests: about a second's work.
const MOST_TESTS: u64 = 1 << 28;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) struct MetTriangle {
    /// From 0 at the low end of the box to 1 at the high end.
    pub(super) at: f64,
    /// Whether the front faces the high end.
    pub(super) faces_high: bool,
}

/// The hits of the ray through the centre of a column.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ColumnHits {
    /// Nearest to the low end, and to the high end.
    pub(super) ends: Option<[MetTriangle; 2]>,
    /// Nearest to the centre of the box, below it and above.
    pub(super) below: Option<MetTriangle>,
    pub(super) above: Option<MetTriangle>,
}

/// The columns along x, y and z.
pub(super) struct Grid {
    columns: Vec<ColumnHits>,
}

impl Grid {
    /// The grid of the box around the `contents`. `None` without points, or if it takes too long.
    pub(super) fn of(contents: &Scenery<'_>) -> Option<Self> {
        let (low, high) = contents.ends;
        let size = high - low;
        if !size.is_finite() {
            return None;
        }
        let unit = |x: f64| if x > 0.0 { 1.0 / x } else { 0.0 };
        let scale = DVec3::new(unit(size.x), unit(size.y), unit(size.z));
        let tests = AtomicU64::new(0);
        let mut grid = Self::empty();
        for placed in &contents.all {
            let point = |&i: &u32| {
                let point = placed.world.transform_point3(placed.points[i as usize].as_dvec3());
                (point - low) * scale
            };
            let found = placed.triangles.par_chunks(BATCH).map(|triangles| {
                let mut part = Self::empty();
                if tests.load(Ordering::Relaxed) <= MOST_TESTS {
                    let add = |triangle: &[u32; 3]| part.add(&triangle.each_ref().map(point));
                    let count = triangles.iter().map(add).sum();
                    tests.fetch_add(count, Ordering::Relaxed);
                }
                part
            });
            if let Some(part) = found.reduce_with(Self::merged) {
                grid = grid.merged(part);
            }
        }
        (tests.into_inner() <= MOST_TESTS).then_some(grid)
    }

    fn empty() -> Self {
        Self { columns: vec![ColumnHits::default(); 3 * COLUMNS * COLUMNS] }
    }

    /// The columns along an axis, in rows of the next axis but one.
    pub(super) fn along(&self, axis: usize) -> &[ColumnHits] {
        let count = COLUMNS * COLUMNS;
        &self.columns[axis * count..(axis + 1) * count]
    }

    /// Adds a triangle of the unit cube; returns the number of rays tested.
    fn add(&mut self, corners: &[DVec3; 3]) -> u64 {
        let cells = corners.map(|p| p * COLUMNS as f64 - 0.5);
        // None for most triangles of a large mesh: they are between the rays.
        let rays = [0, 1, 2].map(|axis| rays_within(cells.map(|p| p[axis])));
        let mut tests = 0;
        for axis in 0..3 {
            let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
            if let (Some(columns), Some(rows)) = (&rays[next], &rays[last]) {
                let uv = [next, last].map(|i| cells.map(|p| p[i]));
                tests += self.add_along(axis, corners, uv, [columns.clone(), rows.clone()]);
            }
        }
        tests
    }

    fn add_along(
        &mut self,
        axis: usize,
        corners: &[DVec3; 3],
        [u, v]: [[f64; 3]; 2],
        [columns, rows]: [Range<usize>; 2],
    ) -> u64 {
        let edge = |i: usize, j: usize, x: f64, y: f64| {
            (u[j] - u[i]) * (y - v[i]) - (v[j] - v[i]) * (x - u[i])
        };
        let area = edge(0, 1, u[2], v[2]);
        if area == 0.0 || !area.is_finite() {
            return 0;
        }
        for row in rows.clone() {
            for column in columns.clone() {
                let (x, y) = (column as f64, row as f64);
                let weights = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| edge(i, j, x, y) / area);
                if weights.iter().all(|&weight| weight >= 0.0) {
                    let at = (0..3).map(|i| weights[i] * corners[i][axis]).sum();
                    let met = MetTriangle { at, faces_high: area > 0.0 };
                    self.columns[(axis * COLUMNS + row) * COLUMNS + column].meet(met);
                }
            }
        }
        (rows.len() * columns.len()) as u64
    }

    fn merged(mut self, other: Self) -> Self {
        for (own, other) in self.columns.iter_mut().zip(other.columns) {
            let ends = other.ends.into_iter().flatten();
            ends.chain(other.below).chain(other.above).for_each(|met| own.meet(met));
        }
        self
    }
}

/// The rays at whole numbers between the least and the greatest of `x`. By conversions: rounding
/// takes a call where the processor is not known to have an instruction.
fn rays_within(x: [f64; 3]) -> Option<Range<usize>> {
    let (least, greatest) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
    let low = least.max(0.0) as usize;
    let low = low + usize::from((low as f64) < least);
    let high = (greatest >= 0.0).then(|| (greatest as usize).min(COLUMNS - 1) + 1)?;
    (low < high).then_some(low..high)
}

impl ColumnHits {
    /// Records a hit of the ray. The order does not matter.
    fn meet(&mut self, met: MetTriangle) {
        let sorted = |a: MetTriangle, b: MetTriangle| if a <= b { [a, b] } else { [b, a] };
        let ends = self.ends.map(|[low, high]| [sorted(low, met)[0], sorted(high, met)[1]]);
        self.ends = Some(ends.unwrap_or([met; 2]));
        if met.at <= 0.5 {
            self.below = Some(self.below.map_or(met, |below| sorted(below, met)[1]));
        } else {
            self.above = Some(self.above.map_or(met, |above| sorted(above, met)[0]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{boxes, contents};
    use super::*;

    #[test]
    fn rays_meet_both_ends_of_a_box() {
        let mut mesh = boxes(&[([0.0; 3], [1.0; 3])]);
        // The lower and the upper side along z.
        mesh.1.drain(..8);
        let grid = Grid::of(&contents(&mesh)).unwrap();
        let is = |met: MetTriangle, at: f64, faces_high| {
            (met.at - at).abs() < 1e-12 && met.faces_high == faces_high
        };
        for column in grid.along(2) {
            let [low, high] = column.ends.unwrap();
            assert!(is(low, 0.0, false) && is(high, 1.0, true), "{low:?} {high:?}");
            assert_eq!((column.below, column.above), (Some(low), Some(high)));
        }
        assert!(grid.along(0).iter().chain(grid.along(1)).all(|column| column.ends.is_none()));
    }
}
