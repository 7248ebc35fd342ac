//! The shared vertices of a leaf's triangles.

use std::array::from_fn;

use crate::math::LANES;

/// The vertices of up to eight triangles, each once.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SharedVertices {
    /// The first `count` are used.
    pub(super) vertices: [u32; LANES],
    /// Number of vertices.
    pub(super) count: u32,
    /// For each corner, the index of its vertex in each triangle, four bits each.
    pub(super) corners: [u32; 3],
}

impl SharedVertices {
    /// Adds the triangle in `lane`. If its vertices do not fit, the content becomes unspecified.
    #[inline(always)]
    pub(crate) fn add(&mut self, lane: usize, triangle: [u32; 3]) -> bool {
        let Self { mut vertices, mut count, .. } = *self;
        for (corner, v) in triangle.into_iter().enumerate() {
            // All at once, in registers, and without a branch that depends on the mesh.
            let equal: [u32; LANES] = from_fn(|k| u32::from(vertices[k] == v) << k);
            let known: u32 = equal.iter().sum();
            let local = known.trailing_zeros().min(count);
            vertices = from_fn(|k| if k as u32 == local { v } else { vertices[k] });
            count = count.max(local + 1);
            self.corners[corner] |= local << (4 * lane);
        }
        (self.vertices, self.count) = (vertices, count);
        count as usize <= LANES
    }
}
