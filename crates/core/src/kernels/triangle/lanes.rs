//! The same test for eight triangles at a time: the same operations in the same order, and so the
//! same bits. Triangles for which single precision does not decide are left to the test of one.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, SimdFloat, f32x8, u32x8};

use super::{ShearedSpace, T_TOLERANCE, UNDERFLOW};
use crate::math::float::gamma;
use crate::math::simd::Lanes;

/// What is known about eight triangles.
#[derive(Clone, Copy, Debug, Default)]
pub struct LaneHits {
    /// Where the ray meets the triangles of `certain`.
    pub t: [f32; 8],
    /// The triangles that are met within the ray's range, a bit each.
    pub certain: u32,
    /// Those that have to be asked one by one.
    pub open: u32,
}

impl LaneHits {
    /// Nothing is known of the `used` ones.
    #[inline(always)]
    pub(crate) fn open(used: u32) -> Self {
        Self { open: used, ..Self::default() }
    }
}

/// The axes by the longest, so that it is the last ([`Axis::to_last`]).
pub(crate) const ORDERS: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

impl ShearedSpace {
    /// Tests up to eight triangles over eight vertices. `positions` has an axis a row; each of
    /// `corners` a vertex for each triangle, four bits each. Triangles whose bit in `used` is 0 are
    /// ignored.
    // Arrays of vectors are not mapped but written out: `map` is not inlined here, and vectors are
    // then passed through memory.
    #[inline(always)]
    pub fn intersect_patch<S: Lanes>(
        &self,
        simd: S,
        positions: &[[f32; 8]; 3],
        corners: [u32; 3],
        used: u32,
    ) -> LaneHits {
        let (x, y, z) = self.shear_lanes(simd, positions);
        let shifts: u32x8<S> = [0, 4, 8, 12, 16, 20, 24, 28].simd_into(simd);
        let a = (u32x8::splat(simd, corners[0]) >> shifts) & 7;
        let b = (u32x8::splat(simd, corners[1]) >> shifts) & 7;
        let c = (u32x8::splat(simd, corners[2]) >> shifts) & 7;
        let xy = [
            [simd.permute(x, a), simd.permute(y, a)],
            [simd.permute(x, b), simd.permute(y, b)],
            [simd.permute(x, c), simd.permute(y, c)],
        ];
        let (edges, candidates) = edges(xy, used);
        let z = z * self.shear[2];
        let z = [simd.permute(z, a), simd.permute(z, b), simd.permute(z, c)];
        self.intersect_lanes(simd, xy, z, edges, candidates)
    }

    /// Tests up to eight triangles; `corners` has a corner and an axis a row.
    #[inline(always)]
    pub fn intersect_soup<S: Lanes>(
        &self,
        simd: S,
        corners: &[[[f32; 8]; 3]; 3],
        used: u32,
    ) -> LaneHits {
        let (ax, ay, az) = self.shear_lanes(simd, &corners[0]);
        let (bx, by, bz) = self.shear_lanes(simd, &corners[1]);
        let (cx, cy, cz) = self.shear_lanes(simd, &corners[2]);
        let xy = [[ax, ay], [bx, by], [cx, cy]];
        let (edges, candidates) = edges(xy, used);
        let scale = self.shear[2];
        let z = [az * scale, bz * scale, cz * scale];
        self.intersect_lanes(simd, xy, z, edges, candidates)
    }

    /// As [`ShearedSpace::shear`], but z not scaled yet.
    #[inline(always)]
    fn shear_lanes<S: Lanes>(
        &self,
        simd: S,
        positions: &[[f32; 8]; 3],
    ) -> (f32x8<S>, f32x8<S>, f32x8<S>) {
        // An index and not a match: rays differ, and a branch would be estimated wrongly. The minimum
        // spares the check of bounds.
        let [x, y, z] = ORDERS[self.longest as usize];
        let x: f32x8<S> = positions[x.min(2)].simd_into(simd);
        let y: f32x8<S> = positions[y.min(2)].simd_into(simd);
        let z: f32x8<S> = positions[z.min(2)].simd_into(simd);
        let [ox, oy, oz] = self.origin;
        let (x, y, z) = (x - ox, y - oy, z - oz);
        (x - z * self.shear[0], y - z * self.shear[1], z)
    }

