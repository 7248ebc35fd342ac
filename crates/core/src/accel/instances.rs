//! Searching instances, after the primitives that the scene holds as they are.
//!
//! One ray visits the instances on its way, nearer ones mostly first, and is searched in the prototype of each. Many
//! rays do so in rounds: in each, every ray names the next instance on its way; the rays of an instance are
//! carried into the space of its prototype together, and go through its tree as any batch does. So a prototype's tree is
//! searched by packets and by rays in flight, whatever the number of instances.
//!
//! The answer is that of [`Geometry::hit`](super::geometry::Geometry::hit), and does not depend on the order
//! of visits: a ray is searched in a prototype up to a little beyond its closest hit so far, and what is found
//! replaces that one only if it is closer, or as close and of a lower number.

use super::geometry::PreparedRay;
use super::instance::Instance;
use super::query::{Closest, Occluded, Query};
use super::rays::Rays;
use super::search::{self, Searched};
use super::tlas::Entry;
use super::tree::reach;
use super::{Accel, Hit, Traversal};
use crate::kernels::precision::{Arithmetic, Robust};
use crate::kernels::slab::SlabRay;
use crate::math::float::min;
use crate::math::ray::Ray;

/// Rays that go from instance to instance together: enough to fill packets, few enough for their stacks to
/// stay in the second-level cache.
const BLOCK: usize = 1024;

/// With fewer rays than this in a prototype, each goes alone.
const FEW: usize = 8;

/// A ray on its way.
#[derive(Clone, Copy, Debug)]
struct Way {
    ray: Ray,
    slab: SlabRay,
    best: Hit,
    /// Its number in the batch.
    number: u32,
    /// Of its stack.
    height: u32,
}

/// The memory of a thread's rays among instances.
#[derive(Clone, Debug, Default)]
pub(super) struct Ways {
    ways: Vec<Way>,
    /// One stack after the other.
    stacks: Vec<Entry>,
    /// Instances to be visited in a round, each with the place of a ray.
    visits: Vec<(u32, u32)>,
    /// The rays of one instance, in the space of its prototype.
    carried: Vec<Ray>,
    hits: Vec<Hit>,
    occluded: Vec<bool>,
}

/// A question that prototypes can be asked, by one ray or by many.
pub(super) trait InstanceQuery: Query {
    /// The hit so far that an answer tells of; `None` if nothing more can come.
    fn so_far(answer: Self::Answer) -> Option<Hit>;

    /// What `ray` meets in the prototype of that number; for a question whether there is anything, some hit.
    fn one<P: Arithmetic>(
        accel: &Accel,
        prototype: usize,
        ray: &Ray,
        traversal: &mut Traversal,
    ) -> Option<Hit>;

    /// As [`InstanceQuery::one`] for all of `rays`, into `hits`.
    fn many<P: Arithmetic>(
        accel: &Accel,
        prototype: usize,
        rays: &[Ray],
        hits: &mut Vec<Hit>,
        occluded: &mut Vec<bool>,
        traversal: &mut Traversal,
    );
}

impl InstanceQuery for Closest {
    fn so_far(answer: Hit) -> Option<Hit> {
        Some(answer)
    }

    fn one<P: Arithmetic>(
        accel: &Accel,
        prototype: usize,
        ray: &Ray,
        traversal: &mut Traversal,
    ) -> Option<Hit> {
        if !ray.is_valid() {
            return None;
        }
        let ray = PreparedRay::of::<P>(ray);
        let hit = search::closest::<P>(accel.level, accel.prototype(prototype), &ray, traversal);
        (!hit.is_miss()).then(|| accel.geometry.prototypes[prototype].unsealed(hit))
    }

    fn many<P: Arithmetic>(
        accel: &Accel,
        prototype: usize,
        rays: &[Ray],
        hits: &mut Vec<Hit>,
        _: &mut Vec<bool>,
        traversal: &mut Traversal,
    ) {
        hits.resize(rays.len(), Hit::MISS);
        together::<Self, P>(accel, prototype, rays, hits, traversal);
        let geometry = &accel.geometry.prototypes[prototype];
        if !geometry.seals.is_empty() {
            hits.iter_mut().for_each(|hit| *hit = geometry.unsealed(*hit));
        }
    }
}

