//! One ray and the eight triangles of a leaf. Triangles for which single precision does not decide are left to the
//! test of one.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, u32x8};

use super::{Decision, Edges, RayRange, Sheared, ShearedSpace, decide};
use crate::math::real::Mask;
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

/// The axes by the longest, so that it is the last ([`Axis::to_last`](super::Axis::to_last)).
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
        let z = z * self.shear[2];
        let z = [simd.permute(z, a), simd.permute(z, b), simd.permute(z, c)];
        self.intersect_lanes(simd, &Sheared { xy, z }, used)
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
        let scale = self.shear[2];
        let z = [az * scale, bz * scale, cz * scale];
        self.intersect_lanes(simd, &Sheared { xy, z }, used)
    }

    /// As [`ShearedSpace::shear`], but z not scaled yet.
    #[inline(always)]
    fn shear_lanes<S: Lanes>(
        &self,
        simd: S,
        positions: &[[f32; 8]; 3],
    ) -> (f32x8<S>, f32x8<S>, f32x8<S>) {
        // An index and not a match: rays differ, and a branch would be predicted wrongly. The minimum
        // spares the check of bounds.
        let [x, y, z] = ORDERS[self.longest as usize];
        let x: f32x8<S> = positions[x.min(2)].simd_into(simd);
        let y: f32x8<S> = positions[y.min(2)].simd_into(simd);
        let z: f32x8<S> = positions[z.min(2)].simd_into(simd);
        let [ox, oy, oz] = self.origin;
        let (x, y, z) = (x - ox, y - oy, z - oz);
        (x - z * self.shear[0], y - z * self.shear[1], z)
    }

    /// What is known of the `used` ones.
    #[inline(always)]
    fn intersect_lanes<S: Lanes>(
        &self,
        simd: S,
        sheared: &Sheared<f32x8<S>>,
        used: u32,
    ) -> LaneHits {
        let range = RayRange {
            depth: f32x8::splat(simd, self.direction[2].abs()),
            t_min: f32x8::splat(simd, self.t_min),
            t_max: f32x8::splat(simd, self.t_max),
        };
        let edges = Edges::new(&sheared.xy);
        let Decision { t, certain, open, .. } =
            decide(sheared, &edges, &range, used & !edges.outside().bits());
        LaneHits { t: t.into(), certain, open }
    }
}
