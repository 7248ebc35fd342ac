//! Hands rays over to the kernel in flight.

use super::{RayTile, TILE, TileBatch, number_of};
use crate::accel::stream::{HandedPlace, MOST_HANDED};
use crate::accel::{Query, single};
use crate::geometry::PreparedRay;
use crate::kernels::Arithmetic;
use crate::math::{Lanes, outlined};

impl<S: Lanes, Q: Query, P: Arithmetic> TileBatch<'_, S, Q, P> {
    /// Hands `rays` over, to continue from `place`.
    #[inline(always)]
    pub(super) fn hand_over(&mut self, tile: &mut RayTile, place: u64, rays: u64) {
        tile.is_left = true;
        let mut rest = rays;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize % TILE;
            rest &= rest - 1;
            let number = tile.block + number_of(i);
            let (before, count) = self.last[number];
            if count as usize == MOST_HANDED {
                // Beyond that number the ray continues at once.
                self.go_on(tile, place, i);
                continue;
            }
            if count == 0 {
                self.queue.push(number as u32);
            }
            self.last[number] = (self.handed.len() as u32, count + 1);
            self.handed.push(HandedPlace { entry: place, before });
        }
    }

    /// Traverses the subtree at `place` with the `i`th ray alone.
    #[inline(always)]
    fn go_on(&mut self, tile: &mut RayTile, place: u64, i: usize) {
        outlined(
            self.simd,
            #[inline(always)]
            || {
                let ray = PreparedRay::new(&tile.ray(i));
                let before = tile.best(i);
                self.stack[0] = place;
                let (searched, stack) = (self.searched, (&mut *self.stack, 1));
                let (number, notes) =
                    (tile.block + number_of(i), (&mut *self.tests, &mut *self.noted));
                let best = single::trace::<S, Q, P>(
                    self.simd,
                    searched,
                    (&ray, number),
                    before,
                    stack,
                    notes,
                );
                if best == before {
                    return;
                }
                if Q::ANY {
                    tile.done |= 1 << i;
                } else {
                    tile.set_best(i, best);
                    tile.tighten(self.simd);
                }
            },
        );
    }
}
