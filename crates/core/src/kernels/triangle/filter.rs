//! The filter of one ray against eight triangles, in single precision: the watertight test of Woop,
//! Benthin and Wald (*Watertight Ray/Triangle Intersection*, JCGT 2013), with bounds.
//!
//! The vertices are sheared into a space in which the ray starts at 0 and runs along z. Three edge
//! functions in the xy plane tell on which side of each edge the ray passes, and t is the average
//! of the vertices' z, weighted by them.
//!
//! # The bounds
//!
//! With u the unit roundoff, M the largest |x| and |y| of the sheared vertices, and D the largest
//! distance to the origin along z, a sheared x is off by at most 4 u (M + D), and an edge function
//! by E = 2 u 2 M^2 + 4 M 4 u (M + D) <= 22 u M (M + D). A ray whose edge functions exceed E with
//! one sign certainly passes through; one with two that exceed it with opposite signs certainly
//! misses. So the answer does not depend on fused operations, or on the order of corners.
//!
//! Weights that sum to one move the average by at most half the span of z times the sum of their
//! changes, which is at most 6 E / |det|. The other roundings add 12 u D. For rays that may pass
//! just outside, weights sum in magnitude to at most 1 + 6 E / |det|. So with s the extent of the
//! vertices, t is off by at most ((3 s + 72 u D) E / |det| + 12 u D) / |d_z|.
//!
//! All vertices of a leaf lie within its stored extent of the first one. So M and D follow from
//! that vertex and the extent, and one E rejects most triangles of the leaf; those left get an E of
//! their own. Underflow adds less than the least normal number to E, to the numerator of t, and to t.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, u32x8};
use glam::{Vec3, Vec3A};

use super::UNDERFLOW;
use super::settle::{self, Settled};
use crate::kernels::Arithmetic;
use crate::math::float::{UNIT_ROUNDOFF, max};
use crate::math::{Lanes, Line, Mask, Ray, Real, Single, Vector};

/// The triangles of a leaf that a ray meets, or may meet.
#[derive(Clone, Copy, Debug, Default, bytemuck::Zeroable)]
pub struct LaneHits {
    /// Bounds on t of the triangles in `certain`.
    pub low: [f32; 8],
    /// See `low`.
    pub high: [f32; 8],
    /// Triangles certainly met within the ray's range, a bit each.
    pub certain: u32,
    /// Triangles that are not decided.
    pub open: u32,
}

/// The permutation of axes for each longest axis, which becomes last, and a fourth number, unused.
pub(crate) const ORDERS: [[u8; 4]; 3] = [[1, 2, 0, 0], [2, 0, 1, 0], [0, 1, 2, 0]];

/// The axis along which `direction` is longest, the first of equals. Without a branch, which rays
/// of different directions would mispredict.
#[inline(always)]
fn longest(direction: Vec3A) -> usize {
    let size = direction.abs();
    let longest = size.cmpeq(Vec3A::splat(size.max_element())).bitmask();
    longest.trailing_zeros().min(2) as usize
}

/// The space of a ray in which the ray starts at 0 and runs along z. Its z is along the longest
/// axis of the direction.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShearedSpace {
    /// The axes, the longest last.
    order: [u8; 4],
    /// The shear of x and y along the direction, and the reciprocal of its z.
    shear: [f32; 3],
}

impl ShearedSpace {
    /// The space of `ray`.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let order = ORDERS[longest(Vec3A::from(ray.direction))];
        let [_, direction] = halves(ray);
        let [x, y, z] = [0, 1, 2].map(|k: usize| direction[axis(order[k])]);
        let shear = Vec3A::new(x, y, 1.0) / Vec3A::splat(z);
        Self { order, shear: shear.to_array() }
    }

    /// x and y of the vertices in `rows`, an axis each from the `first` on, in the space of `ray`, and their
    /// distance along its z.
    #[inline(always)]
    fn shear<S: Lanes, const ROWS: usize>(
        &self,
        simd: S,
        ray: &Ray,
        rows: &[[f32; 8]; ROWS],
        first: usize,
    ) -> [f32x8<S>; 3] {
        let [origin, _] = halves(ray);
        let from_origin = |k: usize| {
            let axis = axis(self.order[k]);
            let row: f32x8<S> = rows[first + axis].simd_into(simd);
            row - origin[axis]
        };
        let (x, y, z) = (from_origin(0), from_origin(1), from_origin(2));
        let along = |k: usize| <f32x8<S> as Single>::splat(simd, -self.shear[k]);
        [z.mul_add(along(0), x), z.mul_add(along(1), y), z]
    }
}

