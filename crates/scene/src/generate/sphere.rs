//! A displaced sphere.
//!
//! The grid is the surface of a cube of `n` x `n` x `n` cells, projected to a sphere. Plain
//! projection makes the cells at the corners of the cube five times smaller than those in the
//! middle of a face, so the grid lines are first moved to equal angles (Ronchi, Iacono and
//! Paolucci, "The Cubed Sphere", 1996), which leaves triangles that differ by less than a factor of
//! two in area. There is no pole and no fan. Vertices are numbered layer by layer up the cube, so
//! that the faces share those on edges and corners.

use glam::DVec3;

use super::noise::Fractal;
use super::surface::{Surface, cell_triangle};

/// Frequency of the coarsest noise in waves per unit of length; the radius is 1.
const FREQUENCY: f64 = 2.0;

/// The six faces of the unit cube: an origin and two edges, whose cross product points outward.
const FACES: [[[u64; 3]; 3]; 6] = [
    [[0, 0, 0], [0, 1, 0], [1, 0, 0]],
    [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
    [[0, 0, 0], [1, 0, 0], [0, 0, 1]],
    [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
    [[0, 0, 0], [0, 0, 1], [0, 1, 0]],
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
];

/// The sphere as a grid of `n` steps along each edge of the cube.
pub(super) struct SphereGrid {
    n: u64,
    /// The positions of the grid lines on [-1, 1], at equal angles: `n` + 1 numbers.
    lines: Vec<f64>,
    displacement: f64,
    fractal: Fractal,
}

impl SphereGrid {
    pub(super) fn new(n: u64, displacement: f64, seed: u64) -> Self {
        let edge = std::f64::consts::FRAC_PI_2 / n as f64;
        let lines = (0..=n).map(|i| line(i, n)).collect();
        Self { n, lines, displacement, fractal: Fractal::new(seed, FREQUENCY, edge) }
    }

    /// The vertices of the bottom layer, and of the top: a full square each.
    fn cap(&self) -> u64 {
        (self.n + 1) * (self.n + 1)
    }

    /// The number of the vertex at a point of the cube's surface, in cells.
    fn index(&self, [x, y, z]: [u64; 3]) -> u64 {
        let n = self.n;
        if z == 0 {
            return y * (n + 1) + x;
        }
        let layer = self.cap() + (z - 1) * 4 * n;
        if z == n {
            return layer + y * (n + 1) + x;
        }
        // Once around the square, counter-clockwise from its lowest corner.
        layer
            + match (x, y) {
                (x, 0) if x < n => x,
                (x, y) if x == n && y < n => n + y,
                (x, y) if y == n && x > 0 => 3 * n - x,
                (_, y) => 4 * n - y,
            }
    }

    /// The point of the cube's surface at vertex `v`, in cells.
    fn lattice(&self, v: u64) -> [u64; 3] {
        let (n, cap) = (self.n, self.cap());
        if v < cap {
            return [v % (n + 1), v / (n + 1), 0];
        }
        let ring = v - cap;
        if ring >= 4 * n * (n - 1) {
            let top = ring - 4 * n * (n - 1);
            return [top % (n + 1), top / (n + 1), n];
        }
        let (z, along) = (1 + ring / (4 * n), ring % n);
        match ring % (4 * n) / n {
            0 => [along, 0, z],
            1 => [n, along, z],
            2 => [n - along, n, z],
            _ => [0, n - along, z],
        }
    }

    fn direction(&self, v: u64) -> DVec3 {
        let [x, y, z] = self.lattice(v).map(|i| self.lines[i as usize]);
        DVec3::new(x, y, z).normalize()
    }

    /// The displaced surface in the unit direction `d`.
    fn point(&self, d: DVec3) -> DVec3 {
        d * (1.0 + self.displacement * self.fractal.sum(d))
    }
}

/// Grid line `i` of `n` on [-1, 1]: the tangents of equal angles, symmetric to the last bit.
fn line(i: u64, n: u64) -> f64 {
    let tangent = |k: u64| libm::tan(std::f64::consts::FRAC_PI_4 * (k as f64 / n as f64));
    match (2 * i).cmp(&n) {
        // The tangent of a rounded quarter of pi is not quite 1.
        _ if i == 0 => -1.0,
        _ if i == n => 1.0,
        std::cmp::Ordering::Less => -tangent(n - 2 * i),
        _ => tangent(2 * i - n),
    }
}

impl Surface for SphereGrid {
    fn vertices(&self) -> u64 {
        6 * self.n * self.n + 2
    }

    fn position(&self, v: u64) -> DVec3 {
        self.point(self.direction(v))
    }

    fn normal(&self, v: u64) -> DVec3 {
        let d = self.direction(v);
        let step = std::f64::consts::FRAC_PI_2 / self.n as f64;
        let s = d.any_orthogonal_vector().normalize() * step;
        let t = d.cross(s);
        let difference =
            |e: DVec3| self.point((d + e).normalize()) - self.point((d - e).normalize());
        difference(s).cross(difference(t)).normalize()
    }

    fn triangle(&self, t: u64) -> [u32; 3] {
        let (n, cell) = (self.n, t / 2);
        let [origin, across, up] = FACES[(cell / (n * n)) as usize];
        let (i, j) = (cell % n, cell / n % n);
        let corner = |i: u64, j: u64| {
            let along = |axis: usize| origin[axis] * n + across[axis] * i + up[axis] * j;
            self.index([along(0), along(1), along(2)]) as u32
        };
        let corners = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        // Towards a corner of the cube the cells' angles grow to 120 degrees; the shorter diagonal
        // is the one that runs to that corner.
        let leans_forward = (2 * i + 1 < n) == (2 * j + 1 < n);
        cell_triangle(corners, leans_forward, t % 2)
    }
}
