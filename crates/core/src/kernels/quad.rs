//! The quad: two triangles on a fixed diagonal, treated as one primitive.
//!
//! So even a quad whose corners are not quite coplanar has no cracks, inside or towards neighbours
//! that share an edge.
//!
//! # The half that a ray meets
//!
//! Seen along a ray, which is then a point, the diagonal lies on a line, and each half on the side
//! of its third corner. So a ray beside the line misses a half whose third corner is on the other
//! side; and a ray that hits the quad but misses a half meets the other. Open are rays that pass the
//! line itself, and quads seen folded, with both corners on the side of the ray, which may meet both.
//!
//! With a, b, c and d the corners, o the origin and r the direction of the ray, p = (c - a) x r is
//! normal to the plane through the diagonal along the ray, and the sides are the signs of p . (o - a),
//! p . (b - a) and p . (d - a). In the terms of [`super::triangle`], a component of p is off by 3 u m: a
//! difference, a product, and the difference of the products. The scalar product with another
//! difference adds 4 u, so that it is off by at most 7 u m . |o - a|: the bound of sides holds.

use super::triangle::settle::Cross;
use crate::math::{Line, Real, Single, Vector};

/// The two triangles of a quad, on the diagonal from the first corner to the third. Both have the
/// winding of the quad.
#[inline(always)]
pub fn halves<T: Copy>(&[a, b, c, d]: &[T; 4]) -> [[T; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// The rays that certainly miss the first half of their quad, and the second.
#[inline(always)]
pub(crate) fn missed_halves<F: Single>(
    line: &Line<F>,
    &[a, b, c, d]: &[Vector<F>; 4],
) -> [<F::Double as Real>::Mask; 2] {
    let (a, b, c, d) = (a.widen(), b.widen(), c.widen(), d.widen());
    let plane = Cross::of(c - a, line.direction.widen());
    let (above, below) = plane.signs(line.origin.widen() - a);
    let (b_above, b_below) = plane.signs(b - a);
    let (d_above, d_below) = plane.signs(d - a);
    [(above & b_below) | (below & b_above), (above & d_below) | (below & d_above)]
}