/// Origin and direction of a ray, with an end of its range each, for axes without a check.
#[inline(always)]
fn halves(ray: &Ray) -> &[[f32; 4]; 2] {
    bytemuck::cast_ref(ray)
}

/// An axis of [`ORDERS`] as an index: instead of a match, which rays of different directions would
/// mispredict, and without a check.
#[inline(always)]
fn axis(axis: u8) -> usize {
    usize::from(axis & 3)
}

/// The unit roundoff.
const U: f32 = UNIT_ROUNDOFF;

/// Bound on the error of edge functions of vertices within `extent` of `first`, in the ray's space.
#[inline(always)]
fn edge_error([x, y, z]: [f32; 3], extent: f32) -> f32 {
    let depth = z.abs() + extent;
    // With the error of the first vertex itself.
    let aside = max(x.abs(), y.abs()) + 2.001 * extent + 16.0 * U * depth;
    // The product first: if it overflows, so may those of the edge functions.
    22.0 * U * (aside * (aside + depth)) + UNDERFLOW
}

/// The `used` ones, a bit each, of up to eight triangles over eight vertices, for a ray with this
/// `space` and the t beyond which hits do not matter. Each row of `positions` but the last, which is not
/// used, is an axis; each of `corners` packs the vertices of the triangles, four bits each; all vertices
/// lie within `extent` of the first.
// Arrays of vectors are written out instead of mapped: `map` is not inlined here, and passes
// vectors through memory.
#[inline(always)]
pub fn patch<S: Lanes, P: Arithmetic>(
    simd: S,
    (ray, space, reach): (&Ray, &ShearedSpace, f32),
    (positions, corners, extent): (&[[f32; 8]; 4], [u32; 3], f32),
    used: u32,
) -> LaneHits {
    let [x, y, z] = space.shear(simd, ray, positions, 0);
    let error = edge_error([x[0], y[0], z[0]], extent);
    let [a, b, c] = lanes_of(simd, corners);
    let x = [simd.permute(x, a), simd.permute(x, b), simd.permute(x, c)];
    let y = [simd.permute(y, a), simd.permute(y, b), simd.permute(y, c)];
    meet::<S, P>(
        simd,
        space,
        ([ray.t_min, ray.t_max, reach], error),
        (&x, &y),
        #[inline(always)]
        || [simd.permute(z, a), simd.permute(z, b), simd.permute(z, c)],
        used,
    )
}

/// As [`patch`], for triangles without shared vertices: the first nine rows of `corners` are an axis of a
/// corner each.
#[inline(always)]
pub fn soup<S: Lanes, P: Arithmetic>(
    simd: S,
    (ray, space, reach): (&Ray, &ShearedSpace, f32),
    (corners, extent): (&[[f32; 8]; 12], f32),
    used: u32,
) -> LaneHits {
    let [ax, ay, az] = space.shear(simd, ray, corners, 0);
    let [bx, by, bz] = space.shear(simd, ray, corners, 3);
    let [cx, cy, cz] = space.shear(simd, ray, corners, 6);
    let error = edge_error([ax[0], ay[0], az[0]], extent);
    meet::<S, P>(
        simd,
        space,
        ([ray.t_min, ray.t_max, reach], error),
        (&[ax, bx, cx], &[ay, by, cy]),
        #[inline(always)]
        || [az, bz, cz],
        used,
    )
}

/// The vertex of each lane's triangle, for each corner.
#[inline(always)]
pub(crate) fn lanes_of<S: Lanes>(simd: S, [a, b, c]: [u32; 3]) -> [u32x8<S>; 3] {
    let shifts: u32x8<S> = [0, 4, 8, 12, 16, 20, 24, 28].simd_into(simd);
    let lanes = |corner: u32| (u32x8::splat(simd, corner) >> shifts) & 7;
    [lanes(a), lanes(b), lanes(c)]
}

