//! Gathers sixteen of a tile's rays for a leaf.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, u32x16};

use super::{GROUPS, Tile, WIDTH, load};
use crate::kernels::triangle::RayRange;
use crate::math::simd::Lanes;

/// Sixteen rays at a leaf.
pub(in crate::accel::packet) struct RayGroup<S: Lanes> {
    /// Permuted, with the longest axis last.
    pub(in crate::accel::packet) origin: [f32x16<S>; 3],
    pub(in crate::accel::packet) shear: [f32x16<S>; 3],
    pub(in crate::accel::packet) range: RayRange<f32x16<S>>,
    pub(in crate::accel::packet) best: f32x16<S>,
    pub(in crate::accel::packet) primitive: u32x16<S>,
}

impl Tile {
    /// The rays at `positions`, with the axes in `order`; without origins if all have `ONE`.
    #[inline(always)]
    pub(in crate::accel::packet) fn pick<S: Lanes, const ONE: bool>(
        &self,
        simd: S,
        [kx, ky, kz]: [usize; 3],
        positions: [u32; WIDTH],
    ) -> RayGroup<S> {
        let primitive = simd.pick(bytemuck::cast_ref(&self.primitive), positions);
        let none = f32x16::splat(simd, 0.0);
        RayGroup {
            origin: if ONE {
                [none, none, none]
            } else {
                [
                    simd.pick(&self.origin[kx.min(2)], positions),
                    simd.pick(&self.origin[ky.min(2)], positions),
                    simd.pick(&self.origin[kz.min(2)], positions),
                ]
            },
            shear: [
                simd.pick(&self.shear[0], positions),
                simd.pick(&self.shear[1], positions),
                simd.pick(&self.shear[2], positions),
            ],
            range: RayRange {
                depth: simd.pick(&self.direction[kz.min(2)], positions).abs(),
                t_min: simd.pick(&self.t_min, positions),
                t_max: simd.pick(&self.t_max, positions),
            },
            best: simd.pick(&self.best, positions),
            primitive: primitive.bitcast(),
        }
    }

    /// The rays of the `g`th group, with the axes in `order`.
    #[inline(always)]
    pub(in crate::accel::packet) fn whole<S: Lanes>(
        &self,
        simd: S,
        [kx, ky, kz]: [usize; 3],
        g: usize,
    ) -> RayGroup<S> {
        let g = g % GROUPS;
        RayGroup {
            origin: [
                load(simd, &self.origin[kx.min(2)], g),
                load(simd, &self.origin[ky.min(2)], g),
                load(simd, &self.origin[kz.min(2)], g),
            ],
            shear: [
                load(simd, &self.shear[0], g),
                load(simd, &self.shear[1], g),
                load(simd, &self.shear[2], g),
            ],
            range: RayRange {
                depth: load(simd, &self.direction[kz.min(2)], g).abs(),
                t_min: load(simd, &self.t_min, g),
                t_max: load(simd, &self.t_max, g),
            },
            best: load(simd, &self.best, g),
            primitive: self.primitive[g].simd_into(simd),
        }
    }
}
