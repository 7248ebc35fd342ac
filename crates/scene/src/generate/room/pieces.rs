//! The pieces of a room: flat facets, curved grids, and soups of leaves.
//!
//! Each is a [`Surface`] with its own vertices, numbered from 0.

use glam::DVec3;

use super::random::Random;
use crate::generate::surface::{Surface, cell_triangle};

/// A point for each pair of numbers from 0 to 1.
pub(super) type Shape = Box<dyn Fn(f64, f64) -> DVec3 + Send + Sync>;

/// A grid of cells over a curved surface.
pub(super) struct Grid {
    /// Cells along the first number.
    pub(super) across: u64,
    /// Cells along the second number.
    pub(super) along: u64,
    /// Whether the grid closes in the first number, with fans at its two ends: a body. Otherwise it
    /// is a sheet with a border.
    pub(super) is_round: bool,
    /// Its points. The front is where the cross product of the two derivatives points.
    pub(super) shape: Shape,
}

impl Grid {
    fn columns(&self) -> u64 {
        if self.is_round { self.across } else { self.across + 1 }
    }

    fn rings(&self) -> u64 {
        self.columns() * (self.along + 1)
    }

    fn point(&self, i: f64, j: f64) -> DVec3 {
        (self.shape)(i / self.across as f64, j / self.along as f64)
    }

    /// The centre of the ring at `j`, and two points of it a quarter apart.
    fn end(&self, j: f64) -> [DVec3; 3] {
        let quarter = |q: f64| self.point(q * self.across as f64, j);
        [(quarter(0.0) + quarter(0.5)) / 2.0, quarter(0.0), quarter(0.25)]
    }

    /// The end whose pole the vertex `v` is, if it is one.
    fn pole(&self, v: u64) -> Option<f64> {
        (v >= self.rings()).then(|| if v == self.rings() { 0.0 } else { self.along as f64 })
    }

    /// A triangle of the fans: those of the first end, then those of the last.
    fn fan(&self, t: u64) -> [u64; 3] {
        let (i, next) = (t % self.across, (t + 1) % self.across);
        let last = self.along * self.across;
        if t < self.across {
            [self.rings(), next, i]
        } else {
            [self.rings() + 1, last + i, last + next]
        }
    }
}

impl Surface for Grid {
    fn vertices(&self) -> u64 {
        self.rings() + if self.is_round { 2 } else { 0 }
    }

    fn triangles(&self) -> u64 {
        2 * self.across * (self.along + u64::from(self.is_round))
    }

    fn position(&self, v: u64) -> DVec3 {
        match self.pole(v) {
            Some(j) => self.end(j)[0],
            None => self.point((v % self.columns()) as f64, (v / self.columns()) as f64),
        }
    }

    fn normal(&self, v: u64) -> DVec3 {
        if let Some(j) = self.pole(v) {
            let [middle, a, b] = self.end(j);
            let outward = (a - middle).cross(b - middle).normalize();
            return if j == 0.0 { -outward } else { outward };
        }
        let (i, j) = ((v % self.columns()) as f64, (v / self.columns()) as f64);
        let (across, along) = (self.across as f64, self.along as f64);
        let within = |i: f64| if self.is_round { i } else { i.clamp(0.0, across) };
        let first = self.point(within(i + 1.0), j) - self.point(within(i - 1.0), j);
        let second = self.point(i, (j + 1.0).min(along)) - self.point(i, (j - 1.0).max(0.0));
        first.cross(second).normalize()
    }

    fn triangle(&self, t: u64) -> [u32; 3] {
        let (cell, cells) = (t / 2, self.across * self.along);
        if cell >= cells {
            return self.fan(t - 2 * cells).map(|v| v as u32);
        }
        let (i, j) = (cell % self.across, cell / self.across);
        let next = (i + 1) % self.columns();
        let corner = |i: u64, j: u64| (j * self.columns() + i) as u32;
        let corners = [corner(i, j), corner(next, j), corner(next, j + 1), corner(i, j + 1)];
        cell_triangle(corners, (i + j) % 2 == 0, t % 2)
    }
}

