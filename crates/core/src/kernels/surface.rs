//! The geometry of a hit for shading: the point, a bound on its rounding error, and the normals.
//!
//! Points are computed in double precision and rounded once, so that the bound is little more than
//! half an ulp and the origins of the next rays stay as near to the surface as possible.

use glam::{DVec3, Vec3};

use super::triangle::{self, exact};
use super::{Arithmetic, disk, quad, sphere};
use crate::math::float::{error_of_offset, gamma};
use crate::math::{LANES, Line, Mask, Ray, Real, Single, Vector, set_bits};

/// The error for which fast arithmetic moves origins off surfaces by 0.0001 scene units: a fixed length, as in most
/// renderers. It is too short far from the origin, and too long in small scenes.
const FAST_ERROR: f32 = error_of_offset(1e-4);

/// A point of a surface, without its material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<F> {
    /// The point, in world space.
    pub point: Vector<F>,
    /// Bound on the distance of `point` to the exact surface, for each coordinate.
    pub error: Vector<F>,
    /// The geometric unit normal, on the side given by the winding.
    pub normal: Vector<F>,
    /// Barycentric coordinates of the second and third corner for triangles, else zero.
    pub barycentric: [F; 2],
}

impl<F: Single> SurfacePoint<F> {
    /// The surface in fast arithmetic.
    #[inline(always)]
    fn fast(point: Vector<F>, normal: Vector<F>, barycentric: [F; 2]) -> Self {
        let error = point.x.same(FAST_ERROR);
        let error = Vector::new(error, error, error);
        Self { point, error, normal: normal.normalize(), barycentric }
    }

    /// The point, computed in double precision from coordinates up to `size`, and rounded.
    #[inline(always)]
    fn rounded(
        point: Vector<F::Double>,
        size: F,
        normal: Vector<F::Double>,
        barycentric: [F; 2],
    ) -> Self {
        let point = Vector::<F>::narrow(point);
        let error = point.rounding_error(size);
        Self { point, error, normal: Vector::narrow(normal), barycentric }
    }

    /// The surface in lane `i`.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> SurfacePoint<f32> {
        SurfacePoint {
            point: self.point.lane(i).into(),
            error: self.error.lane(i).into(),
            normal: self.normal.lane(i).into(),
            barycentric: self.barycentric.map(|weight| weight.lane(i)),
        }
    }
}

impl SurfacePoint<f32> {
    /// The point, its error and the normal, as vectors of glam.
    pub fn vectors(&self) -> [Vec3; 3] {
        [self.point, self.error, self.normal].map(Vec3::from)
    }
}

/// The points at which rays meet triangles, one each: at `t`, which fast arithmetic uses unchanged.
#[inline(always)]
pub fn triangle_at<F: Single, P: Arithmetic>(
    line: &Line<F>,
    t: F,
    corners: &[Vector<F>; 3],
) -> SurfacePoint<F> {
    if !P::IS_FAST {
        return on_triangle(line, corners);
    }
    let [a, b, c] = *corners;
    // As Möller and Trumbore (*Fast, Minimum Storage Ray/Triangle Intersection*, 1997).
    let (e1, e2, s) = (b - a, c - a, line.origin - a);
    let p = line.direction.cross(e2);
    let part = t.same(1.0) / e1.dot_in_order(p);
    let u = s.dot_in_order(p) * part;
    let v = line.direction.dot_in_order(s.cross(e1)) * part;
    SurfacePoint::fast(line.at(t), e1.cross(e2), [u, v])
}

/// The points at which rays meet spheres or disks, one each, at `t`. A quadric is its centre, its
/// radius along each axis, and its front: the normal of a disk, zero for a sphere, whose normals point
/// outward.
#[inline(always)]
pub fn quadric_at<F: Single, P: Arithmetic>(
    line: &Line<F>,
    t: F,
    &[center, Vector { x: radius, .. }, front]: &[Vector<F>; 3],
) -> SurfacePoint<F> {
    let is_disk = front.is_not_zero();
    if P::IS_FAST {
        let point = line.at(t);
        let normal = Vector::select(is_disk, front, point - center);
        return SurfacePoint::fast(point, normal, [t.zero(); 2]);
    }
    let found = sphere(line, t, center, radius);
    if !is_disk.any() {
        return found;
    }
    let disk = disk(line, t, [center, front], radius);
    let select = |a, b| Vector::select(is_disk, a, b);
    SurfacePoint {
        point: select(disk.point, found.point),
        error: select(disk.error, found.error),
        normal: select(disk.normal, found.normal),
        ..found
    }
}

