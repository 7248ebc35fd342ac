//! Points of eight triangles or spheres at a time: the operations of [`super::triangle()`] and
//! [`super::sphere()`] in each lane, and so the same bits.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f64x8, mask32x8};
use glam::Vec3;

use super::FAST_ERROR;
use crate::kernels::precision::Arithmetic;
use crate::kernels::triangle::ShearedSpace;
use crate::math::lanes::{DVec3x8, Vec3x8, narrow, rounding_error, widen};
use crate::math::ray::Ray;
use crate::math::simd::{LANES, Lanes};

/// As [`super::Surface`], in each lane.
#[derive(Clone, Copy)]
pub struct Surfaces<S: Lanes> {
    /// The points, in world space.
    pub point: Vec3x8<S>,
    /// Bounds on the distance of the points to the exact surface, for each coordinate.
    pub error: Vec3x8<S>,
    /// The geometric normals, of unit length, on the sides that the windings give.
    pub normal: Vec3x8<S>,
    /// Barycentric coordinates of the second and the third corner.
    pub barycentric: [f32x8<S>; 2],
}

/// As [`super::triangle_at`] in each lane. `corners` has a corner and an axis a row.
#[inline(always)]
pub fn triangles_at<S: Lanes, P: Arithmetic>(
    simd: S,
    (origin, direction): (Vec3x8<S>, Vec3x8<S>),
    t: f32x8<S>,
    corners: &[[[f32; LANES]; 3]; 3],
) -> Surfaces<S> {
    if !P::IS_FAST {
        return triangles(simd, origin, direction, corners);
    }
    let a = Vec3x8::load(simd, &corners[0]);
    let (e1, e2) = (Vec3x8::load(simd, &corners[1]) - a, Vec3x8::load(simd, &corners[2]) - a);
    // `triangle::fast::crossing`.
    let p = direction.cross(e2);
    let inverse = f32x8::splat(simd, 1.0) / e1.dot_in_order(p);
    let s = origin - a;
    let u = s.dot_in_order(p) * inverse;
    let v = direction.dot_in_order(s.cross(e1)) * inverse;
    fast(simd, origin + direction.scale(t), e1.cross(e2), [u, v])
}

/// As [`super::sphere_at`] in each lane.
#[inline(always)]
pub fn spheres_at<S: Lanes, P: Arithmetic>(
    simd: S,
    (origin, direction): (Vec3x8<S>, Vec3x8<S>),
    t: f32x8<S>,
    center: Vec3x8<S>,
    radius: f32x8<S>,
) -> Surfaces<S> {
    if !P::IS_FAST {
        return spheres(simd, origin, direction, center, radius);
    }
    let point = origin + direction.scale(t);
    let zero = f32x8::splat(simd, 0.0);
    fast(simd, point, point - center, [zero, zero])
}

/// As fast arithmetic has them.
#[inline(always)]
fn fast<S: Lanes>(
    simd: S,
    point: Vec3x8<S>,
    normal: Vec3x8<S>,
    barycentric: [f32x8<S>; 2],
) -> Surfaces<S> {
    let error = Vec3x8::splat(simd, Vec3::splat(FAST_ERROR));
    Surfaces { point, error, normal: normal.normalize(), barycentric }
}

/// Where rays meet triangles, each its own. `corners` has a corner and an axis a row.
#[inline(always)]
pub fn triangles<S: Lanes>(
    simd: S,
    origin: Vec3x8<S>,
    direction: Vec3x8<S>,
    corners: &[[[f32; LANES]; 3]; 3],
) -> Surfaces<S> {
    let a = Vec3x8::load(simd, &corners[0]);
    let b = Vec3x8::load(simd, &corners[1]);
    let c = Vec3x8::load(simd, &corners[2]);
    let size = {
        // In the order of the single test, whose first operand is zero.
        let (a, b, c) = (a.max_abs(), b.max_abs(), c.max_abs());
        a.max(b).max(c)
    };
    let [wa, wb, wc] = weights(origin, direction, [a, b, c], corners);
    let (a, b, c) = (a.widen(), b.widen(), c.widen());
    let point = (a.scale(wa) + b.scale(wb) + c.scale(wc)).narrow();
    Surfaces {
        point,
        error: rounding_error(point, size),
        normal: (b - a).cross(c - a).normalize().narrow(),
        barycentric: [narrow(wb), narrow(wc)],
    }
}

/// See [`ShearedSpace::barycentric`]. Lanes in which the point is not certainly within the triangle
/// are asked one by one.
#[inline(always)]
fn weights<S: Lanes>(
    origin: Vec3x8<S>,
    direction: Vec3x8<S>,
    [a, b, c]: [Vec3x8<S>; 3],
    corners: &[[[f32; LANES]; 3]; 3],
) -> [f64x8<S>; 3] {
    let space = Space::new(origin, direction);
    let (ax, ay) = space.shear(a);
    let (bx, by) = space.shear(b);
    let (cx, cy) = space.shear(c);
    let e0 = cx * by - cy * bx;
    let e1 = ax * cy - ay * cx;
    let e2 = bx * ay - by * ax;
    let sum = e0 + e1 + e2;
    let (mut wa, mut wb, mut wc) = (e0 / sum, e1 / sum, e2 / sum);
    // False also where the sum is zero and the quotients are no numbers.
    let inside = wa.simd_ge(0.0) & wb.simd_ge(0.0) & wc.simd_ge(0.0) & sum.simd_ne(0.0);
    let mut open = !inside.to_bitmask() & 0xFF;
    while open != 0 {
        let lane = open.trailing_zeros() as usize & (LANES - 1);
        open &= open - 1;
        let ray = Ray::new(origin.lane(lane), direction.lane(lane));
        let [x, y, z] = one(&ray, corners, lane);
        (wa[lane], wb[lane], wc[lane]) = (x, y, z);
    }
    [wa, wb, wc]
}