    /// What is known of the candidates.
    #[inline(always)]
    fn intersect_lanes<S: Lanes>(
        &self,
        simd: S,
        xy: [[f32x8<S>; 2]; 3],
        z: [f32x8<S>; 3],
        edges: Edges<f32x8<S>>,
        candidates: u32,
    ) -> LaneHits {
        let range = Range {
            depth: f32x8::splat(simd, self.direction[2].abs()),
            t_min: f32x8::splat(simd, self.t_min),
            t_max: f32x8::splat(simd, self.t_max),
        };
        let (t, certain, open) = decide(xy, z, edges, range, candidates);
        LaneHits { t: t.into(), certain, open }
    }
}

/// Edge functions of some pairs of ray and triangle, and the least and the greatest of each.
#[derive(Clone, Copy)]
pub(crate) struct Edges<F> {
    all: [F; 3],
    low: F,
    high: F,
}

/// Of the same pairs: by how much z in sheared space is to be scaled to be a depth, and the ranges
/// of t.
#[derive(Clone, Copy)]
pub(crate) struct Range<F> {
    pub(crate) depth: F,
    pub(crate) t_min: F,
    pub(crate) t_max: F,
}

/// The edge functions, and the pairs of `used` in which the ray is not certainly outside of the
/// triangle. What is not a number is not outside: the test of one decides. Corners are in sheared
/// space.
#[inline(always)]
pub(crate) fn edges<S: Simd, F: SimdFloat<S, Element = f32>>(
    [[ax, ay], [bx, by], [cx, cy]]: [[F; 2]; 3],
    used: u32,
) -> (Edges<F>, u32) {
    let e0 = cx * by - cy * bx;
    let e1 = ax * cy - ay * cx;
    let e2 = bx * ay - by * ax;
    let low = e0.min(e1.min(e2));
    let high = e0.max(e1.max(e2));
    let outside = (low.simd_lt(0.0) & high.simd_gt(0.0)).to_bitmask() as u32;
    (Edges { all: [e0, e1, e2], low, high }, !outside & used)
}

/// As [`ShearedSpace::intersect`] for the pairs of `candidates`: t, the pairs that certainly meet
/// there within the ray's range, and those that are left to the test of one.
#[inline(always)]
pub(crate) fn decide<S: Simd, F: SimdFloat<S, Element = f32>>(
    [[ax, ay], [bx, by], [cx, cy]]: [[F; 2]; 3],
    [az, bz, cz]: [F; 3],
    Edges { all: [e0, e1, e2], low, high }: Edges<F>,
    Range { depth, t_min, t_max }: Range<F>,
    candidates: u32,
) -> (F, u32, u32) {
    let far = az.max(bz.max(cz));
    let near = az.min(bz.min(cz));
    let determinant = e0 + e1 + e2;
    let t = (e0 * az + e1 * bz + e2 * cz) / determinant;
    let bound = {
        let x = ax.abs().max(bx.abs().max(cx.abs()));
        let y = ay.abs().max(by.abs().max(cy.abs()));
        let z = near.abs().max(far.abs());
        let depth = z * depth;
        let edge = ((x * gamma(2)) * y + ((x + depth) * y + (y + depth) * x) * gamma(5)) * 2.0;
        let sum = ((edge + UNDERFLOW) * 3.0) * (far - near) + UNDERFLOW;
        sum / determinant.abs() + z * gamma(8)
    };
    let inside = low.simd_gt(0.0) | high.simd_lt(0.0);
    let within = (t.simd_gt(t_min) & t.simd_lt(t_max)).to_bitmask() as u32;
    let decided = inside & (t - t_max).abs().simd_gt(bound) & (t - t_min).abs().simd_gt(bound);
    let decided = decided.to_bitmask() as u32;
    let exact = bound.simd_le(t.abs() * T_TOLERANCE).to_bitmask() as u32;
    // What is not a number is not behind: the test of one decides.
    let candidates = candidates & !(far.simd_lt(0.0).to_bitmask() as u32);
    let certain = candidates & decided & within & exact;
    let open = candidates & !(decided & (!within | exact));
    (t.max(near).min(far), certain, open)
}
