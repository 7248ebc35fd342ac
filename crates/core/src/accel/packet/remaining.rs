//! The rays that packets leave to the kernel in flight.

use crate::accel::node::distance;
use crate::accel::query::Query;
use crate::accel::rays::Rays;
use crate::accel::stream::{FromRoot, RaySource, Slot};
use crate::geometry::PreparedRay;
use crate::kernels::precision::Arithmetic;

/// A place handed over with a ray, and the one before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Handed {
    pub(super) entry: u64,
    pub(super) before: u32,
}

/// The rays that packets handed over, then those that no packet took.
pub(super) struct Remaining<'a> {
    pub(super) queue: &'a mut Vec<u32>,
    pub(super) handed: &'a [Handed],
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
