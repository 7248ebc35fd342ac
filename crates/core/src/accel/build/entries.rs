//! The entries of leaves: triangles, both halves of each quad, and quadrics, in this order.

use crate::geometry::Geometry;
use crate::kernels::{Aabb, quad};

/// A primitive alone, or a half of a quad.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    pub(super) number: u32,
    /// The vertices; none of a quadric.
    pub(super) corners: Option<[u32; 3]>,
}

impl Geometry {
    /// Number of entries.
    pub(super) fn entries(&self) -> usize {
        self.own() + self.quads.len()
    }

    /// The number of the entry's primitive.
    pub(super) fn number_of(&self, entry: u32) -> u32 {
        let behind = (entry as usize).saturating_sub(self.triangles.len());
        entry - behind.div_ceil(2).min(self.quads.len()) as u32
    }

    /// The vertices of a triangle, or of a half of a quad.
    #[inline(always)]
    pub(super) fn corners_of(&self, entry: u32) -> Option<[u32; 3]> {
        let index = entry as usize;
        if let Some(corners) = self.triangles.get(index) {
            return Some(*corners);
        }
        let half = index - self.triangles.len();
        self.quads.get(half / 2).map(|quad| quad::halves(quad)[half % 2])
    }

    /// The smallest box around the entry.
    #[inline(always)]
    pub(super) fn box_of(&self, entry: u32) -> Aabb {
        match self.corners_of(entry) {
            Some(corners) => Aabb::around(corners.map(|v| self.positions[v as usize])),
            None => {
                let behind = self.entries() - entry as usize;
                self.quadrics[self.quadrics.len() - behind].bounds()
            }
        }
    }
}
