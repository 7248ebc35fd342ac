//! Leaves, as the rays of a tile meet them.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, mask32x16, u32x16};

use super::tile::{GROUPS, WIDTH, extent, load, number_of};
use super::{Packet, TILE};
use crate::accel::arena::{Kind, Patch, Ref, View};
use crate::accel::geometry::PreparedRay;
use crate::accel::stream::{Query, Rays};
use crate::accel::{Hit, TestCounts, leaf};
use crate::kernels::triangle::T_TOLERANCE;
use crate::kernels::triangle::lanes::{ORDERS, Range, decide, edges};
use crate::math::simd::{LANES, Lanes};

impl<Q: Query, R: Rays + ?Sized> Packet<'_, Q, R> {
    /// Tests the leaf with each of `rays`.
    #[inline(always)]
    pub(super) fn visit_leaf<S: Lanes>(
        &mut self,
        simd: S,
        arena: View<'_>,
        at: Ref,
        rays: u64,
        tests: &mut TestCounts,
    ) {
        let lights = Q::ANY && !self.geometry.lights.is_empty();
        match self.tile.longest {
            Some(longest) if at.kind() == Kind::Patch && !lights => {
                let leaf = arena.patch(at);
                let count = u64::from(rays.count_ones());
                tests.leaves += count;
                tests.triangles += count * u64::from(leaf.count);
                if !self.tile.is_sheared {
                    self.tile.shear(simd, longest);
                }
                for g in 0..GROUPS {
                    let rays = (rays >> (g * WIDTH)) as u32 & 0xFFFF;
                    if rays != 0 {
                        self.visit_patch(simd, arena, leaf, ORDERS[longest.min(2)], (g, rays));
                    }
                }
            }
            _ => {
                let mut rest = rays;
                while rest != 0 {
                    let i = rest.trailing_zeros() as usize & (TILE - 1);
                    rest &= rest - 1;
                    let ray = PreparedRay::new(&self.rays.ray(self.start + number_of(i)));
                    if Q::ANY {
                        if leaf::occluded(simd, arena, self.geometry, &ray, at, tests) {
                            self.set_done(i);
                        }
                    } else {
                        let mut best = self.best(i);
                        if leaf::closest(simd, arena, self.geometry, &ray, at, &mut best, tests) {
                            self.set_best(i, best);
                        }
                    }
                }
            }
        }
        if !Q::ANY {
            self.beam.reach = extent(simd, &self.tile.reach);
        }
    }

    /// Tests the triangles of a patch, one after the other, with the rays of a group.
    #[inline(always)]
    fn visit_patch<S: Lanes>(
        &mut self,
        simd: S,
        arena: View<'_>,
        leaf: &Patch,
        [kx, ky, kz]: [usize; 3],
        (g, rays): (usize, u32),
    ) {
        let tile = &*self.tile;
        let ox = load(simd, &tile.origin[kx.min(2)], g);
        let oy = load(simd, &tile.origin[ky.min(2)], g);
        let oz = load(simd, &tile.origin[kz.min(2)], g);
        let sx = load(simd, &tile.shear[0], g);
        let sy = load(simd, &tile.shear[1], g);
        let sz = load(simd, &tile.shear[2], g);
        let mut vertices = [[[0.0_f32; WIDTH]; 3]; LANES];
        for (v, vertex) in vertices.iter_mut().enumerate().take(leaf.vertices as usize) {
            let x = f32x16::splat(simd, leaf.positions[kx.min(2)][v]) - ox;
            let y = f32x16::splat(simd, leaf.positions[ky.min(2)][v]) - oy;
            let z = f32x16::splat(simd, leaf.positions[kz.min(2)][v]) - oz;
            vertex[0] = (x - sx * z).into();
            vertex[1] = (y - sy * z).into();
            vertex[2] = (sz * z).into();
        }
        let range = Range {
            depth: load(simd, &tile.direction[kz.min(2)], g).abs(),
            t_min: load(simd, &tile.t_min, g),
            t_max: load(simd, &tile.t_max, g),
        };
        let mut rays = rays;
        for triangle in 0..leaf.count as usize & 15 {
            let a = &vertices[(leaf.corners[0] >> (4 * triangle)) as usize & 7];
            let b = &vertices[(leaf.corners[1] >> (4 * triangle)) as usize & 7];
            let c = &vertices[(leaf.corners[2] >> (4 * triangle)) as usize & 7];
            let xy: [[f32x16<S>; 2]; 3] = [
                [a[0].simd_into(simd), a[1].simd_into(simd)],
                [b[0].simd_into(simd), b[1].simd_into(simd)],
                [c[0].simd_into(simd), c[1].simd_into(simd)],
            ];
            let (edges, candidates) = edges(xy, rays);
            if candidates == 0 {
                continue;
            }
            let z: [f32x16<S>; 3] =
                [a[2].simd_into(simd), b[2].simd_into(simd), c[2].simd_into(simd)];
            let (t, certain, open) = decide(xy, z, edges, range, candidates);
            let number = arena.number(leaf.first, triangle);
            if Q::ANY {
                self.done |= u64::from(certain) << (g * WIDTH);
                rays &= !certain;
            } else if certain != 0 {
                self.offer(simd, g, t, number, certain);
            }
            let mut open = open;
            while open != 0 {
                let i = g * WIDTH + open.trailing_zeros() as usize % WIDTH;
                open &= open - 1;
                let ray = PreparedRay::new(&self.rays.ray(self.start + number_of(i)));
                let Some(t) = self.geometry.hit_again(number, &ray) else { continue };
                if Q::ANY {
                    self.set_done(i);
                } else {
                    let best = self.best(i);
                    if t < best.t || (t == best.t && number < best.primitive) {
                        self.set_best(i, Hit { t, primitive: number });
                    }
                }
            }
        }
    }

    /// Replaces the hits of those rays of `hit` that `t` is closer for.
    #[inline(always)]
    fn offer<S: Lanes>(&mut self, simd: S, g: usize, t: f32x16<S>, number: u32, hit: u32) {
        let best: f32x16<S> = self.tile.best[g].simd_into(simd);
        let primitive: u32x16<S> = self.tile.primitive[g].simd_into(simd);
        let closer = t.simd_lt(best) | (t.simd_eq(best) & primitive.simd_gt(number));
        let closer = closer & mask32x16::from_bitmask(simd, u64::from(hit));
        let reach: f32x16<S> = self.tile.reach[g].simd_into(simd);
        let new_reach = t + t.abs() * (4.0 * T_TOLERANCE);
        self.tile.best[g] = closer.select(t, best).into();
        self.tile.reach[g] = closer.select(new_reach, reach).into();
        self.tile.primitive[g] = closer.select(u32x16::splat(simd, number), primitive).into();
    }
}
