//! The ray-triangle test of Möller and Trumbore (*Fast, Minimum Storage Ray/Triangle Intersection*,
//! 1997), in single precision, as in most renderers: the baseline for the watertight test. Rays
//! that pass an edge closer than rounding may miss the triangles on both sides.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, u32x8};

use super::lanes::LaneHits;
use crate::math::ray::Ray;
use crate::math::real::{Mask, Real};
use crate::math::simd::Lanes;
use crate::math::vector::{Line, Vector};

/// The crossing of a ray with a triangle's plane, with the barycentric coordinates of the second
/// and the third corner. NaN if there is none.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<F> {
    /// t along the ray.
    pub t: F,
    /// Of the second corner.
    pub u: F,
    /// Of the third corner.
    pub v: F,
}

/// The crossings of rays with the planes of their triangles.
#[inline(always)]
pub fn crossing<F: Real<Element = f32>>(
    line: &Line<F>,
    &[a, b, c]: &[Vector<F>; 3],
) -> Crossing<F> {
    let (e1, e2) = (b - a, c - a);
    let p = line.direction.cross(e2);
    let inverse = a.x.same(1.0) / e1.dot_in_order(p);
    let s = line.origin - a;
    let u = s.dot_in_order(p) * inverse;
    let q = s.cross(e1);
    let v = line.direction.dot_in_order(q) * inverse;
    Crossing { t: e2.dot_in_order(q) * inverse, u, v }
}

/// The t at which rays meet their triangles, from either side, before or behind their origins; with
/// the lanes that hit.
#[inline(always)]
pub fn intersect<F: Real<Element = f32>>(
    line: &Line<F>,
    triangle: &[Vector<F>; 3],
) -> (F, F::Mask) {
    let Crossing { t, u, v } = crossing(line, triangle);
    let zero = t.zero();
    (t, u.ge(zero) & v.ge(zero) & (u + v).le(zero.same(1.0)))
}

/// Tests up to eight triangles over eight vertices: see
/// [`intersect_patch`](super::ShearedSpace::intersect_patch).
#[inline(always)]
pub fn intersect_patch<S: Lanes>(
    simd: S,
    ray: &Ray,
    positions: &[[f32; 8]; 3],
    corners: [u32; 3],
    used: u32,
) -> LaneHits {
    let x: f32x8<S> = positions[0].simd_into(simd);
    let y: f32x8<S> = positions[1].simd_into(simd);
    let z: f32x8<S> = positions[2].simd_into(simd);
    let shifts: u32x8<S> = [0, 4, 8, 12, 16, 20, 24, 28].simd_into(simd);
    let a = (u32x8::splat(simd, corners[0]) >> shifts) & 7;
    let b = (u32x8::splat(simd, corners[1]) >> shifts) & 7;
    let c = (u32x8::splat(simd, corners[2]) >> shifts) & 7;
    let corner = |i| Vector::new(simd.permute(x, i), simd.permute(y, i), simd.permute(z, i));
    intersect_eight(simd, ray, &[corner(a), corner(b), corner(c)], used)
}

/// Tests up to eight triangles; each row of `corners` is an axis of a corner.
#[inline(always)]
pub fn intersect_soup<S: Lanes>(
    simd: S,
    ray: &Ray,
    corners: &[[[f32; 8]; 3]; 3],
    used: u32,
) -> LaneHits {
    let [a, b, c] = corners;
    let corners = [Vector::load(simd, a), Vector::load(simd, b), Vector::load(simd, c)];
    intersect_eight(simd, ray, &corners, used)
}

#[inline(always)]
fn intersect_eight<S: Lanes>(
    simd: S,
    ray: &Ray,
    corners: &[Vector<f32x8<S>>; 3],
    used: u32,
) -> LaneHits {
    let origin = Vector::splat(simd, ray.origin);
    let line = Line { origin, direction: Vector::splat(simd, ray.direction) };
    let (t, inside) = intersect(&line, corners);
    let within = t.simd_gt(ray.t_min) & t.simd_lt(ray.t_max);
    LaneHits { t: t.into(), certain: (inside & within).bits() & used, open: 0 }
}