#[inline(always)]
fn on_triangle<F: Single>(line: &Line<F>, corners: &[Vector<F>; 3]) -> SurfacePoint<F> {
    let [a, b, c] = *corners;
    let size = a.max_abs().max(b.max_abs()).max(c.max_abs());
    let [wa, wb, wc] = weights(line, corners, size);
    let (a, b, c) = (a.widen(), b.widen(), c.widen());
    let point = a.scale(wa) + b.scale(wb) + c.scale(wc);
    let normal = (b - a).cross(c - a).normalize_wide();
    SurfacePoint::rounded(point, size, normal, [F::narrow(wb), F::narrow(wc)])
}

/// Barycentric coordinates of the points at which rays meet triangles, none negative, with sum one.
/// Corners have coordinates up to `size`.
///
/// If double precision does not place the point inside, and as near to the ray as single precision
/// could, exact arithmetic does.
#[inline(always)]
fn weights<F: Single>(line: &Line<F>, corners: &[Vector<F>; 3], size: F) -> [F::Double; 3] {
    let space = Sheared::new(line);
    let [(ax, ay), (bx, by), (cx, cy)] =
        [space.shear(corners[0]), space.shear(corners[1]), space.shear(corners[2])];
    let e0 = cx * by - cy * bx;
    let e1 = ax * cy - ay * cx;
    let e2 = bx * ay - by * ax;
    let sum = e0 + e1 + e2;
    let part = sum.same(1.0) / sum;
    let (mut wa, mut wb, mut wc) = (e0 * part, e1 * part, e2 * part);
    let zero = sum.zero();
    // Also false if the sum is zero and the quotients are NaN.
    let inside = wa.ge(zero) & wb.ge(zero) & wc.ge(zero) & sum.ne(zero);
    let sideways = (size.widen() + line.origin.max_abs().widen()).times(SIDEWAYS);
    let sideways = sideways * space.direction.z.abs();
    let (x, y) = (ax * wa + bx * wb + cx * wc, ay * wa + by * wb + cy * wc);
    let beside = x.abs().le(sideways) & y.abs().le(sideways);
    for lane in set_bits::<LANES>(!(inside & beside).bits() & (u32::MAX >> (32 - F::LANES))) {
        let corners = corners.map(|corner| corner.lane(lane));
        let [x, y, z] = weights_of_one(line.origin.lane(lane), line.direction.lane(lane), &corners);
        wa.set_lane(lane, x);
        wb.set_lane(lane, y);
        wc.set_lane(lane, z);
    }
    [wa, wb, wc]
}

/// How far beside the ray a point may be, as a factor of the coordinates.
const SIDEWAYS: f64 = gamma(10) as f64;

#[cold]
#[inline(never)]
fn weights_of_one(origin: Vec3, direction: Vec3, corners: &[Vec3; 3]) -> [f64; 3] {
    let ray = Ray::new(origin, direction);
    let weights = if ray.is_valid() { exact::barycentric(&ray, corners) } else { None };
    weights.unwrap_or(DVec3::splat(1.0 / 3.0)).to_array()
}

/// The space of a ray in which it starts at 0 and runs along z, in double precision. Its x and y
/// are scaled by z of the direction, which saves divisions.
struct Sheared<F: Single> {
    along_x: F::Mask,
    along_y: F::Mask,
    /// Permuted so that the longest axis is last, like the following.
    origin: Vector<F::Double>,
    direction: Vector<F::Double>,
}

impl<F: Single> Sheared<F> {
    #[inline(always)]
    fn new(line: &Line<F>) -> Self {
        let Vector { x, y, z } = line.direction.abs();
        let along_x = x.ge(y) & x.ge(z);
        let along_y = !along_x & y.ge(z);
        let turn = |v| turn(along_x, along_y, v);
        let (origin, direction) = (turn(line.origin).widen(), turn(line.direction).widen());
        Self { along_x, along_y, origin, direction }
    }

