//! Boxes, and the ray-box test that never loses a hit.
//!
//! The test is the slab test of Kay and Kajiya (1986). Ize (*Robust BVH Ray Traversal*, 2013) makes
//! it conservative by widening the far t. Here the error bound is split instead: the part that
//! depends on the box is added to the box when it is made ([`Aabb::padded`]), and the part that
//! depends on the ray is added to its origin ([`SlabRay::new`]). The inner loop then pays nothing
//! for it.
//!
//! # The bound
//!
//! With u the unit roundoff, v a vertex in the box and o the origin, a slab's t, as a length along
//! its axis, is off by at most 4 u (|v| + |o|), in maximum norms, and hits are exact. [`PADDING`]
//! times (|v| + |o|) is four times as much.
//!
//! The ends of a part of a primitive are computed points: its box is padded by twice the bound of the
//! whole ([`Aabb::padded_as_part`]), however small its own coordinates are.
//!
//! # Why culling by distance loses nothing
//!
//! A hit's t is the primitive's own; boxes do not change it. A box's t matters in one place only: a
//! box is skipped if the ray enters it after the closest hit so far, or after an upper bound of its
//! t. No box with a closer or equally close hit is skipped. The ray's point at the exact t of such a
//! hit lies in the box, and the padding exceeds the rounding error of the slab's t, so the computed
//! near t is no greater than the exact t, nor, as rounding is monotone, than the exact t rounded. The
//! same holds for any box around that one, whatever the shape of the tree, and for the ends of a
//! ray's range.

use glam::{Vec3, Vec3A};

use super::precision::{Arithmetic, Exact};
use crate::math::float::{UNIT_ROUNDOFF, max, max_abs, min};
use crate::math::ray::Ray;
use crate::math::real::Real;

/// The error bound of the module documentation, as a factor of the coordinates.
pub const PADDING: f32 = 16.0 * UNIT_ROUNDOFF;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The smallest coordinates.
    pub low: Vec3,
    /// The largest coordinates.
    pub high: Vec3,
}

impl Aabb {
    /// The empty box.
    pub const EMPTY: Self =
        Self { low: Vec3::splat(f32::INFINITY), high: Vec3::splat(f32::NEG_INFINITY) };

    /// The smallest box around `points`.
    #[inline]
    pub fn around<const N: usize>(points: [Vec3; N]) -> Self {
        let mut low = points[0];
        let mut high = points[0];
        for p in &points[1..] {
            low = Vec3::new(min(low.x, p.x), min(low.y, p.y), min(low.z, p.z));
            high = Vec3::new(max(high.x, p.x), max(high.y, p.y), max(high.z, p.z));
        }
        Self { low, high }
    }

    /// The smallest box around both boxes.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The box, grown by the part of the error bound that depends on its coordinates.
    #[inline]
    #[must_use]
    pub fn padded(self) -> Self {
        let pad = PADDING * max(max_abs(self.low), max_abs(self.high));
        Self { low: self.low - pad, high: self.high + pad }
    }

    /// The box of a part of a primitive whose own box is `whole`, grown by twice the error bound of
    /// that primitive, since the ends of the part are computed points.
    #[inline]
    #[must_use]
    pub fn padded_as_part(self, whole: &Self) -> Self {
        let pad = 2.0 * PADDING * max(max_abs(whole.low), max_abs(whole.high));
        Self { low: self.low - pad, high: self.high + pad }
    }

    /// Whether `other` lies inside.
    pub fn contains(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && self.high.cmpge(other.high).all()
    }
}

/// A range of t, empty if `near` > `far`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Where the ray enters.
    pub near: f32,
    /// Where it leaves.
    pub far: f32,
}

/// A ray prepared for slab tests.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay {
    /// Reciprocal of the direction. Infinite, with the sign of the zero, for zero components; 1 or
    /// -1 for other components whose reciprocal would be infinite.
    pub reciprocal: Vec3A,
    /// The origin moved along the direction, for entry planes.
    pub near_origin: Vec3A,
    /// The origin moved back, for exit planes.
    pub far_origin: Vec3A,
    /// For each axis, whether the ray runs towards smaller coordinates.
    pub negative: [bool; 3],
}

