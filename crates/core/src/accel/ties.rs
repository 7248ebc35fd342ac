//! The order of two hits that single precision cannot tell.
//!
//! The t of an exact hit has an error of up to [`T_TOLERANCE`]. Two hits that are farther apart are
//! ordered by their t. Others are ordered by the exact t of their planes, rounded once, and by
//! number if these are equal: copies of a triangle with any order of corners, and coplanar
//! surfaces, are thus hit at the lowest number. Both orders agree where both apply, so the first
//! hit does not depend on which other hits were found.

use glam::Vec3;

use super::geometry::{Geometry, Primitive};
use super::{Hit, NO_PRIMITIVE};
use crate::kernels::precision::Arithmetic;
use crate::kernels::quad;
use crate::kernels::triangle::{T_TOLERANCE, exact};
use crate::math::ray::Ray;
use crate::math::real::Real;

/// Twice the tolerance, plus the rounding error of the difference.
const DOUBT: f32 = 2.125 * T_TOLERANCE;

/// The lanes in which the order of hits at these t is not certain.
#[inline(always)]
pub(super) fn are_close<F: Real<Element = f32>>(t: F, other: F) -> F::Mask {
    (t - other).abs().le(t.abs().times(DOUBT))
}

/// Whether hits may need more than their t for ordering.
#[inline(always)]
pub(super) const fn has_doubt<P: Arithmetic>() -> bool {
    !P::IS_FAST && !P::IS_REFERENCE
}

impl Hit {
    #[inline(always)]
    fn precedes(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.primitive < other.primitive)
    }
}

impl Geometry {
    /// Whether a `new` hit of a ray comes before the `best` so far, which may be the placeholder.
    #[inline(always)]
    pub(super) fn comes_first<P: Arithmetic>(
        &self,
        new: &Hit,
        best: &Hit,
        ray: impl FnOnce() -> Ray,
    ) -> bool {
        if has_doubt::<P>() && are_close(new.t, best.t) && best.primitive != NO_PRIMITIVE {
            return new.primitive != best.primitive && self.settle_order(new, best, &ray());
        }
        new.precedes(best)
    }

    /// As [`Self::comes_first`], without rounding.
    #[cold]
    #[inline(never)]
    fn settle_order(&self, new: &Hit, best: &Hit, ray: &Ray) -> bool {
        let [a, b] = [new, best].map(|hit| self.primitive(hit.primitive));
        let (geometry, ray) = match (a, b) {
            (Primitive::Instanced(a), Primitive::Instanced(b)) if a.instance == b.instance => {
                let (instance, prototype) = self.instance(a);
                let local = |hit: &Hit| Hit { primitive: hit.primitive - instance.first(), ..*hit };
                return prototype.settle_order(&local(new), &local(best), &instance.carried(ray));
            }
            // Transforms are rounded: instances are never exactly coplanar.
            (Primitive::Instanced(_), _) | (_, Primitive::Instanced(_)) => {
                return new.precedes(best);
            }
            _ => (self, ray),
        };
        if let (Primitive::Triangle(a), Primitive::Triangle(b)) = (a, b)
            && are_copies(&geometry.triangle(a), &geometry.triangle(b))
        {
            return new.primitive < best.primitive;
        }
        let exactly = |hit: &Hit| Hit { t: geometry.exact_t(hit, ray), ..*hit };
        exactly(new).precedes(&exactly(best))
    }

    /// The exact t of the plane of a hit, rounded; the hit's own t if it is on no plane or on the
    /// triangle's boundary.
    fn exact_t(&self, hit: &Hit, ray: &Ray) -> f32 {
        let plane = |corners: &[_; 3]| {
            let t = exact::plane(ray, corners).map(|t| t as f32);
            // Not for hits beside the triangle.
            t.filter(|&t| (t - hit.t).abs() <= T_TOLERANCE * t.abs())
        };
        let exact = match self.primitive(hit.primitive) {
            Primitive::Triangle(i) => plane(&self.triangle(i)),
            Primitive::Quad(i) => {
                let halves = quad::halves(&self.quad(i));
                let [first, second] = halves.each_ref().map(&plane);
                let is_first =
                    |t: f32| second.is_none_or(|other| (t - hit.t).abs() <= (other - hit.t).abs());
                // Of the half that the ray meets: by rounding, the halves of a flat quad lie in two planes.
                match halves.each_ref().map(|half| exact::intersect(ray, half).is_some()) {
                    [true, _] => first,
                    [_, true] => second,
                    _ => first.filter(|&t| is_first(t)).or(second),
                }
            }
            Primitive::Sphere(_) | Primitive::Instanced(_) => None,
        };
        exact.unwrap_or(hit.t)
    }
}

/// Whether triangles have the same three corners.
fn are_copies(a: &[Vec3; 3], b: &[Vec3; 3]) -> bool {
    a.iter().all(|corner| b.contains(corner)) && b.iter().all(|corner| a.contains(corner))
}
