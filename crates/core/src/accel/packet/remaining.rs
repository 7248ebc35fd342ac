//! The rays that packets leave to the kernel in flight.

use super::columns::number_of;
use super::tile::RayTile;
use super::{TILE, TileBatch};
use crate::accel::node::distance;
use crate::accel::query::Query;
use crate::accel::rays::Rays;
use crate::accel::single;
use crate::accel::stream::{FromRoot, MOST_HANDED, RaySource, Slot};
use crate::geometry::PreparedRay;
use crate::kernels::precision::Arithmetic;
use crate::math::simd::{Lanes, outlined};

/// A place handed over with a ray, and the one before.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandedPlace {
    pub(super) entry: u64,
    pub(super) before: u32,
}

/// The rays that packets handed over, then those that no packet took.
pub(super) struct Remaining<'a> {
    pub(super) queue: &'a mut Vec<u32>,
    pub(super) handed: &'a [HandedPlace],
    pub(super) last: &'a [(u32, u32)],
    pub(super) rays: Rays<'a>,
    pub(super) rest: FromRoot<'a>,
}

impl<Q: Query, P: Arithmetic> RaySource<Q, P> for Remaining<'_> {
    #[inline(always)]
    fn next(
        &mut self,
        answers: &mut [Q::Answer],
        stack: &mut [u64],
        slot: &mut Slot,
    ) -> Option<usize> {
        while let Some(number) = self.queue.pop() {
            let number = number as usize;
            let ray = self.rays.ray(number);
            if !ray.is_valid() {
                answers[number] = Q::NONE;
                continue;
            }
            slot.ray = PreparedRay::new(&ray);
            let Some(best) = Q::resume(answers[number], &ray) else { continue };
            let (mut entries, reach) = (0, slot.ray.slab.reach(best.high));
            let mut place = self.last[number].0;
            // From the farthest to the nearest, which comes last.
            while let Some(handed) = self.handed.get(place as usize) {
                stack[entries] = handed.entry;
                entries += usize::from(distance(handed.entry) <= reach);
                place = handed.before;
            }
            if entries > 0 {
                slot.begin(number, best);
                return Some(entries);
            }
        }
        <FromRoot<'_> as RaySource<Q, P>>::next(&mut self.rest, answers, stack, slot)
    }
}

impl<Q: Query, P: Arithmetic> TileBatch<'_, Q, P> {
    /// Hands `rays` over, to continue from `place`.
    #[inline(always)]
    pub(super) fn hand_over<S: Lanes>(
        &mut self,
        simd: S,
        tile: &mut RayTile,
        place: u64,
        rays: u64,
    ) {
        tile.is_left = true;
        let mut rest = rays;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize % TILE;
            rest &= rest - 1;
            let number = tile.block + number_of(i);
            let (before, count) = self.last[number];
            if count as usize == MOST_HANDED {
                // Beyond that number the ray continues at once.
                self.go_on(simd, tile, place, i);
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
    fn go_on<S: Lanes>(&mut self, simd: S, tile: &mut RayTile, place: u64, i: usize) {
        outlined(
            simd,
            #[inline(always)]
            || {
                let ray = PreparedRay::new(&tile.ray(i));
                let before = tile.best(i);
                self.stack[0] = place;
                let (searched, stack) = (self.searched, (&mut *self.stack, 1));
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
