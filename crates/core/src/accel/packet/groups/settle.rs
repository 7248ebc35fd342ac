//! Where rays meet a triangle that single precision does not decide on: in double precision, eight rays at a time.

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

/// What double precision says of the rays of a group in front of a triangle.
pub(super) struct Settled {
    pub(super) t: Row,
    /// Those that meet it at t, and those that are decided on, a bit each.
    pub(super) hit: u32,
    pub(super) decided: u32,
}

/// Settles in double precision where the `open` rays, a bit each, meet a triangle that they pass through.
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
            let rows = |columns: &[Column; 3]| {
                let [x, y, z] = columns;
                [row(simd, x, group, g), row(simd, y, group, g), row(simd, z, group, g)]
            };
            let (origin, direction) = (rows(&tile.origin), rows(&tile.direction));
            for half in 0..WIDTH / LANES {
                let at = half * LANES;
                let open = open >> at & 0xFF;
                if open == 0 {
                    continue;
                }
                let load = |row: &Row| <f32x8<S> as Single>::from_slice(simd, &row[at..]);
                let vector = |[x, y, z]: &[Row; 3]| Vector::new(load(x), load(y), load(z));
                let line = Line { origin: vector(&origin), direction: vector(&direction) };
                let range = RayRange {
                    depth: load(&group.depth),
                    t_min: load(&group.t_min),
                    t_max: load(&group.t_max),
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