/// Any hit will do.
const ANY: Hit = Hit { t: 0.0, primitive: 0 };

impl InstanceQuery for Occluded {
    fn so_far(answer: bool) -> Option<Hit> {
        (!answer).then_some(Hit::MISS)
    }

    fn one<P: Arithmetic>(
        accel: &Accel,
        prototype: usize,
        ray: &Ray,
        traversal: &mut Traversal,
    ) -> Option<Hit> {
        if !ray.is_valid() {
            return None;
        }
        let ray = PreparedRay::of::<P>(ray);
        search::occluded::<P>(accel.level, accel.prototype(prototype), &ray, traversal)
            .then_some(ANY)
    }

    fn many<P: Arithmetic>(
        accel: &Accel,
        prototype: usize,
        rays: &[Ray],
        hits: &mut Vec<Hit>,
        occluded: &mut Vec<bool>,
        traversal: &mut Traversal,
    ) {
        occluded.resize(rays.len(), false);
        together::<Self, P>(accel, prototype, rays, occluded, traversal);
        hits.clear();
        hits.extend(occluded.iter().map(|&found| if found { ANY } else { Hit::MISS }));
    }
}

/// Many rays in the tree of a prototype.
fn together<Q: Query, P: Arithmetic>(
    accel: &Accel,
    prototype: usize,
    rays: &[Ray],
    answers: &mut [Q::Answer],
    traversal: &mut Traversal,
) {
    // A ray counts once, where it is asked of the scene.
    let kernels = traversal.kernels;
    let how = (accel.level, accel.kernel);
    search::many::<Q, P>(how, accel.prototype(prototype), rays.into(), answers, traversal);
    traversal.kernels = kernels;
}

