//! Each step to an exact hit by itself, at the leaves that rays visit and with the kernels of the
//! traversal, so that its time can be measured.

use std::hint::black_box;

use fearless_simd::{Level, f32x8};

use super::tree::child_box;
use super::{Accel, ArenaView, Best, Kind, Pairs, Ref, Tree, child_of, leaf};
use crate::at_level;
use crate::counters::TestCounts;
use crate::geometry::{PreparedRay, Primitive};
use crate::kernels::triangle::{self, exact, settle};
use crate::kernels::{Arithmetic, Precision};
use crate::math::float::{max, min};
use crate::math::{LANES, Lanes, Ray, Single};
use crate::with_precision;

wavecrest_base::choices! {
    /// A step to an exact hit.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum HitStep {
        /// A pair of a ray and a triangle of a leaf in single precision.
        Filter = "filter",
        /// An open pair in double precision, eight at a time.
        Settle = "settled in double precision",
        /// A pair that is open still.
        Exact = "exact arithmetic",
        /// The t of a closest hit.
        T = "t of hits",
    }
}

impl HitStep {
    /// How often it was taken.
    pub fn count(self, tests: &TestCounts) -> u64 {
        match self {
            Self::Filter => tests.triangles + tests.quads,
            Self::Settle => tests.settled,
            Self::Exact => tests.exact,
            Self::T => tests.finished,
        }
    }
}

/// A ray at a leaf.
#[derive(Clone, Copy, Debug)]
struct LeafVisit<'a> {
    arena: ArenaView<'a>,
    ray: PreparedRay,
    leaf: Ref,
    /// The t of the ray's closest hit, or the end of its range.
    reach: f32,
}

/// Rays at the leaves that they visit, and their closest hits among them.
#[derive(Debug)]
pub struct Steps<'a> {
    level: Level,
    visits: Vec<LeafVisit<'a>>,
    /// Visits, each with an entry of the leaf.
    hits: Vec<(LeafVisit<'a>, usize)>,
}

impl<'a> Steps<'a> {
    /// Those of `rays` in `accel`. A ray that hits an instance counts in the tree of its prototype,
    /// others in that of the scene.
    pub fn new(accel: &'a Accel, rays: &[Ray]) -> Self {
        let mut steps = Self { level: accel.level, visits: Vec::new(), hits: Vec::new() };
        let mut traversal = accel.traversal();
        for ray in rays {
            let hit = accel.closest(ray, &mut traversal);
            let reach = min(hit.t, ray.t_max);
            let mut at = (accel.tree(), *ray, hit.primitive);
            if !hit.is_miss()
                && let Primitive::Instanced(place) = accel.geometry.primitive(hit.primitive)
            {
                let instance = accel.geometry.instance(place).0;
                let blas = accel.blas.get(instance.prototype());
                at = (blas, instance.carried(ray), place.triangle);
            }
            if let (Some(tree), ray, number) = at
                && ray.is_valid()
            {
                steps.add(tree, PreparedRay::new(&ray), number, reach);
            }
        }
        steps
    }

    /// Adds the leaves of triangles whose boxes the ray enters within `reach`.
    fn add(&mut self, tree: &'a Tree, ray: PreparedRay, number: u32, reach: f32) {
        let arena = tree.arena.view();
        let mut waiting: Vec<Ref> = tree.root.iter().map(|root| root.place).collect();
        while let Some(place) = waiting.pop() {
            match place.kind() {
                Kind::Node => {
                    let node = arena.node(place);
                    let is_met = |lane: &usize| {
                        let [near, far] = ray.slab.interval(&child_box(node, *lane));
                        max(near, ray.ray.t_min) <= min(far, reach)
                    };
                    let met = (0..node.count as usize).filter(is_met);
                    waiting.extend(met.map(|lane| child_of(node, place, lane)));
                }
                Kind::List => waiting.extend(tree.known(place)),
                Kind::Patch | Kind::Soup => {
                    let visit = LeafVisit { arena, ray, leaf: place, reach };
                    self.visits.push(visit);
                    let is_hit = |&entry: &usize| {
                        arena.number_of(place, entry) == number
                            && triangle::meet(&ray.ray, &arena.triangle(place, entry)).is_some()
                    };
                    let hit = (0..arena.count(place)).find(is_hit);
                    self.hits.extend(hit.map(|entry| (visit, entry)));
                }
            }
        }
    }

    /// The number of times that [`Self::run`] takes a step.
    pub fn count(&self, step: HitStep) -> u64 {
        match step {
            HitStep::Filter => {
                self.visits.iter().map(|visit| visit.arena.count(visit.leaf) as u64).sum()
            }
            _ => self.hits.len() as u64,
        }
    }

    /// Takes a step for every ray: the filter, in this precision, at the leaves, others for the hits.
    /// Returns a sum of bits, so that nothing is optimised away.
    // Not generic: other crates are optimised less.
    #[inline(never)]
    pub fn run(&self, step: HitStep, precision: Precision) -> u64 {
        with_precision!(precision, P =>
            at_level!(self.level, simd => self.run_with::<_, P>(simd, step)))
    }

