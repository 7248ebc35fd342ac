//! Decides in double precision, eight rays at a time, where rays meet a triangle that single
//! precision leaves open.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f64x8};

use super::{PatchRays, Row, row};
use crate::accel::arena::Patch;
use crate::accel::packet::tile::{Column, Tile, WIDTH};
use crate::kernels::triangle::RayRange;
use crate::kernels::triangle::plane::Plane;
use crate::math::real::{Mask, Single};
use crate::math::simd::{LANES, Lanes, outlined};
use crate::math::vector::{Line, Vector};

/// The results of double precision for a group of rays and a triangle.
pub(super) struct Settled {
    pub(super) t: Row,
    /// The rays that meet it at t, and those that are decided, a bit each.
    pub(super) hit: u32,
    pub(super) decided: u32,
}

/// Decides in double precision where the `open` rays, a bit each, meet a triangle that they pass
/// through.
#[inline(always)]
pub(super) fn settle<S: Lanes>(
    simd: S,
    leaf: &Patch,
    tile: &Tile,
    group: &PatchRays,
    (triangle, open): (u8, u32),
) -> Settled {
    let mut settled = Settled { t: [0.0; WIDTH], hit: 0, decided: 0 };
    outlined(
        simd,
        #[inline(always)]
        || {
            let [a, b, c] = leaf.corners.map(|corner| {
                let v = (corner >> (u32::from(4 * triangle) % u32::BITS)) as usize % LANES;
                let [x, y, z] = leaf.positions.map(|axis| f64::from(axis[v]));
                Vector::new(x, y, z)
            });
            let plane = Plane::of(&[a, b, c]).splat(f64x8::splat(simd, 0.0));
            let g = group.positions[0] as usize / WIDTH;
            let origin = rows(simd, &tile.origin, group, g);
            let direction = rows(simd, &tile.direction, group, g);
            for half in 0..WIDTH / LANES {
                let at = half * LANES;
                let open = open >> at & 0xFF;
                if open == 0 {
                    continue;
                }
                let line = Line {
                    origin: vector(simd, &origin, at),
                    direction: vector(simd, &direction, at),
                };
                let range = RayRange {
                    depth: eight(simd, &group.depth, at),
                    t_min: eight(simd, &group.t_min, at),
                    t_max: eight(simd, &group.t_max, at),
                };
                let known = plane.settle(&line, &range);
                known.t.store(&mut settled.t[at..]);
                let hit = open & known.hit.bits();
                settled.hit |= hit << at;
                settled.decided |= (hit | open & known.miss.bits()) << at;
            }
        },
    );
    settled
}

// Functions instead of closures, which are not inlined here and then lack the level's
// instructions.

#[inline(always)]
fn rows<S: Lanes>(simd: S, [x, y, z]: &[Column; 3], group: &PatchRays, g: usize) -> [Row; 3] {
    [row(simd, x, group, g), row(simd, y, group, g), row(simd, z, group, g)]
}

#[inline(always)]
fn vector<S: Lanes>(simd: S, [x, y, z]: &[Row; 3], at: usize) -> Vector<f32x8<S>> {
    Vector::new(eight(simd, x, at), eight(simd, y, at), eight(simd, z, at))
}

/// The eight numbers of a row from `at` on.
#[inline(always)]
fn eight<S: Lanes>(simd: S, row: &Row, at: usize) -> f32x8<S> {
    <f32x8<S> as Single>::from_slice(simd, &row[at..])
}
