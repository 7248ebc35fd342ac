//! Boxes, and the ray-box test that never loses a hit.
//!
//! The test is the slab test of Kay and Kajiya (1986). Ize (*Robust BVH Ray Traversal*, 2013) makes
//! it conservative by widening the far t; here the error bound is split instead into what depends
//! on the box, added to the box once when it is made ([`Aabb::padded`]), and what depends on the
//! ray, added to its origin once ([`SlabRay::new`]). The inner loop then pays nothing for it.
//!
//! # The bound
//!
//! With u the unit roundoff, v a vertex in the box and o the origin, the triangle test places v
//! sideways with an error of at most 10 u (|v| + |o|), largest norms, and accepts a hit only if
//! the ray passes within that of the exact triangle. A slab's t, turned back into a length along
//! its axis, is off by at most 4 u (|v| + |o|). Both together stay below [`PADDING`] times
//! (|v| + |o|).
//!
//! A part of a primitive has the error of the whole one, and ends at points that were computed:
//! its box is padded by twice the bound of the whole ([`Aabb::padded_as_part`]), however small its
//! own coordinates are.
//!
//! # Why culling by distance loses nothing either
//!
//! A hit's t is the primitive's own, and no box changes it. What a box says of t is compared with it
//! in one place only: a box is skipped if the ray enters it after the closest hit so far. Two steps
//! show that a box with a closer hit, or one as close, is not.
//!
//! - **The box begins no later than the hit.** The hit is at a point of the primitive that the ray
//!   passes within the error above, so the padded box around that point holds the ray's point at
//!   the exact t. With the rest of the padding, which rounding of the slab's t cannot use up,
//!   the computed near t is no greater. Subtraction, multiplication, minimum and maximum are
//!   monotone under rounding, so that it is no greater for any box around that one either, whatever
//!   the build made of the tree.
//! - **The hit's own t is near the exact one.** A triangle's t that single precision gives is off by
//!   at most [`T_TOLERANCE`](crate::kernels::triangle::T_TOLERANCE) of it. Where the bound is greater,
//!   t is the exact one, rounded once, of a point of the triangle; or that of the point of its boundary
//!   that the ray passes within the error above. A sphere's t is off by at most about the square root of double
//!   precision's unit roundoff times the coordinates, where the ray touches it, which is less than
//!   the padding. So boxes are visited until four times that tolerance beyond the closest hit
//!   (`reach` in the tree), ties included: the lowest number among equal t is found, in whatever
//!   order boxes are entered.
//!
//! For a ray that starts or ends at some t the same holds: a hit counts only if the bound, or double
//! precision, leaves no doubt that it lies between them.

use glam::{Vec3, Vec3A};

use super::precision::{Arithmetic, Robust};
use crate::math::float::{UNIT_ROUNDOFF, max, max_abs, min};
use crate::math::ray::Ray;
use crate::math::real::Real;

/// The error bound of the module documentation, relative to coordinates.
pub const PADDING: f32 = 16.0 * UNIT_ROUNDOFF;

/// A box with sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Its smallest coordinates.
    pub low: Vec3,
    /// Its largest coordinates.
    pub high: Vec3,
}

impl Aabb {
    /// The box of nothing.
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

    /// The smallest box around both.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The box grown by the part of the error bound that depends on its own coordinates.
    #[inline]
    #[must_use]
    pub fn padded(self) -> Self {
        let pad = PADDING * max(max_abs(self.low), max_abs(self.high));
        Self { low: self.low - pad, high: self.high + pad }
    }

    /// The box of a part of a primitive whose own box is `whole`, grown by the error bound of that
    /// primitive, and as much again since the part ends at points that were computed.
    #[inline]
    #[must_use]
    pub fn padded_as_part(self, whole: &Self) -> Self {
        let pad = 2.0 * PADDING * max(max_abs(whole.low), max_abs(whole.high));
        Self { low: self.low - pad, high: self.high + pad }
    }

    /// Whether `other` lies within.
    pub fn contains(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && self.high.cmpge(other.high).all()
    }
}

/// A range of t, empty where `near` > `far`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Where the ray enters.
    pub near: f32,
    /// Where it leaves.
    pub far: f32,
}

/// A ray made ready for slab tests.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay {
    /// Reciprocal of the direction: infinite, of the zero's sign, where a component is zero. 1 or -1
    /// where it would be infinite and the component is not.
    pub reciprocal: Vec3A,
    /// The origin moved along the direction, for the planes met first.
    pub near_origin: Vec3A,
    /// The origin moved back, for the planes met last.
    pub far_origin: Vec3A,
    /// For each axis, whether the ray runs towards smaller coordinates.
    pub negative: [bool; 3],
}

impl SlabRay {
    /// Prepares `ray` for boxes that are padded.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        Self::of::<Robust>(ray)
    }

    /// Prepares `ray`, for boxes as they are if it is to be fast.
    #[inline(always)]
    pub fn of<P: Arithmetic>(ray: &Ray) -> Self {
        if P::IS_FAST {
            return Self::unpadded(ray);
        }
        Self::widened(ray, 1.0)
    }

    /// Prepares `ray` for boxes whose content may be off by `factor` times as much as primitives are.
    #[inline(always)]
    pub fn widened(ray: &Ray, factor: f32) -> Self {
        let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
        let reciprocal = direction.recip();
        let negative = reciprocal.cmplt(Vec3A::ZERO);
        let pad = max(factor * PADDING * origin.abs().max_element(), f32::MIN_POSITIVE);
        let shift = Vec3A::select(negative, Vec3A::splat(-pad), Vec3A::splat(pad));
        // Where a component is no zero, and its reciprocal not a number of single precision, it cannot be told where
        // the ray meets a plane, only that it can be before any other t: all boxes count as met along that axis.
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

    /// The plain slab test: what is lost to rounding is lost.
    #[inline(always)]
    fn unpadded(ray: &Ray) -> Self {
        let (origin, reciprocal) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction).recip());
        let negative = reciprocal.cmplt(Vec3A::ZERO).into();
        Self { reciprocal, near_origin: origin, far_origin: origin, negative }
    }

    /// The range of t in which the ray is in `bounds`, at least.
    ///
    /// Across a zero component every difference but zero becomes an infinite t of the right sign.
    /// A difference of zero becomes a NaN, and what comes of it has no meaning: the ray then runs in
    /// the very face of the padded box, where no hit is.
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

    /// Where the ray crosses the planes across axis `k` that it meets first and last, of one box or of several.
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

    /// Every axis, sign, and face plane: a ray that runs in a face of the box meets the box.
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