impl SlabRay {
    /// Prepares `ray` for padded boxes.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        Self::of::<Exact>(ray)
    }

    /// Prepares `ray`; for unpadded boxes in fast precision.
    #[inline(always)]
    pub fn of<P: Arithmetic>(ray: &Ray) -> Self {
        if P::IS_FAST {
            return Self::unpadded(ray);
        }
        Self::widened(ray, 1.0)
    }

    /// Prepares `ray` for boxes whose content may be off by `factor` times the error of primitives.
    #[inline(always)]
    pub fn widened(ray: &Ray, factor: f32) -> Self {
        let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
        let reciprocal = direction.recip();
        let negative = reciprocal.cmplt(Vec3A::ZERO);
        let pad = max(factor * PADDING * origin.abs().max_element(), f32::MIN_POSITIVE);
        let shift = Vec3A::select(negative, Vec3A::splat(-pad), Vec3A::splat(pad));
        // If the reciprocal of a nonzero component overflows single precision, the crossing of a
        // plane is unknown: all boxes count as met along that axis.
        let unknown = reciprocal.abs().cmpeq(Vec3A::INFINITY) & direction.cmpne(Vec3A::ZERO);
        let sign = Vec3A::select(negative, Vec3A::NEG_ONE, Vec3A::ONE);
        let before = sign * f32::MAX;
        Self {
            reciprocal: Vec3A::select(unknown, sign, reciprocal),
            near_origin: Vec3A::select(unknown, before, origin + shift),
            far_origin: Vec3A::select(unknown, -before, origin - shift),
            negative: negative.into(),
        }
    }

    /// The plain slab test, without error bounds.
    #[inline(always)]
    fn unpadded(ray: &Ray) -> Self {
        let (origin, reciprocal) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction).recip());
        let negative = reciprocal.cmplt(Vec3A::ZERO).into();
        Self { reciprocal, near_origin: origin, far_origin: origin, negative }
    }

    /// A range of t that contains all t at which the ray is in `bounds`.
    ///
    /// For a zero component, every nonzero difference becomes an infinite t of the right sign. A
    /// zero difference becomes a NaN with unspecified results: the ray then runs exactly in a face
    /// of the padded box, where there is no hit.
    #[inline(always)]
    pub fn interval(&self, bounds: &Aabb) -> Interval {
        let axis = |k: usize| {
            let (low, high) = (bounds.low[k], bounds.high[k]);
            let [first, last] = if self.negative[k] { [high, low] } else { [low, high] };
            self.crossings(k, first, last)
        };
        let ([x0, x1], [y0, y1], [z0, z1]) = (axis(0), axis(1), axis(2));
        Interval { near: max(x0, max(y0, z0)), far: min(x1, min(y1, z1)) }
    }

    /// The t at which the ray crosses its entry and exit planes on axis `k`, of one box or of
    /// several.
    #[inline(always)]
    pub fn crossings<F: Real<Element = f32>>(&self, k: usize, first: F, last: F) -> [F; 2] {
        let near = first - first.same(self.near_origin[k]);
        let far = last - last.same(self.far_origin[k]);
        [near.times(self.reciprocal[k]), far.times(self.reciprocal[k])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> Aabb {
        Aabb { low: Vec3::ZERO, high: Vec3::ONE }
    }

    fn hits(ray: Ray, bounds: Aabb) -> bool {
        let i = SlabRay::new(&ray).interval(&bounds.padded());
        i.near <= i.far && i.far >= ray.t_min && i.near <= ray.t_max
    }

    /// For every axis, sign and face plane: a ray that runs in a face of the box meets the box.
    #[test]
    fn hc04_a_ray_in_a_face_meets_the_box() {
        for axis in 0..3 {
            for sign in [1.0_f32, -1.0] {
                for corner in 0..4 {
                    let mut origin = Vec3::splat(0.5);
                    origin[(axis + 1) % 3] = (corner & 1) as f32;
                    origin[(axis + 2) % 3] = (corner >> 1) as f32;
                    origin[axis] = 0.5 - 2.0 * sign;
                    for zero in [0.0_f32, -0.0] {
                        let mut direction = Vec3::splat(zero);
                        direction[axis] = sign;
                        assert!(
                            hits(Ray::new(origin, direction), unit_box()),
                            "{origin} {direction}"
                        );
                        direction[axis] = -sign;
                        assert!(!hits(Ray::new(origin, direction), unit_box()));
                    }
                }
            }
        }
    }

    #[test]
    fn hc06_tiny_direction_components_do_not_cut_the_box() {
        for exponent in [-45, -38, -20, -6] {
            let tiny = 10.0_f64.powi(exponent) as f32;
            for sign in [1.0, -1.0] {
                let ray = Ray::new(Vec3::new(0.005, 0.005, -1e4), Vec3::new(sign * tiny, 0.0, 1.0));
                let small = Aabb { low: Vec3::ZERO, high: Vec3::splat(0.02) };
                assert!(hits(ray, small), "{ray:?}");
            }
        }
    }

    #[test]
    fn a_box_beside_the_ray_is_missed() {
        let ray = Ray::new(Vec3::new(2.0, 0.5, -1.0), Vec3::Z);
        assert!(!hits(ray, unit_box()));
    }

    #[test]
    fn an_interval_contains_that_of_every_box_within() {
        let inner = Aabb { low: Vec3::splat(0.3), high: Vec3::splat(0.31) }.padded();
        let outer = unit_box().padded();
        assert!(outer.contains(&inner));
        for i in 0..1000 {
            let f = i as f32;
            let direction = Vec3::new((f * 0.37).fract() - 0.5, (f * 0.71).fract() - 0.5, 1.0);
            let slab = SlabRay::new(&Ray::new(Vec3::new(0.3, 0.305, -f), direction));
            let (i, o) = (slab.interval(&inner), slab.interval(&outer));
            assert!(o.near <= i.near && i.far <= o.far);
        }
    }
}
