//! The quad: two triangles on a fixed diagonal, treated as one primitive.
//!
//! So even a quad whose corners are not quite coplanar has no cracks, inside or towards neighbours
//! that share an edge.

/// The two triangles of a quad, on the diagonal from the first corner to the third. Both have the
/// winding of the quad.
#[inline(always)]
pub fn halves<T: Copy>(&[a, b, c, d]: &[T; 4]) -> [[T; 3]; 2] {
    [[a, b, c], [a, c, d]]
}
