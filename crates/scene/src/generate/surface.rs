//! Surfaces: pure functions of the number of a vertex or of a triangle.

use glam::DVec3;

/// A mesh as pure functions of the number of a vertex or of a triangle.
pub(super) trait Surface: Sync {
    /// The number of vertices, below 2^31.
    fn vertices(&self) -> u64;
    /// The position of vertex `v`.
    fn position(&self, v: u64) -> DVec3;
    /// The unit normal at vertex `v`, on the front, from central differences over one step of the
    /// grid: the normal of the surface at the resolution of the mesh.
    fn normal(&self, v: u64) -> DVec3;
    /// The vertices of triangle `t`, counter-clockwise as seen from the front.
    fn triangle(&self, t: u64) -> [u32; 3];
}

/// One `half` (0 or 1) of a cell with corners `a b c d`, counter-clockwise, cut from `a` to `c` if
/// `forward`, else from `b` to `d`.
pub(super) fn cell_triangle([a, b, c, d]: [u32; 4], forward: bool, half: u64) -> [u32; 3] {
    match (forward, half) {
        (true, 0) => [a, b, c],
        (true, _) => [a, c, d],
        (false, 0) => [a, b, d],
        (false, _) => [b, c, d],
    }
}
