//! A grid of cells over a curved surface.

use glam::DVec3;

use super::surface::{Surface, cell_triangle};

/// A point for each pair of numbers from 0 to 1.
pub(super) type PointAt = Box<dyn Fn(f64, f64) -> DVec3 + Send + Sync>;

/// How a grid ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Ends {
    /// A sheet with a border.
    Open,
    /// A body: closed in the first number, with a fan at each end of the second.
    Fans,
    /// A ring: closed in both numbers.
    Joined,
}

/// Points of a surface at equal steps of two numbers.
pub(super) struct Grid {
    /// Cells along the first number and along the second.
    pub(super) cells: [u64; 2],
    pub(super) ends: Ends,
    /// Its points. The front is where the cross product of the two derivatives points.
    pub(super) shape: PointAt,
}

impl Grid {
    fn columns(&self) -> u64 {
        self.cells[0] + u64::from(self.ends == Ends::Open)
    }

    fn rows(&self) -> u64 {
        self.cells[1] + u64::from(self.ends != Ends::Joined)
    }

    /// The number of vertices without the poles.
    fn ordinary(&self) -> u64 {
        self.columns() * self.rows()
    }

    fn point(&self, i: f64, j: f64) -> DVec3 {
        (self.shape)(i / self.cells[0] as f64, j / self.cells[1] as f64)
    }

    /// The column and the row of vertex `v`.
    fn place(&self, v: u64) -> (f64, f64) {
        ((v % self.columns()) as f64, (v / self.columns()) as f64)
    }

    /// The centre of the ring at `j`, and two points of it a quarter apart.
    fn end(&self, j: f64) -> [DVec3; 3] {
        let quarter = |q: f64| self.point(q * self.cells[0] as f64, j);
        [(quarter(0.0) + quarter(0.5)) / 2.0, quarter(0.0), quarter(0.25)]
    }

    /// The end whose pole the vertex `v` is, if it is one.
    fn pole(&self, v: u64) -> Option<f64> {
        let number = v.checked_sub(self.ordinary())?;
        Some(if number == 0 { 0.0 } else { self.cells[1] as f64 })
    }

    /// A triangle of the fans: those of the first end, then those of the last.
    fn fan(&self, t: u64) -> [u64; 3] {
        let [across, along] = self.cells;
        let (i, next, last) = (t % across, (t + 1) % across, along * across);
        if t < across {
            [self.ordinary(), next, i]
        } else {
            [self.ordinary() + 1, last + i, last + next]
        }
    }
}

impl Surface for Grid {
    fn vertices(&self) -> u64 {
        self.ordinary() + if self.ends == Ends::Fans { 2 } else { 0 }
    }

    fn triangles(&self) -> u64 {
        2 * self.cells[0] * (self.cells[1] + u64::from(self.ends == Ends::Fans))
    }

    fn position(&self, v: u64) -> DVec3 {
        let (i, j) = self.place(v);
        self.pole(v).map_or_else(|| self.point(i, j), |j| self.end(j)[0])
    }

    fn normal(&self, v: u64) -> DVec3 {
        if let Some(j) = self.pole(v) {
            let [middle, a, b] = self.end(j);
            let outward = (a - middle).cross(b - middle).normalize();
            return if j == 0.0 { -outward } else { outward };
        }
        // Beyond a border there is nothing to measure.
        let within = |x: f64, end: u64, is_open: bool| {
            if is_open { x.clamp(0.0, end as f64) } else { x }
        };
        let [across, along] = self.cells;
        let (i, j) = self.place(v);
        let at_i = |i| self.point(within(i, across, self.ends == Ends::Open), j);
        let at_j = |j| self.point(i, within(j, along, self.ends != Ends::Joined));
        let (first, second) = (at_i(i + 1.0) - at_i(i - 1.0), at_j(j + 1.0) - at_j(j - 1.0));
        first.cross(second).normalize()
    }

    fn triangle(&self, t: u64) -> [u32; 3] {
        let (cell, cells) = (t / 2, self.cells[0] * self.cells[1]);
        if cell >= cells {
            return self.fan(t - 2 * cells).map(|v| v as u32);
        }
        let (i, j) = (cell % self.cells[0], cell / self.cells[0]);
        let (next_i, next_j) = ((i + 1) % self.columns(), (j + 1) % self.rows());
        let corner = |i: u64, j: u64| (j * self.columns() + i) as u32;
        let corners = [corner(i, j), corner(next_i, j), corner(next_i, next_j), corner(i, next_j)];
        // Diagonals alternate, so that the grid has no grain; around a ring they run with it.
        cell_triangle(corners, self.ends == Ends::Joined || (i + j) % 2 == 0, t % 2)
    }
}
