//! The same test for eight triangles at a time: the same operations in the same order, and so the
//! same bits. Triangles for which single precision does not decide are left to the test of one.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, u32x8};

use super::{ShearedSpace, T_TOLERANCE, UNDERFLOW};
use crate::math::float::gamma;
use crate::math::simd::Lanes;

/// What is known about eight triangles.
pub struct LaneHits {
    /// Where the ray meets the triangles of `certain`.
    pub t: [f32; 8],
    /// The triangles that are met within the ray's range, a bit each.
    pub certain: u32,
    /// Those that have to be asked one by one.
    pub open: u32,
}

/// The axes, by the longest, so that it is the last ([`Axis::to_last`]).
const ORDERS: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// Coordinates of a corner of eight triangles, in sheared space.
type Corner<S> = [f32x8<S>; 2];

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
        self.intersect_lanes(xy, z, edges, candidates)
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
        self.intersect_lanes(xy, [az * scale, bz * scale, cz * scale], edges, candidates)
    }

    /// As [`ShearedSpace::shear`], but z not scaled yet.
    #[inline(always)]
    fn shear_lanes<S: Lanes>(
        &self,
        simd: S,
        positions: &[[f32; 8]; 3],
    ) -> (f32x8<S>, f32x8<S>, f32x8<S>) {
        // An index and not a match: rays differ, and a branch would be foretold wrongly. The minimum
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
        [[ax, ay], [bx, by], [cx, cy]]: [Corner<S>; 3],
        [az, bz, cz]: [f32x8<S>; 3],
        edges: Edges<S>,
        candidates: u32,
    ) -> LaneHits {
        let Edges { all: [e0, e1, e2], low, high } = edges;
        let far = az.max(bz.max(cz));
        let near = az.min(bz.min(cz));
        let determinant = e0 + e1 + e2;
        let t = (e0 * az + e1 * bz + e2 * cz) / determinant;
        let bound = {
            let x = ax.abs().max(bx.abs().max(cx.abs()));
            let y = ay.abs().max(by.abs().max(cy.abs()));
            let z = near.abs().max(far.abs());
            let depth = z * self.direction[2].abs();
            let edge = ((x * gamma(2)) * y + ((x + depth) * y + (y + depth) * x) * gamma(5)) * 2.0;
            let sum = ((edge + UNDERFLOW) * 3.0) * (far - near) + UNDERFLOW;
            sum / determinant.abs() + z * gamma(8)
        };
        let inside = low.simd_gt(0.0) | high.simd_lt(0.0);
        let within = t.simd_gt(self.t_min) & t.simd_lt(self.t_max);
        let decided =
            inside & (t - self.t_max).abs().simd_gt(bound) & (t - self.t_min).abs().simd_gt(bound);
        let exact = bound.simd_le(t.abs() * T_TOLERANCE);
        let (decided, within) = (decided.to_bitmask() as u32, within.to_bitmask() as u32);
        let ahead = far.simd_ge(0.0).to_bitmask() as u32;
        let exact = exact.to_bitmask() as u32;
        let candidates = candidates & ahead;
        let t = t.max(near).min(far);
        LaneHits {
            t: t.into(),
            certain: candidates & decided & within & exact,
            open: candidates & !(decided & (!within | exact)),
        }
    }
}

/// Edge functions of eight triangles, and the least and the greatest of each.
struct Edges<S: Lanes> {
    all: [f32x8<S>; 3],
    low: f32x8<S>,
    high: f32x8<S>,
}

/// The edge functions, and the triangles that the ray is not certainly outside of. What is not a
/// number is not outside: the test of one decides.
#[inline(always)]
fn edges<S: Lanes>([[ax, ay], [bx, by], [cx, cy]]: [Corner<S>; 3], used: u32) -> (Edges<S>, u32) {
    let e0 = cx * by - cy * bx;
    let e1 = ax * cy - ay * cx;
    let e2 = bx * ay - by * ax;
    let low = e0.min(e1.min(e2));
    let high = e0.max(e1.max(e2));
    let outside = (low.simd_lt(0.0) & high.simd_gt(0.0)).to_bitmask() as u32;
    (Edges { all: [e0, e1, e2], low, high }, !outside & used)
}