impl Accel {
    fn prototype(&self, prototype: usize) -> Searched<'_> {
        (&self.blas[prototype], &self.geometry.prototypes[prototype])
    }

    /// What `ray` meets of instances, or `best` if that is closer.
    pub(super) fn among_instances<Q: InstanceQuery, P: Arithmetic>(
        &self,
        ray: &Ray,
        mut best: Hit,
        traversal: &mut Traversal,
    ) -> Hit {
        let tlas = &self.tlas;
        let slab = tlas.slab(ray);
        let mut stack = std::mem::take(&mut traversal.ways.stacks);
        stack.resize(stack.len().max(tlas.stack_entries()), Entry::default());
        let mut height = tlas.start::<P>(ray, &slab, min(best.t, ray.t_max), &mut stack);
        while height > 0 {
            let t = min(best.t, ray.t_max);
            let (found, rest) = tlas.next::<P>(ray, &slab, t, (&mut stack, height));
            height = rest;
            let Some(instance) = found else { break };
            traversal.tests.instances += 1;
            let instance = &self.geometry.instances[instance as usize];
            let carried = up_to(instance.carried(ray), &best);
            if let Some(hit) = Q::one::<P>(self, instance.prototype(), &carried, traversal) {
                best = nearer(best, instance, hit);
                if Q::ANY {
                    break;
                }
            }
        }
        traversal.ways.stacks = stack;
        best
    }

    /// As [`Accel::among_instances`] for many rays, whose answers so far are `answers`.
    pub(super) fn all_among_instances<Q: InstanceQuery, P: Arithmetic>(
        &self,
        rays: Rays<'_>,
        answers: &mut [Q::Answer],
        traversal: &mut Traversal,
    ) {
        let mut memory = std::mem::take(&mut traversal.ways);
        let count = rays.count();
        for start in (0..count).step_by(BLOCK) {
            let end = count.min(start + BLOCK);
            memory.ways.clear();
            for (number, &answer) in (start..).zip(&answers[start..end]) {
                let ray = rays.ray(number);
                if let (true, Some(best)) = (ray.is_valid(), Q::so_far(answer)) {
                    let (slab, number) = (self.tlas.slab(&ray), number as u32);
                    memory.ways.push(Way { ray, slab, best, number, height: 0 });
                }
            }
            self.start::<P>(&mut memory);
            while self.name_visits::<P>(&mut memory, Q::ANY) {
                self.visit::<Q, P>(&mut memory, traversal);
            }
            for way in &memory.ways {
                answers[way.number as usize] = Q::answer(way.best);
            }
        }
        traversal.ways = memory;
    }

    fn start<P: Arithmetic>(&self, memory: &mut Ways) {
        let stride = self.tlas.stack_entries();
        let entries = memory.stacks.len().max(stride * memory.ways.len());
        memory.stacks.resize(entries, Entry::default());
        for (way, stack) in memory.ways.iter_mut().zip(memory.stacks.chunks_exact_mut(stride)) {
            let t = min(way.best.t, way.ray.t_max);
            way.height = self.tlas.start::<P>(&way.ray, &way.slab, t, stack) as u32;
        }
    }

    /// Has every ray that is not done name its next instance. Whether there is any.
    fn name_visits<P: Arithmetic>(&self, memory: &mut Ways, any: bool) -> bool {
        let Ways { ways, stacks, visits, .. } = memory;
        visits.clear();
        let stacks = stacks.chunks_exact_mut(self.tlas.stack_entries());
        for ((place, way), stack) in (0..).zip(ways.iter_mut()).zip(stacks) {
            if way.height == 0 || any && !way.best.is_miss() {
                continue;
            }
            let t = min(way.best.t, way.ray.t_max);
            let stack = (stack, way.height as usize);
            let (found, height) = self.tlas.next::<P>(&way.ray, &way.slab, t, stack);
            way.height = height as u32;
            visits.extend(found.map(|instance| (instance, place)));
        }
        // Rays of an instance in the order in which they came.
        visits.sort_unstable();
        !visits.is_empty()
    }

    /// Makes the visits of a round, instance by instance.
    fn visit<Q: InstanceQuery, P: Arithmetic>(&self, memory: &mut Ways, traversal: &mut Traversal) {
        let Ways { ways, visits, carried, hits, occluded, .. } = memory;
        traversal.tests.instances += visits.len() as u64;
        for group in visits.chunk_by(|a, b| a.0 == b.0) {
            let instance = &self.geometry.instances[group[0].0 as usize];
            let rays = group.iter().map(|&(_, place)| {
                let way = &ways[place as usize];
                up_to(instance.carried(&way.ray), &way.best)
            });
            carried.clear();
            carried.extend(rays);
            let prototype = instance.prototype();
            if group.len() < FEW {
                hits.clear();
                let found = |ray| Q::one::<P>(self, prototype, ray, traversal).unwrap_or(Hit::MISS);
                hits.extend(carried.iter().map(found));
            } else {
                Q::many::<P>(self, prototype, carried, hits, occluded, traversal);
            }
            for (&(_, place), &hit) in group.iter().zip(hits.iter()) {
                if !hit.is_miss() {
                    let best = &mut ways[place as usize].best;
                    *best = nearer(*best, instance, hit);
                }
            }
        }
    }
}

/// `ray`, to be searched a little beyond `best`: what counts as a hit there does not depend on the end.
#[inline]
fn up_to(ray: Ray, best: &Hit) -> Ray {
    if best.is_miss() {
        return ray;
    }
    Ray { t_max: min(ray.t_max, reach::<Robust>(best.t)), ..ray }
}

/// `best`, or the `hit` in the prototype of `instance` if it is closer, or as close and of a lower number.
#[inline]
fn nearer(best: Hit, instance: &Instance, hit: Hit) -> Hit {
    let hit = Hit { primitive: instance.first() + hit.primitive, ..hit };
    if hit.t < best.t || (hit.t == best.t && hit.primitive < best.primitive) { hit } else { best }
}
