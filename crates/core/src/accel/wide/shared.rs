//! Vertices that the triangles of a leaf share.

use std::array::from_fn;

use crate::math::simd::LANES;

/// The vertices of up to eight triangles, each once.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::accel) struct Shared {
    /// The first are used.
    pub(super) vertices: [u32; LANES],
    /// How many they are.
    pub(super) count: u32,
    /// For each corner, which of the vertices it is in each triangle, four bits each.
    pub(super) corners: [u32; 3],
}

impl Shared {
    /// Adds the triangle that is in `lane`. If its vertices find no room, what is here has no meaning.
    #[inline(always)]
    pub(in crate::accel) fn add(&mut self, lane: usize, triangle: [u32; 3]) -> bool {
        let Self { mut vertices, mut count, .. } = *self;
        for (corner, v) in triangle.into_iter().enumerate() {
            // All at once, in registers, and no branch that depends on the mesh.
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