/// Decides on triangles whose corners have these sheared x and y; `depths` gives their z.
#[inline(always)]
fn meet<S: Lanes, P: Arithmetic>(
    simd: S,
    space: &ShearedSpace,
    ([t_min, t_max, reach], error): ([f32; 3], f32),
    ([ax, bx, cx], [ay, by, cy]): (&[f32x8<S>; 3], &[f32x8<S>; 3]),
    depths: impl FnOnce() -> [f32x8<S>; 3],
    used: u32,
) -> LaneHits {
    let all = |value: f32| <f32x8<S> as Single>::splat(simd, value);
    let a = cx.mul_sub(*by, *cy * *bx);
    let b = ax.mul_sub(*cy, *ay * *cx);
    let c = bx.mul_sub(*ay, *by * *ax);
    let (least, most) = (least_of(a, b, c), most_of(a, b, c));
    let edge = all(if P::IS_FAST { 0.0 } else { error });
    let candidates = used & !(least.simd_lt(-edge) & most.simd_gt(edge)).bits();
    if candidates == 0 {
        return LaneHits::default();
    }
    let [az, bz, cz] = depths();
    let part = all(1.0) / (a + b + c);
    let scale = space.shear[2];
    let t = a.mul_add(az, b.mul_add(bz, c * cz)) * part * scale;
    if P::IS_FAST {
        let within = t.simd_gt(t_min) & t.simd_lt(t_max) & t.simd_le(reach);
        let t = t.into();
        return LaneHits { low: t, high: t, certain: candidates & within.bits(), open: 0 };
    }
    let (near, far) = (least_of(az, bz, cz), most_of(az, bz, cz));
    let depth = Real::max(SimdBase::abs(near), SimdBase::abs(far));
    let aside = Real::max(size_of(*ax, *bx, *cx), size_of(*ay, *by, *cy));
    let aside = depth.mul_add(all(16.0 * U), aside);
    let edge = (aside * (aside + depth)).mul_add(all(22.0 * U), all(UNDERFLOW));
    let weight = depth.mul_add(all(72.0 * U), (far - near) * 3.1).mul_add(edge, all(UNDERFLOW));
    let error = SimdBase::abs(part).mul_add(weight, depth * (12.0 * U));
    let error = error.mul_add(all(scale.abs()), all(UNDERFLOW));
    let (low, high) = (t - error, t + error);
    let candidates = candidates & !(least.simd_lt(-edge) & most.simd_gt(edge)).bits();
    // A NaN is neither certain nor beyond, nor is a t that overflows.
    let finite = SimdBase::abs(t).simd_le(f32::MAX);
    let inside = least.simd_gt(edge) | most.simd_lt(-edge);
    let within = low.simd_gt(t_min) & high.simd_lt(t_max);
    let beyond = (high.simd_le(t_min) | low.simd_gt(reach)) & finite;
    let candidates = candidates & !beyond.bits();
    let certain = candidates & (inside & within).bits();
    LaneHits { low: low.into(), high: high.into(), certain, open: candidates & !certain }
}

#[inline(always)]
fn least_of<F: Real>(a: F, b: F, c: F) -> F {
    a.min(b).min(c)
}

#[inline(always)]
fn most_of<F: Real>(a: F, b: F, c: F) -> F {
    a.max(b).max(c)
}

/// The largest magnitude.
#[inline(always)]
fn size_of<F: Real>(a: F, b: F, c: F) -> F {
    most_of(a.abs(), b.abs(), c.abs())
}

impl LaneHits {
    /// Decides the open triangles in double precision, all at once. What is left open needs exact
    /// arithmetic. `corners` are those of all triangles.
    #[inline(always)]
    pub(crate) fn settle<S: Lanes>(&mut self, simd: S, ray: &Ray, corners: &[Vector<f32x8<S>>; 3]) {
        let splat = |v: Vec3| Vector::<f32x8<S>>::splat(simd, v);
        let line = Line { origin: splat(ray.origin), direction: splat(ray.direction) };
        let range = [ray.t_min, ray.t_max].map(|end| <f32x8<S> as Single>::splat(simd, end));
        let Settled { t, hit, miss } = settle::settle(&line, corners, range);
        let hit = hit & self.open;
        let is_hit = <f32x8<S> as Single>::mask(simd, hit);
        let (low, high): (f32x8<S>, f32x8<S>) =
            (self.low.simd_into(simd), self.high.simd_into(simd));
        self.low = Real::select(is_hit, t, low).into();
        self.high = Real::select(is_hit, t, high).into();
        self.certain |= hit;
        self.open &= !(hit | miss);
    }
}
