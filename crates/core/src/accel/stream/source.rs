//! The rays of a stream: those that packets handed over, then those that no packet took.

use super::Slot;
use crate::accel::{Best, Query, Rays, Root, distance};
use crate::geometry::PreparedRay;
use crate::math::entry;

/// A place handed over with a ray, and the one before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HandedPlace {
    pub(crate) entry: u64,
    pub(crate) before: u32,
}

/// The rays of a batch that are still to be traced.
pub(crate) struct RaySource<'a> {
    pub(crate) rays: Rays<'a>,
    /// Those handed over, with the last place of each ray of the batch, and all places.
    pub(crate) queue: &'a mut Vec<u32>,
    pub(crate) last: &'a [(u32, u32)],
    pub(crate) handed: &'a [HandedPlace],
    /// The first of the others, which start from the root.
    pub(crate) next: usize,
    pub(crate) root: Root,
}

impl RaySource<'_> {
    /// Fills `slot` with the next ray to trace and `stack` with its first entries, and returns
    /// their number. Rays that need no tracing are answered on the way.
    #[inline(always)]
    pub(super) fn next<Q: Query>(
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
        while self.next < self.rays.count() {
            let number = self.next;
            self.next += 1;
            let ray = self.rays.ray(number);
            if !ray.is_valid() {
                answers[number] = Q::NONE;
                continue;
            }
            slot.ray = PreparedRay::new(&ray);
            stack[0] = entry(f32::NEG_INFINITY, self.root.place.bits());
            slot.begin(number, Best::none(ray.t_max));
            return Some(1);
        }
        None
    }
}
