//! The rays that packets leave to the kernel in flight.

use super::{NO_INSTANCE, Slot};
use crate::accel::{Best, Hit, Query, Rays, Root, Searched, distance};
use crate::geometry::PreparedRay;
use crate::kernels::SlabRay;
use crate::math::entry;

/// The largest number of places handed over with a ray.
pub(super) const MOST_HANDED: u32 = 24;

/// In place of the place before a ray's first.
const NO_PLACE: u32 = u32::MAX;

/// Rays of a batch that packets hand over, with the places at which they continue.
#[derive(Clone, Debug, Default)]
pub(crate) struct HandedRays {
    /// The numbers of the rays.
    pub(crate) queue: Vec<u32>,
    /// For each ray of the batch its last place, and the number of places.
    last: Vec<(u32, u32)>,
    /// Each as on the stack of a ray, with the number of the ray's place before.
    places: Vec<(u64, u32)>,
}

impl HandedRays {
    /// Forgets all rays, and makes room for those of a batch.
    pub(crate) fn begin(&mut self, rays: usize) {
        self.queue.clear();
        self.places.clear();
        self.last.clear();
        self.last.resize(rays, (NO_PLACE, 0));
    }

    /// Adds a place to those of a ray. Returns whether there was room.
    #[inline(always)]
    pub(crate) fn add(&mut self, ray: usize, entry: u64) -> bool {
        let (before, count) = self.last[ray];
        if count == MOST_HANDED {
            return false;
        }
        if count == 0 {
            self.queue.push(ray as u32);
        }
        self.last[ray] = (self.places.len() as u32, count + 1);
        self.places.push((entry, before));
        true
    }
}

/// The rays that packets handed over, then those that no packet took.
pub(crate) struct RaySource<'a> {
    pub(crate) rays: Rays<'a>,
    pub(crate) handed: &'a mut HandedRays,
    /// The first of the rays that no packet took. They start at the root.
    pub(crate) next: usize,
    pub(crate) searched: &'a Searched<'a>,
    pub(crate) root: Root,
}

impl RaySource<'_> {
    /// Fills `slot` with the next ray to trace and `stack` with its first entries, and returns
    /// their number. Rays that need no tracing are answered on the way.
    #[inline(always)]
    pub(super) fn next<Q: Query, const INSTANCES: bool>(
        &mut self,
        answers: &mut [Q::Answer],
        stack: &mut [u64],
        slot: &mut Slot,
    ) -> Option<usize> {
        while let Some(number) = self.handed.queue.pop() {
            let number = number as usize;
            if !self.prepare::<Q, INSTANCES>(number, answers, slot) {
                continue;
            }
            let Some(hit) = Q::go_on(answers[number]) else { continue };
            let best = if hit.is_miss() { Best::none(slot.ray.ray.t_max) } else { Best::of(hit) };
            let (mut entries, reach) = (0, slot.ray.slab.reach(best.high));
            let mut place = self.handed.last[number].0;
            // From the farthest to the nearest, which comes last.
            while let Some(&(entry, before)) = self.handed.places.get(place as usize) {
                stack[entries] = entry;
                entries += usize::from(distance(entry) <= reach);
                place = before;
            }
            if entries > 0 {
                slot.best = best;
                return Some(entries);
            }
        }
        while self.next < self.rays.count() {
            let number = self.next;
            self.next += 1;
            if Q::ALL && Q::go_on(answers[number]).is_none() {
                continue;
            }
            if !self.prepare::<Q, INSTANCES>(number, answers, slot) {
                continue;
            }
            stack[0] = entry(f32::NEG_INFINITY, self.root.place.bits());
            slot.best = Best::none(slot.ray.ray.t_max);
            return Some(1);
        }
        None
    }

    /// Prepares the ray with that number, or answers it, if it cannot be traced. Returns whether it can. Of rays of
    /// which all is asked for that they cross, most meet nothing, not even the root.
    #[inline(always)]
    fn prepare<Q: Query, const INSTANCES: bool>(
        &self,
        number: usize,
        answers: &mut [Q::Answer],
        slot: &mut Slot,
    ) -> bool {
        let ray = &self.rays.ray(number);
        if !ray.is_valid() {
            answers[number] = Q::answer(Hit::MISS);
            return false;
        }
        if Q::ALL && !SlabRay::new(ray).meets(ray, &self.root.bounds) {
            return false;
        }
        slot.number = number as u32;
        if INSTANCES {
            (slot.ray, slot.instance) = (self.searched.prepare(ray), NO_INSTANCE);
        } else {
            slot.ray = PreparedRay::new(ray);
        }
        true
    }
}
