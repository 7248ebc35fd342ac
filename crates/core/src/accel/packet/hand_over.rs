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
        let Self { simd, searched, .. } = *self;
        for i in set_bits::<TILE>(rays) {
            let number = tile.block + number_of(i);
            if self.handed.add(number, place) {
                continue;
            }
            // Beyond a number of places the ray traverses the subtree at once, alone.
            outlined(
                simd,
                #[inline(always)]
                || {
                    let ray = (&PreparedRay::new(&tile.ray(i)), number);
                    let before = tile.best(i);
                    let stack = (&mut *self.stack, place);
                    let notes = (&mut *self.tests, &mut *self.noted);
                    let best = single::trace::<S, Q, P>(simd, searched, ray, before, stack, notes);
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
}
