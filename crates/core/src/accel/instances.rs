//! Searches instances, after the scene's own primitives.
//!
//! A ray walks from instance to instance, usually nearer ones first ([`Walk`]), and is searched in
//! the tree of each prototype. Many rays do so in rounds: every ray names its next instance; the
//! rays of an instance are transformed into the space of its prototype and go through that tree
//! together. So packets and rays in flight work there too, for any number of instances.
//!
//! The answer is that of [`Geometry::hit`](crate::geometry::Geometry::hit) and does not depend on
//! the order of visits: a ray is searched in a prototype up to its closest hit so far, and a new hit
//! replaces that one only if it comes first. Shapes that shadow rays pass are no instances, so that
//! the order in a prototype is that of the scene.

use super::tlas::{TlasEntry, Walk};
use super::{Hit, Query, Rays, Search, Traversal};
use crate::geometry::Geometry;
use crate::geometry::instance::Instance;
use crate::kernels::Arithmetic;
use crate::math::Ray;
use crate::math::float::min;

/// Rays that walk together: enough to fill packets, few enough for their stacks to stay in the
/// second-level cache.
const WALKERS: usize = 1024;

/// Fewer rays than this in a prototype are searched one by one.
const FEWEST_TOGETHER: usize = 8;

/// A thread's memory for rays among instances.
#[derive(Clone, Debug, Default)]
pub(super) struct Walks {
    /// The active rays, each with its number in the batch.
    walks: Vec<(u32, Walk)>,
    /// The rays' stacks, in sequence.
    stacks: Vec<TlasEntry>,
    /// Instances to visit in a round, each with the index of a ray.
    visits: Vec<(u32, u32)>,
    /// The rays of one instance, in the space of its prototype.
    carried: Vec<Ray>,
}

impl<P: Arithmetic> Search<'_, P> {
    /// The hit of `ray` on instances, or `best` if that is closer.
    pub(super) fn among_instances<Q: Query>(
        &self,
        ray: &Ray,
        best: Hit,
        traversal: &mut Traversal,
    ) -> Hit {
        let tlas = &self.accel.tlas;
        let mut stack = std::mem::take(&mut traversal.walks.stacks);
        stack.resize(stack.len().max(tlas.stack_entries()), TlasEntry::default());
        let mut walk = Walk::new(tlas, ray, best, &mut stack);
        while let Some(number) = walk.next(tlas, &mut stack) {
            traversal.tests.instances += 1;
            let instance = &self.accel.geometry.instances[number as usize];
            let hit =
                self.in_prototype::<Q>(instance.prototype(), &walk.carried(instance), traversal);
            walk.offer(&self.accel.geometry, instance, hit);
            if Q::ANY && !walk.best.is_miss() {
                break;
            }
        }
        traversal.walks.stacks = stack;
        walk.best
    }

    /// As [`Self::among_instances`], for many rays whose answers so far are `answers`.
    pub(super) fn all_among_instances<Q: Query>(
        &self,
        rays: Rays<'_>,
        answers: &mut [Q::Answer],
        traversal: &mut Traversal,
    ) {
        let mut memory = std::mem::take(&mut traversal.walks);
        let mut found = Vec::new();
        for start in (0..rays.count()).step_by(WALKERS) {
            let end = rays.count().min(start + WALKERS);
            self.begin::<Q>(rays, start..end, answers, &mut memory);
            while self.name_visits::<Q>(&mut memory) {
                self.visit::<Q>(&mut memory, &mut found, traversal);
            }
            for (number, walk) in &memory.walks {
                answers[*number as usize] = Q::answer(walk.best);
            }
        }
        traversal.walks = memory;
    }

    /// Starts the walk of the rays of `range` that can still change their answer.
    fn begin<Q: Query>(
        &self,
        rays: Rays<'_>,
        range: std::ops::Range<usize>,
        answers: &[Q::Answer],
        memory: &mut Walks,
    ) {
        let tlas = &self.accel.tlas;
        let stride = tlas.stack_entries();
        memory.stacks.resize(memory.stacks.len().max(stride * range.len()), TlasEntry::default());
        memory.walks.clear();
        let mut stacks = memory.stacks.chunks_exact_mut(stride);
        for number in range {
            let ray = rays.ray(number);
            if let (true, Some(best)) = (ray.is_valid(), Q::go_on(answers[number]))
                && let Some(stack) = stacks.next()
            {
                memory.walks.push((number as u32, Walk::new(tlas, &ray, best, stack)));
            }
        }
    }

    /// Finds the next instance of every active ray. Returns whether there is any.
    fn name_visits<Q: Query>(&self, memory: &mut Walks) -> bool {
        let Walks { walks, stacks, visits, .. } = memory;
        let tlas = &self.accel.tlas;
        visits.clear();
        let stacks = stacks.chunks_exact_mut(tlas.stack_entries());
        for ((place, (_, walk)), stack) in (0..).zip(walks.iter_mut()).zip(stacks) {
            if Q::ANY && !walk.best.is_miss() {
                continue;
            }
            visits.extend(walk.next(tlas, stack).map(|instance| (instance, place)));
        }
        // Rays of an instance in their original order.
        visits.sort_unstable();
        !visits.is_empty()
    }

    /// Makes the visits of a round, instance by instance; `answers` is memory for those of one.
    fn visit<Q: Query>(
        &self,
        memory: &mut Walks,
        answers: &mut Vec<Q::Answer>,
        traversal: &mut Traversal,
    ) {
        let Walks { walks, visits, carried, .. } = memory;
        traversal.tests.instances += visits.len() as u64;
        for group in visits.chunk_by(|a, b| a.0 == b.0) {
            let geometry = &self.accel.geometry;
            let instance = &geometry.instances[group[0].0 as usize];
            let prototype = instance.prototype();
            carried.clear();
            carried
                .extend(group.iter().map(|&(_, place)| walks[place as usize].1.carried(instance)));
            if group.len() < FEWEST_TOGETHER {
                for (&(_, place), ray) in group.iter().zip(carried.iter()) {
                    let hit = self.in_prototype::<Q>(prototype, ray, traversal);
                    walks[place as usize].1.offer(geometry, instance, hit);
                }
                continue;
            }
            answers.resize(carried.len(), Q::answer(Hit::MISS));
            // A ray counts once, in the search of the scene.
            let (searched, kernels) = (self.prototype(prototype), traversal.kernels);
            let query = &mut Q::default();
            self.all_in_tree(searched, Rays::Rows(carried), answers, query, traversal);
            traversal.kernels = kernels;
            for (&(_, place), &answer) in group.iter().zip(answers.iter()) {
                walks[place as usize].1.offer(geometry, instance, Q::hit(answer));
            }
        }
    }
}

impl Walk {
    /// The ray in the space of the instance's prototype, up to the closest hit: one whose t rounds to
    /// the same number may come first.
    #[inline]
    fn carried(&self, instance: &Instance) -> Ray {
        let ray = instance.carried(&self.ray);
        if self.best.is_miss() {
            return ray;
        }
        Ray { t_max: min(ray.t_max, self.best.t.next_up()), ..ray }
    }

    /// Accepts the `hit` in the prototype of `instance` if it comes before the closest one so far.
    #[inline]
    fn offer(&mut self, geometry: &Geometry, instance: &Instance, hit: Hit) {
        if hit.is_miss() {
            return;
        }
        let hit = Hit { primitive: instance.first() + hit.primitive, ..hit };
        if geometry.order(&self.ray, hit, self.best).is_lt() {
            self.best = hit;
        }
    }
}