#[cold]
#[inline(never)]
fn one(ray: &Ray, corners: &[[[f32; LANES]; 3]; 3], lane: usize) -> [f64; 3] {
    let corner = |[x, y, z]: &[[f32; LANES]; 3]| Vec3::new(x[lane], y[lane], z[lane]);
    let corners = [corner(&corners[0]), corner(&corners[1]), corner(&corners[2])];
    ShearedSpace::new(ray).barycentric(&corners).to_array()
}

/// The spaces of eight rays: see [`ShearedSpace`].
struct Space<S: Lanes> {
    along_x: mask32x8<S>,
    along_y: mask32x8<S>,
    /// Turned so that the longest axis is the last, as are the following.
    origin: DVec3x8<S>,
    direction: DVec3x8<S>,
}

impl<S: Lanes> Space<S> {
    #[inline(always)]
    fn new(origin: Vec3x8<S>, direction: Vec3x8<S>) -> Self {
        let Vec3x8 { x, y, z } = direction.abs();
        let along_x = x.simd_ge(y) & x.simd_ge(z);
        let along_y = !along_x & y.simd_ge(z);
        let origin = turn(along_x, along_y, origin).widen();
        let direction = turn(along_x, along_y, direction).widen();
        Self { along_x, along_y, origin, direction }
    }

    /// x and y of a vertex of each lane's triangle.
    #[inline(always)]
    fn shear(&self, vertex: Vec3x8<S>) -> (f64x8<S>, f64x8<S>) {
        let v = turn(self.along_x, self.along_y, vertex).widen() - self.origin;
        let t = v.z / self.direction.z;
        (v.x - self.direction.x * t, v.y - self.direction.y * t)
    }
}

/// The coordinates turned so that the longest axis is the last.
#[inline(always)]
fn turn<S: Lanes>(along_x: mask32x8<S>, along_y: mask32x8<S>, v: Vec3x8<S>) -> Vec3x8<S> {
    Vec3x8::new(
        along_x.select(v.y, along_y.select(v.z, v.x)),
        along_x.select(v.z, along_y.select(v.x, v.y)),
        along_x.select(v.x, along_y.select(v.y, v.z)),
    )
}

/// Where rays meet spheres, each its own: see [`super::sphere()`].
#[inline(always)]
pub fn spheres<S: Lanes>(
    simd: S,
    origin: Vec3x8<S>,
    direction: Vec3x8<S>,
    center: Vec3x8<S>,
    radius: f32x8<S>,
) -> Surfaces<S> {
    let size = center.max_abs().max(radius);
    let (origin, direction) = (origin.widen(), direction.widen());
    let (center, radius) = (center.widen(), widen(radius));
    let t = sphere_distance(origin - center, direction, radius);
    let hit = origin + direction.scale(t);
    let normal = (hit - center).normalize();
    let point = (center + normal.scale(radius)).narrow();
    let zero = f32x8::splat(simd, 0.0);
    Surfaces {
        point,
        error: rounding_error(point, size),
        normal: normal.narrow(),
        barycentric: [zero, zero],
    }
}

/// See [`crate::kernels::sphere::intersect_f64`], of rays that start at `f` from the centre; 0 where
/// there is no hit.
#[inline(always)]
fn sphere_distance<S: Lanes>(f: DVec3x8<S>, d: DVec3x8<S>, radius: f64x8<S>) -> f64x8<S> {
    /// The greatest number that is zero in single precision: half the least above zero there.
    const ROUNDS_TO_ZERO: f64 = f32::from_bits(1) as f64 / 2.0;
    let zero = f64x8::splat(radius.token(), 0.0);
    let a = d.dot(d);
    let b = -f.dot(d);
    let nearest = f + d.scale(b / a);
    let discriminant = radius * radius - nearest.dot(nearest);
    let c = f.dot(f) - radius * radius;
    // `math::float::stable_roots`.
    let q = b + (a * discriminant).sqrt().copysign(b);
    let (t0, t1) = (c / q, q / a);
    let ordered = t0.simd_lt(t1);
    let (near, far) = (ordered.select(t0, t1), ordered.select(t1, t0));
    let far = far.simd_gt(ROUNDS_TO_ZERO).select(far, zero);
    let t = near.simd_gt(ROUNDS_TO_ZERO).select(near, far);
    let none = discriminant.simd_lt(0.0) | q.simd_eq(0.0);
    none.select(zero, t)
}

/// The normals of eight corners' values at points of `barycentric`, or `fallback` where there is
/// none: on the side of `normal` in any case.
#[inline(always)]
pub fn interpolated_normal<S: Lanes>(
    simd: S,
    values: &[[[f32; LANES]; 3]; 3],
    [y, z]: [f32x8<S>; 2],
    normal: Vec3x8<S>,
    smooth: mask32x8<S>,
) -> Vec3x8<S> {
    let x = f32x8::splat(simd, 1.0) - y - z;
    let [a, b, c] = values;
    let sum = Vec3x8::load(simd, a).scale(x)
        + Vec3x8::load(simd, b).scale(y)
        + Vec3x8::load(simd, c).scale(z);
    let unit = sum.normalize();
    let sided = (-unit).or(unit.dot(normal).simd_lt(0.0), unit);
    sided.or(smooth & unit.is_not_zero(), normal)
}