/// Flat quads and triangles, each with its own corners, so that edges look sharp.
#[derive(Default)]
pub(super) struct Facets {
    /// Convex and counter-clockwise as seen from the front, as are the triangles.
    pub(super) quads: Vec<[DVec3; 4]>,
    pub(super) triangles: Vec<[DVec3; 3]>,
}

impl Facets {
    fn corners(&self) -> u64 {
        4 * self.quads.len() as u64
    }

    /// The corners of the facet of vertex `v`.
    fn facet(&self, v: u64) -> (&[DVec3], usize) {
        match v.checked_sub(self.corners()) {
            None => (&self.quads[(v / 4) as usize], (v % 4) as usize),
            Some(v) => (&self.triangles[(v / 3) as usize], (v % 3) as usize),
        }
    }
}

impl Surface for Facets {
    fn vertices(&self) -> u64 {
        self.corners() + 3 * self.triangles.len() as u64
    }

    fn triangles(&self) -> u64 {
        (2 * self.quads.len() + self.triangles.len()) as u64
    }

    fn position(&self, v: u64) -> DVec3 {
        let (corners, which) = self.facet(v);
        corners[which]
    }

    fn normal(&self, v: u64) -> DVec3 {
        let (corners, _) = self.facet(v);
        (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize()
    }

    fn triangle(&self, t: u64) -> [u32; 3] {
        let quads = 2 * self.quads.len() as u64;
        if let Some(t) = t.checked_sub(quads) {
            let first = self.corners() + 3 * t;
            return [first, first + 1, first + 2].map(|v| v as u32);
        }
        let first = (t / 2 * 4) as u32;
        cell_triangle([first, first + 1, first + 2, first + 3], true, t % 2)
    }
}

/// A leaf of four triangles, folded along its middle.
pub(super) struct Leaf {
    /// Where it grows.
    pub(super) base: DVec3,
    /// From there to its tip.
    pub(super) along: DVec3,
    /// From its middle to its right edge.
    pub(super) across: DVec3,
    /// From the level of its middle to that of its edges.
    pub(super) fold: DVec3,
}

/// The triangles of a leaf.
pub(super) const LEAF_TRIANGLES: u64 = 4;

impl Leaf {
    /// The corners of its triangle number `part`.
    fn triangle(&self, part: u64) -> [DVec3; 3] {
        let middle = self.base + self.along * 0.45;
        let tip = self.base + self.along - self.fold;
        let [right, left] = [self.across, -self.across].map(|side| middle + side + self.fold);
        match part {
            0 => [self.base, right, middle],
            1 => [self.base, middle, left],
            2 => [middle, right, tip],
            _ => [middle, tip, left],
        }
    }
}

/// Grows a plant's leaves: each from its own random numbers, at a share of their full size.
pub(super) type Growth = Box<dyn Fn(&mut Random, f64) -> Leaf + Send + Sync>;

/// Leaves whose triangles share no vertex.
pub(super) struct Foliage {
    /// If this is not a multiple of [`LEAF_TRIANGLES`], the last leaf is cut.
    pub(super) triangles: u64,
    /// The size of leaves, as a share of their full size.
    pub(super) scale: f64,
    pub(super) seed: u64,
    pub(super) growth: Growth,
}

impl Foliage {
    fn corners(&self, t: u64) -> [DVec3; 3] {
        let (leaf, part) = (t / LEAF_TRIANGLES, t % LEAF_TRIANGLES);
        (self.growth)(&mut Random::new(self.seed, leaf), self.scale).triangle(part)
    }
}

impl Surface for Foliage {
    fn vertices(&self) -> u64 {
        3 * self.triangles
    }

    fn triangles(&self) -> u64 {
        self.triangles
    }

    fn position(&self, v: u64) -> DVec3 {
        self.corners(v / 3)[(v % 3) as usize]
    }

    fn normal(&self, v: u64) -> DVec3 {
        let [a, b, c] = self.corners(v / 3);
        (b - a).cross(c - a).normalize()
    }

    fn triangle(&self, t: u64) -> [u32; 3] {
        [3 * t, 3 * t + 1, 3 * t + 2].map(|v| v as u32)
    }
}
