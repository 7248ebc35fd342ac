//! One ray and the eight triangles of a leaf. Triangles that single precision does not decide are
//! left to the single test.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, u32x8};

use super::plane::Plane;
use super::{Decision, Edges, RayRange, Sheared, ShearedSpace, decide};
use crate::math::real::{Mask, Real, Single};
use crate::math::simd::{Lanes, outlined};
use crate::math::vector::{Line, Vector};

/// The results for eight triangles.
#[derive(Clone, Copy, Debug, Default)]
pub struct LaneHits {
    /// t of the triangles in `certain`.
    pub t: [f32; 8],
    /// Triangles certainly met within the ray's range, a bit each.
    pub certain: u32,
    /// Triangles that need the single test.
    pub open: u32,
}

impl LaneHits {
    /// All `used` triangles undecided.
    #[inline(always)]
    pub(crate) fn open(used: u32) -> Self {
        Self { open: used, ..Self::default() }
    }
}

/// The permutation of axes for each longest axis, which becomes last
/// ([`Axis::to_last`](super::Axis::to_last)).
pub(crate) const ORDERS: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

impl ShearedSpace {
    /// Tests up to eight triangles over eight vertices. Each row of `positions` is an axis; each of
    /// `corners` packs the vertices of the triangles, four bits each. Triangles whose bit in `used`
    /// is 0 are ignored. If `any` hit suffices, t is unspecified.
    // Arrays of vectors are written out instead of mapped: `map` is not inlined here, and passes
    // vectors through memory.
    #[inline(always)]
    pub fn intersect_patch<S: Lanes>(
        &self,
        simd: S,
        positions: &[[f32; 8]; 3],
        corners: [u32; 3],
        (used, any): (u32, bool),
    ) -> LaneHits {
        let (x, y, z) = self.shear_lanes(simd, positions);
        let [a, b, c] = lanes_of(simd, corners);
        let xy = [
            [simd.permute(x, a), simd.permute(y, a)],
            [simd.permute(x, b), simd.permute(y, b)],
            [simd.permute(x, c), simd.permute(y, c)],
        ];
        let z = z * self.shear[2];
        let z = [simd.permute(z, a), simd.permute(z, b), simd.permute(z, c)];
        self.intersect_lanes(
            simd,
            &Sheared { xy, z },
            (used, any),
            #[inline(always)]
            || {
                let [a, b, c] = lanes_of(simd, corners);
                let [x, y, z] = positions.map(|row| row.simd_into(simd));
                let corner = |at: u32x8<S>| {
                    let at = |axis: f32x8<S>| simd.permute(axis, at);
                    Vector::new(at(x), at(y), at(z))
                };
                [corner(a), corner(b), corner(c)]
            },
        )
    }

    /// Tests up to eight triangles; each row of `corners` is an axis of a corner.
    #[inline(always)]
    pub fn intersect_soup<S: Lanes>(
        &self,
        simd: S,
        corners: &[[[f32; 8]; 3]; 3],
        (used, any): (u32, bool),
    ) -> LaneHits {
        let (ax, ay, az) = self.shear_lanes(simd, &corners[0]);
        let (bx, by, bz) = self.shear_lanes(simd, &corners[1]);
        let (cx, cy, cz) = self.shear_lanes(simd, &corners[2]);
        let xy = [[ax, ay], [bx, by], [cx, cy]];
        let scale = self.shear[2];
        let z = [az * scale, bz * scale, cz * scale];
        self.intersect_lanes(
            simd,
            &Sheared { xy, z },
            (used, any),
            #[inline(always)]
            || {
                corners.map(|corner| {
                    let [x, y, z] = corner.map(|row| row.simd_into(simd));
                    Vector::new(x, y, z)
                })
            },
        )
    }

    /// As [`ShearedSpace::shear`], without the scaling of z.
    #[inline(always)]
    fn shear_lanes<S: Lanes>(
        &self,
        simd: S,
        positions: &[[f32; 8]; 3],
    ) -> (f32x8<S>, f32x8<S>, f32x8<S>) {
        // An index instead of a match, which rays of different directions would mispredict. The
        // minimum avoids the bounds check.
        let [x, y, z] = ORDERS[self.longest as usize];
        let x: f32x8<S> = positions[x.min(2)].simd_into(simd);
        let y: f32x8<S> = positions[y.min(2)].simd_into(simd);
        let z: f32x8<S> = positions[z.min(2)].simd_into(simd);
        let [ox, oy, oz] = self.origin;
        let (x, y, z) = (x - ox, y - oy, z - oz);
        (x - z * self.shear[0], y - z * self.shear[1], z)
    }

    /// The results for the `used` triangles; `corners` is called only if double precision has to
    /// settle some.
    #[inline(always)]
    fn intersect_lanes<S: Lanes>(
        &self,
        simd: S,
        sheared: &Sheared<f32x8<S>>,
        (used, any): (u32, bool),
        corners: impl FnOnce() -> [Vector<f32x8<S>>; 3],
    ) -> LaneHits {
        let range = self.range_of_lanes(simd);
        let edges = Edges::new(&sheared.xy);
        let candidates = used & !edges.outside().bits();
        if candidates == 0 {
            return LaneHits::default();
        }
        let Decision { t, certain, open, inside } =
            decide(sheared, &edges, &range, (candidates, any));
        let mut hits = LaneHits { t: t.into(), certain, open };
        let settleable = open & inside.bits();
        if settleable != 0 {
            outlined(
                simd,
                #[inline(always)]
                || self.settle_lanes(simd, &corners(), settleable, &mut hits),
            );
        }
        hits
    }

    /// Settles in double precision the t of the `open` triangles with these corners, a bit each.
    /// The ray passes through all of them.
    #[inline(always)]
    fn settle_lanes<S: Lanes>(
        &self,
        simd: S,
        [a, b, c]: &[Vector<f32x8<S>>; 3],
        open: u32,
        hits: &mut LaneHits,
    ) {
        let splat = |v: Vector<f32>| Vector::new(a.x.same(v.x), a.x.same(v.y), a.x.same(v.z));
        let line = Line { origin: splat(self.origin()), direction: splat(self.direction()) };
        let plane = Plane::of(&[a.widen(), b.widen(), c.widen()]);
        let settled = plane.settle(&line, &self.range_of_lanes(simd));
        let (hit, miss) = (open & settled.hit.bits(), open & settled.miss.bits());
        let t: f32x8<S> = hits.t.simd_into(simd);
        hits.t = <f32x8<S> as Single>::mask(simd, hit).select(settled.t, t).into();
        hits.certain |= hit;
        hits.open &= !(hit | miss);
    }

    #[inline(always)]
    fn range_of_lanes<S: Lanes>(&self, simd: S) -> RayRange<f32x8<S>> {
        let splat = |value| <f32x8<S> as Single>::splat(simd, value);
        let depth = splat(self.direction[2].abs());
        RayRange { depth, t_min: splat(self.t_min), t_max: splat(self.t_max) }
    }
}

/// The vertex of each lane's triangle, for each corner.
#[inline(always)]
fn lanes_of<S: Lanes>(simd: S, [a, b, c]: [u32; 3]) -> [u32x8<S>; 3] {
    let shifts: u32x8<S> = [0, 4, 8, 12, 16, 20, 24, 28].simd_into(simd);
    let lanes = |corner: u32| (u32x8::splat(simd, corner) >> shifts) & 7;
    [lanes(a), lanes(b), lanes(c)]
}