    /// x and y of a corner of each lane's triangle.
    #[inline(always)]
    fn shear(&self, corner: Vector<F>) -> (F::Double, F::Double) {
        let v = turn(self.along_x, self.along_y, corner).widen() - self.origin;
        let d = self.direction;
        (v.x * d.z - d.x * v.z, v.y * d.z - d.y * v.z)
    }
}

/// The coordinates permuted so that the longest axis is last.
#[inline(always)]
fn turn<F: Real>(along_x: F::Mask, along_y: F::Mask, v: Vector<F>) -> Vector<F> {
    Vector::new(
        F::select(along_x, v.y, F::select(along_y, v.z, v.x)),
        F::select(along_x, v.z, F::select(along_y, v.x, v.y)),
        F::select(along_x, v.x, F::select(along_y, v.y, v.z)),
    )
}

#[inline(always)]
fn sphere<F: Single>(line: &Line<F>, t: F, center: Vector<F>, radius: F) -> SurfacePoint<F> {
    let t = sphere::near(line, t, center, radius);
    let wide = center.widen();
    let hit = line.origin.widen() + line.direction.widen().scale(t);
    let normal = (hit - wide).normalize_wide();
    let point = wide + normal.scale(radius.widen());
    SurfacePoint::rounded(point, center.max_abs().max(radius), normal, [radius.zero(); 2])
}

#[inline(always)]
fn disk<F: Single>(
    line: &Line<F>,
    t: F,
    [center, front]: [Vector<F>; 2],
    radius: F,
) -> SurfacePoint<F> {
    let point = center.widen() + disk::offset(line, t, center, front);
    let (size, normal) = (center.max_abs().max(radius), front.widen().normalize_wide());
    SurfacePoint::rounded(point, size, normal, [radius.zero(); 2])
}

/// The halves of quads that lines meet at the values of t, in the lanes of `asked`, or at the next ones; of
/// halves met at the same t, the first. These lines must hit their quads.
#[inline(always)]
pub fn quad_halves<F: Single>(
    line: &Line<F>,
    t: F,
    corners: &[Vector<F>; 4],
    asked: u32,
) -> [Vector<F>; 3] {
    let [a, b, c, d] = *corners;
    let [first, second] = quad::missed_halves(line, corners);
    let (first, second) = (first.bits(), second.bits());
    let is_second = F::mask(a.x.token(), first & !second);
    let (mut next, mut last) = (Vector::select(is_second, c, b), Vector::select(is_second, d, c));
    for lane in set_bits::<LANES>(asked & !(first | second)) {
        let corners = [a.lane(lane), b.lane(lane), c.lane(lane), d.lane(lane)];
        let [_, b, c] = nearer_half(&line.ray(lane), t.lane(lane), quad::halves(&corners));
        next.set_lane(lane, b);
        last.set_lane(lane, c);
    }
    [a, next, last]
}

/// As [`quad_halves`], of one quad.
#[cold]
#[inline(never)]
fn nearer_half(ray: &Ray, t: f32, [first, second]: [[Vec3; 3]; 2]) -> [Vec3; 3] {
    match (triangle::meet(ray, &first), triangle::meet(ray, &second)) {
        (Some(a), Some(b)) if (b - t).abs() < (a - t).abs() => second,
        (None, Some(_)) => second,
        _ => first,
    }
}

/// Normals interpolated between three corners at `barycentric`, of unit length and on the side of
/// `normal`; `normal` itself in lanes that are not `smooth`, or if the corners' normals cancel out.
#[inline(always)]
pub fn interpolated_normal<F: Single>(
    corners: &[Vector<F>; 3],
    [y, z]: [F; 2],
    normal: Vector<F>,
    smooth: F::Mask,
) -> Vector<F> {
    let unit = interpolated(corners, [y, z]).normalize();
    let behind = unit.dot(normal).lt(y.zero());
    let sided = Vector::select(behind, -unit, unit);
    Vector::select(smooth & unit.is_not_zero(), sided, normal)
}

/// Values interpolated between the corners of a triangle, at the barycentric coordinates of the
/// second and third.
#[inline(always)]
pub fn interpolated<F: Single>(corners: &[Vector<F>; 3], [y, z]: [F; 2]) -> Vector<F> {
    let x = y.same(1.0) - y - z;
    let [a, b, c] = corners;
    a.scale(x) + b.scale(y) + c.scale(z)
}
