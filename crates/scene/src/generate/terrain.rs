//! A height field of mountains.
//!
//! A square grid over [-1, 1] x [-1, 1] in x and z, with the height along y. The heights are
//! Musgrave's ridged fractal: sharp crests with fine detail, and smooth valleys. It is open: a
//! sheet with a border, seen from above.

use glam::DVec3;

use super::noise::Fractal;
use super::surface::{Surface, cell_triangle};

/// Frequency of the coarsest noise in waves per unit of length: a bit more than three over the
/// whole field.
const FREQUENCY: f64 = 1.6;

/// The terrain as a grid of `n` x `n` cells.
pub(super) struct Terrain {
    n: u64,
    height: f64,
    fractal: Fractal,
}

impl Terrain {
    /// A grid whose highest crests come near `height`.
    pub(super) fn new(n: u64, height: f64, seed: u64) -> Self {
        Self { n, height, fractal: Fractal::new(seed, FREQUENCY, 2.0 / n as f64) }
    }

    fn height(&self, x: f64, z: f64) -> f64 {
        self.height * self.fractal.ridged(DVec3::new(x, 0.0, z))
    }

    /// The x and z of vertex `v`. The ends are exactly -1 and 1.
    fn ground_point(&self, v: u64) -> (f64, f64) {
        let along = |i: u64| (2 * i) as f64 / self.n as f64 - 1.0;
        (along(v % (self.n + 1)), along(v / (self.n + 1)))
    }
}

impl Surface for Terrain {
    fn vertices(&self) -> u64 {
        (self.n + 1) * (self.n + 1)
    }

    fn position(&self, v: u64) -> DVec3 {
        let (x, z) = self.ground_point(v);
        DVec3::new(x, self.height(x, z), z)
    }

    fn normal(&self, v: u64) -> DVec3 {
        let (x, z) = self.ground_point(v);
        let step = 2.0 / self.n as f64;
        let along_x = self.height(x + step, z) - self.height(x - step, z);
        let along_z = self.height(x, z + step) - self.height(x, z - step);
        DVec3::new(-along_x, 2.0 * step, -along_z).normalize()
    }

    fn triangle(&self, t: u64) -> [u32; 3] {
        let (row, column) = (t / 2 / self.n, t / 2 % self.n);
        let corner = |row: u64, column: u64| (row * (self.n + 1) + column) as u32;
        let corners = [
            corner(row, column),
            corner(row + 1, column),
            corner(row + 1, column + 1),
            corner(row, column + 1),
        ];
        // Diagonals alternate, so that the grid has no grain.
        cell_triangle(corners, (row + column) % 2 == 0, t % 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_within_the_one_asked() {
        let terrain = Terrain::new(200, 0.5, 4);
        let heights = || (0..terrain.vertices()).map(|v| terrain.position(v).y);
        assert!(heights().all(|y| (0.0..=0.5).contains(&y)));
        assert!(heights().fold(0.0, f64::max) > 0.3);
        assert!(heights().fold(1.0, f64::min) < 0.1);
    }
}