    #[inline(always)]
    fn run_with<S: Lanes, P: Arithmetic>(&self, simd: S, step: HitStep) -> u64 {
        let Self { visits, hits, .. } = self;
        let (mut sum, mut tests) = (0, TestCounts::default());
        match step {
            HitStep::Filter => {
                for LeafVisit { arena, ray, leaf, reach } in visits {
                    let ray = (&ray.ray, &ray.space);
                    let found = leaf::test::<S, P>(simd, *arena, ray, *leaf, *reach, &mut tests);
                    sum += u64::from(black_box(&found).certain);
                }
            }
            HitStep::Settle => {
                for pairs in hits.chunks(LANES) {
                    let mut gathered = Pairs::default();
                    for (lane, (LeafVisit { arena, ray, leaf, .. }, entry)) in
                        pairs.iter().enumerate()
                    {
                        gathered.set(lane, &ray.ray, *arena, (*leaf, *entry));
                    }
                    let (line, corners) = gathered.load::<f32x8<S>>(simd);
                    let all = <f32x8<S> as Single>::splat(simd, f32::MAX);
                    let range = [-all, all];
                    sum += u64::from(black_box(settle::settle(&line, &corners, range)).hit);
                }
            }
            HitStep::Exact => {
                for (LeafVisit { arena, ray, leaf, .. }, entry) in hits {
                    let t = exact::meet(&ray.ray, &arena.triangle(*leaf, *entry));
                    sum += u64::from(t.unwrap_or_default().to_bits());
                }
            }
            HitStep::T => {
                for (LeafVisit { arena, ray, leaf, .. }, entry) in hits {
                    let best = Best::in_leaf(*leaf, *entry, [0.0, f32::MAX]);
                    sum += u64::from(best.finished(*arena, &ray.ray).t.to_bits());
                }
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Numbers, cloud};
    use super::super::{Hit, KernelChoice};
    use super::*;
    use crate::accel::build::Preset;

    /// Rays through a cloud of triangles, and the triangles that they hit.
    fn traced(precision: Precision) -> (Accel, Vec<Ray>, Vec<Hit>) {
        let mut numbers = Numbers(0);
        let mut geometry = cloud(&mut numbers, 1.0);
        geometry.set_precision(precision);
        let mut accel = Accel::new(geometry, Preset::Fast);
        let ray = |numbers: &mut Numbers| {
            let from = numbers.vector() * 2.0;
            Ray::new(from, numbers.vector() - from)
        };
        let rays: Vec<Ray> = (0..500).map(|_| ray(&mut numbers)).collect();
        accel.kernel = KernelChoice::Single;
        let mut hits = vec![Hit::MISS; rays.len()];
        accel.closest_of(&rays[..], &mut hits, &mut accel.traversal());
        let triangles = accel.geometry().triangles.len();
        hits.retain(|hit| (hit.primitive as usize) < triangles);
        assert!(hits.len() > 100, "{}", hits.len());
        (accel, rays, hits)
    }

    #[test]
    fn every_step_is_that_of_the_traversal() {
        let (accel, rays, hits) = traced(Precision::Exact);
        let steps = Steps::new(&accel, &rays);
        let run = |step| steps.run(step, Precision::Exact);
        for step in [HitStep::Settle, HitStep::Exact, HitStep::T] {
            assert_eq!(steps.count(step), hits.len() as u64);
        }
        let t = hits.iter().map(|hit| u64::from(hit.t.to_bits())).sum::<u64>();
        assert_eq!((run(HitStep::T), run(HitStep::Exact)), (t, t));
        assert!(steps.count(HitStep::Filter) > steps.count(HitStep::T));
        // Every hit is certain in one lane of a leaf, at least, and nearly all are so in double
        // precision.
        assert!(run(HitStep::Filter) >= hits.len() as u64);
        assert!(run(HitStep::Settle) > 0);
    }

    #[test]
    fn every_kernel_counts_hits_whose_t_it_finds() {
        for precision in Precision::ALL {
            let (mut accel, rays, hits) = traced(precision);
            for kernel in KernelChoice::FOR_RENDERS {
                accel.kernel = kernel;
                let (mut traversal, mut all) = (accel.traversal(), vec![Hit::MISS; rays.len()]);
                accel.closest_of(&rays[..], &mut all, &mut traversal);
                let TestCounts { finished, settled, .. } = traversal.tests;
                // The t of open pairs is known once they are settled.
                let least = hits.len() as u64 - settled.min(hits.len() as u64);
                let expected = match precision {
                    Precision::Fast => 0..=0,
                    Precision::Exact => least..=hits.len() as u64,
                };
                assert!(expected.contains(&finished), "{kernel:?}: {finished} of {expected:?}");
            }
        }
    }
}
