//! Hands rays over to the kernel in flight.

use super::{RayTile, TILE, TileBatch, number_of};
use crate::accel::{Query, single};
use crate::geometry::PreparedRay;
use crate::kernels::Arithmetic;
use crate::math::{Lanes, outlined, set_bits};

impl<S: Lanes, Q: Query, P: Arithmetic> TileBatch<'_, S, Q, P> {
    /// Hands `rays` over, to continue from `place`.
    #[inline(always)]
    pub(super) fn hand_over(&mut self, tile: &mut RayTile, place: u64, rays: u64) {
        tile.is_left = true;
        for i in set_bits::<TILE>(rays) {
            // Beyond a number of places the ray continues at once.
            if !self.handed.add(tile.block + number_of(i), place) {
                self.go_on(tile, place, i);
            }
        }
    }

    /// Traverses the subtree at `place` with the `i`th ray alone.
    #[inline(always)]
    fn go_on(&mut self, tile: &mut RayTile, place: u64, i: usize) {
        let simd = self.simd;
        outlined(
            simd,
            #[inline(always)]
            || {
                let ray = PreparedRay::new(&tile.ray(i));
                let before = tile.best(i);
                let (searched, stack) = (self.searched, (&mut *self.stack, place));
                let (number, notes) =
                    (tile.block + number_of(i), (&mut *self.tests, &mut *self.noted));
                let best =
                    single::trace::<S, Q, P>(simd, searched, (&ray, number), before, stack, notes);
                if best == before {
                    return;
                }
                if Q::ANY {
                    tile.done |= 1 << i;
                } else {
                    tile.set_best(i, best);
                    tile.tighten(simd);
                }
            },
        );
    }
}
