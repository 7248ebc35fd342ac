//! Timed passes over the rays of a file.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::prelude::*;

use wavecrest_core::accel::{Accel, Hit, Traversal};
use wavecrest_core::counters::{Kernels, TestCounts};
use wavecrest_core::math::ray::Ray;
use wavecrest_core::render::TracerKind;
use wavecrest_report::ray_file::RayFile;

/// Rays for each task.
const BLOCK_RAYS: usize = 4096;

/// The answers and times.
pub(super) struct Answers {
    pub(super) closest: Vec<Hit>,
    pub(super) occluded: Vec<bool>,
    /// The work of one timed pass.
    pub(super) work: Work,
    /// The median of the timed passes.
    pub(super) seconds: f64,
}

impl Answers {
    /// The number of rays with a hit, by one kind of answers.
    pub(super) fn hits(&self, any_hit: bool) -> usize {
        if any_hit {
            self.occluded.iter().filter(|&&occluded| occluded).count()
        } else {
            self.closest.iter().filter(|hit| !hit.is_miss()).count()
        }
    }
}

/// The work of a pass.
#[derive(Clone, Copy, Default)]
pub(super) struct Work {
    pub(super) tests: TestCounts,
    pub(super) kernels: Kernels,
}

impl Work {
    fn add(mut self, other: Self) -> Self {
        self.tests += other.tests;
        self.kernels += other.kernels;
        self
    }
}

/// Passes over the rays of `file`.
pub(super) struct Passes<'a> {
    accel: &'a Accel,
    file: &'a RayFile,
    tracer: TracerKind,
    /// One for each thread, reused between passes: allocating them is not part of the work.
    traversals: Vec<Traversal>,
}

impl<'a> Passes<'a> {
    pub(super) fn new(accel: &'a Accel, file: &'a RayFile, tracer: TracerKind) -> Self {
        let traversals = vec![accel.traversal(); rayon::current_num_threads()];
        Self { accel, file, tracer, traversals }
    }

    /// Times `repeats` passes with the query of the file, and runs the other query once.
    pub(super) fn run(mut self, repeats: u32) -> Answers {
        let (rays, any_hit) = (self.file.rays.len(), self.file.any_hit);
        let (mut closest, mut occluded) = (vec![Hit::MISS; rays], vec![false; rays]);
        let mut work = Work::default();
        let mut samples: Vec<f64> = Vec::new();
        for _ in 0..repeats {
            let start = Instant::now();
            work = if any_hit { self.occluded(&mut occluded) } else { self.closest(&mut closest) };
            samples.push(start.elapsed().as_secs_f64());
        }
        if any_hit {
            self.closest(&mut closest);
        } else {
            self.occluded(&mut occluded);
        }
        samples.sort_by(f64::total_cmp);
        Answers { closest, occluded, work, seconds: samples[samples.len() / 2] }
    }

    fn closest(&mut self, answers: &mut [Hit]) -> Work {
        self.pass(answers, |accel, rays, hits, t| accel.closest_of(rays, hits, t), Accel::closest)
    }

    fn occluded(&mut self, answers: &mut [bool]) -> Work {
        let many = |accel: &Accel, rays: &[Ray], found: &mut [bool], traversal: &mut Traversal| {
            accel.occluded_of(rays, found, traversal);
        };
        self.pass(answers, many, Accel::occluded)
    }

    /// Runs a query for every ray, block by block.
    fn pass<A: Send>(
        &mut self,
        answers: &mut [A],
        many: impl Fn(&Accel, &[Ray], &mut [A], &mut Traversal) + Sync,
        one: impl Fn(&Accel, &Ray, &mut Traversal) -> A + Sync,
    ) -> Work {
        let Self { accel, file, tracer, traversals } = self;
        let blocks = Mutex::new(answers.chunks_mut(BLOCK_RAYS).zip(file.rays.chunks(BLOCK_RAYS)));
        let next = || blocks.lock().unwrap_or_else(PoisonError::into_inner).next();
        let work = traversals.par_iter_mut().with_max_len(1).map(|traversal| {
            (traversal.tests, traversal.kernels) = Default::default();
            while let Some((answers, rays)) = next() {
                match tracer {
                    TracerKind::Wavefront => many(accel, rays, answers, traversal),
                    TracerKind::Recursive => {
                        for (answer, ray) in answers.iter_mut().zip(rays) {
                            *answer = one(accel, ray, traversal);
                        }
                    }
                }
            }
            Work { tests: traversal.tests, kernels: traversal.kernels }
        });
        work.reduce(Work::default, Work::add)
    }
}
