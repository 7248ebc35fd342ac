//! The quad: two watertight triangles on a fixed diagonal, treated as one primitive.
//!
//! So even a quad whose corners are not quite coplanar has no cracks, inside or towards neighbours
//! that share an edge.

use glam::Vec3;

use super::triangle::{Meeting, ShearedSpace};
use crate::math::float::min;

/// The two triangles of a quad, on the diagonal from the first corner to the third. Both have the
/// winding of the quad.
#[inline(always)]
pub fn halves<T: Copy>(&[a, b, c, d]: &[T; 4]) -> [[T; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// The t at which the ray meets the quad: see [`ShearedSpace::intersect`].
#[inline(always)]
pub fn intersect(space: &ShearedSpace, quad: &[Vec3; 4]) -> Option<f32> {
    match meet(quad, |half| space.meet(half)) {
        Meeting::Miss => None,
        Meeting::Hit(t) | Meeting::Near(t) => Some(t),
    }
}

/// The meeting of a ray with the quad, given a test for each half: the smaller t if both are hit.
#[inline(always)]
pub fn meet(quad: &[Vec3; 4], test: impl Fn(&[Vec3; 3]) -> Meeting) -> Meeting {
    use Meeting::{Hit, Miss, Near};
    let [first, second] = halves(quad);
    match (test(&first), test(&second)) {
        (Hit(s), Hit(t)) => Hit(min(s, t)),
        (Hit(t), _) | (_, Hit(t)) => Hit(t),
        (Near(s), Near(t)) => Near(min(s, t)),
        (Near(t), Miss) | (Miss, Near(t)) => Near(t),
        (Miss, Miss) => Miss,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::ray::Ray;

    #[test]
    fn the_whole_quad_and_nothing_else_is_met() {
        let quad = [Vec3::ZERO, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::X];
        let at = |x: f32, y: f32| {
            let ray = Ray::new(Vec3::new(x, y, 2.0), Vec3::NEG_Z);
            intersect(&ShearedSpace::new(&ray), &quad)
        };
        for i in 0..=16 {
            for j in 0..=16 {
                assert_eq!(at(i as f32 / 16.0, j as f32 / 16.0), Some(2.0));
            }
        }
        for (x, y) in [(-0.01, 0.5), (1.01, 0.5), (0.5, -0.01), (0.5, 1.01)] {
            assert_eq!(at(x, y), None);
        }
    }
}
