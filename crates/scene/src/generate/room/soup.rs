//! Facets that share no vertex: flat parts with sharp edges, and leaves.

use glam::DVec3;

use crate::generate::surface::{Surface, cell_triangle};

/// Triangles, or flat convex quads, each with its own corners.
pub(super) struct Soup {
    /// Corners of each facet: 3 or 4.
    pub(super) sides: u64,
    pub(super) facets: u64,
    /// The corners of a facet by its number, counter-clockwise as seen from the front; a triangle
    /// repeats its last one.
    pub(super) facet: Box<dyn Fn(u64) -> [DVec3; 4] + Send + Sync>,
}

impl Surface for Soup {
    fn vertices(&self) -> u64 {
        self.sides * self.facets
    }

    fn triangles(&self) -> u64 {
        (self.sides - 2) * self.facets
    }

    fn position(&self, v: u64) -> DVec3 {
        (self.facet)(v / self.sides)[(v % self.sides) as usize]
    }

    fn normal(&self, v: u64) -> DVec3 {
        let [a, b, c, _] = (self.facet)(v / self.sides);
        (b - a).cross(c - a).normalize()
    }

    fn triangle(&self, t: u64) -> [u32; 3] {
        let halves = self.sides - 2;
        let first = (t / halves * self.sides) as u32;
        cell_triangle([first, first + 1, first + 2, first + 3], true, t % halves)
    }
}
