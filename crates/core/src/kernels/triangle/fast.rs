//! The ray-triangle test of Möller and Trumbore (*Fast, Minimum Storage Ray/Triangle Intersection*,
//! 1997), in single precision: what most renderers use, and what the watertight test is measured
//! against. Rays that pass an edge nearer than rounding may miss the triangles on both of its sides.
//!
//! For one triangle and for several at a time: the same operations in the same order.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, SimdFloat, f32x8, u32x8};
use glam::Vec3;

use super::lanes::LaneHits;
use crate::math::ray::Ray;
use crate::math::simd::Lanes;

/// Where a ray meets a triangle's plane, with the barycentric coordinates of the second and the third
/// corner.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Where on the ray.
    pub t: f32,
    /// Of the second corner.
    pub u: f32,
    /// Of the third corner.
    pub v: f32,
}

/// Where `ray` meets the plane of `triangle`: nothing of it is a number if it does not.
#[inline(always)]
pub fn crossing(ray: &Ray, &[a, b, c]: &[Vec3; 3]) -> Crossing {
    let d = ray.direction;
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let s = ray.origin - a;
    let u = s.dot(p) * inverse;
    let q = s.cross(e1);
    let v = d.dot(q) * inverse;
    Crossing { t: e2.dot(q) * inverse, u, v }
}

/// The t at which `ray` meets `triangle`, from either side, before or behind its origin.
#[inline(always)]
pub fn intersect(ray: &Ray, triangle: &[Vec3; 3]) -> Option<f32> {
    let Crossing { t, u, v } = crossing(ray, triangle);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then_some(t)
}

/// A vector in each lane.
type V<F> = [F; 3];

#[inline(always)]
fn minus<S: Simd, F: SimdFloat<S, Element = f32>>(a: V<F>, b: V<F>) -> V<F> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn cross<S: Simd, F: SimdFloat<S, Element = f32>>(a: V<F>, b: V<F>) -> V<F> {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

#[inline(always)]
fn dot<S: Simd, F: SimdFloat<S, Element = f32>>(a: V<F>, b: V<F>) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// As [`intersect`] for pairs of rays and triangles: t, and which of the `used` pairs meet within the
/// range of t. `one` is 1 in each lane.
#[inline(always)]
pub(crate) fn lanes<S: Simd, F: SimdFloat<S, Element = f32>>(
    (origin, d): (V<F>, V<F>),
    [a, b, c]: [V<F>; 3],
    [t_min, t_max, one]: [F; 3],
    used: u32,
) -> (F, u32) {
    let (e1, e2) = (minus(b, a), minus(c, a));
    let p = cross(d, e2);
    let inverse = one / dot(e1, p);
    let s = minus(origin, a);
    let u = dot(s, p) * inverse;
    let q = cross(s, e1);
    let v = dot(d, q) * inverse;
    let t = dot(e2, q) * inverse;
    let inside = u.simd_ge(0.0) & v.simd_ge(0.0) & (u + v).simd_le(1.0);
    let hit = inside & t.simd_gt(t_min) & t.simd_lt(t_max);
    (t, hit.to_bitmask() as u32 & used)
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
    let a = [simd.permute(x, a), simd.permute(y, a), simd.permute(z, a)];
    let b = [simd.permute(x, b), simd.permute(y, b), simd.permute(z, b)];
    let c = [simd.permute(x, c), simd.permute(y, c), simd.permute(z, c)];
    intersect_eight(simd, ray, [a, b, c], used)
}

/// Tests up to eight triangles; `corners` has a corner and an axis a row.
#[inline(always)]
pub fn intersect_soup<S: Lanes>(
    simd: S,
    ray: &Ray,
    corners: &[[[f32; 8]; 3]; 3],
    used: u32,
) -> LaneHits {
    intersect_eight(
        simd,
        ray,
        [load(simd, &corners[0]), load(simd, &corners[1]), load(simd, &corners[2])],
        used,
    )
}

#[inline(always)]
fn load<S: Lanes>(simd: S, rows: &[[f32; 8]; 3]) -> V<f32x8<S>> {
    [rows[0].simd_into(simd), rows[1].simd_into(simd), rows[2].simd_into(simd)]
}

#[inline(always)]
fn intersect_eight<S: Lanes>(simd: S, ray: &Ray, corners: [V<f32x8<S>>; 3], used: u32) -> LaneHits {
    let (o, d) = (ray.origin, ray.direction);
    let origin = [f32x8::splat(simd, o.x), f32x8::splat(simd, o.y), f32x8::splat(simd, o.z)];
    let direction = [f32x8::splat(simd, d.x), f32x8::splat(simd, d.y), f32x8::splat(simd, d.z)];
    let range =
        [f32x8::splat(simd, ray.t_min), f32x8::splat(simd, ray.t_max), f32x8::splat(simd, 1.0)];
    let (t, hits) = lanes((origin, direction), corners, range, used);
    LaneHits { t: t.into(), certain: hits, open: 0 }
}
