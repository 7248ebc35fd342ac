//! Timed passes over the rays of a file.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::prelude::*;

use wavecrest_core::accel::{Accel, Hit, Traversal};
use wavecrest_core::counters::Counters;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::render::TracerKind;
use wavecrest_report::ray_file::RayFile;

/// Rays for each task.
const BLOCK_RAYS: usize = 4096;

/// The answers and times.
pub(super) struct Answers {
    pub(super) closest: Vec<Hit>,
    pub(super) occluded: Vec<bool>,
    /// The tests and the rays of one timed pass.
    pub(super) work: Counters,
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

/// Times `repeats` passes with the query of the file, and runs the other query once.
pub(super) fn run(accel: &Accel, file: &RayFile, tracer: TracerKind, repeats: u32) -> Answers {
    let (mut closest, mut occluded) =
        (vec![Hit::MISS; file.rays.len()], vec![false; file.rays.len()]);
    // One for each thread, reused between passes: allocating them is not part of the work.
    let mut traversals = vec![accel.traversal(); rayon::current_num_threads()];
    let mut passes = |any_hit: bool| match any_hit {
        false => {
            let many = |rays: &[Ray], hits: &mut [Hit], t: &mut _| accel.closest_of(rays, hits, t);
            let one = |ray: &Ray, t: &mut _| accel.closest(ray, t);
            pass(&mut traversals, &file.rays, &mut closest, tracer, many, one)
        }
        true => {
            let many =
                |rays: &[Ray], found: &mut [bool], t: &mut _| accel.occluded_of(rays, found, t);
            let one = |ray: &Ray, t: &mut _| accel.occluded(ray, t);
            pass(&mut traversals, &file.rays, &mut occluded, tracer, many, one)
        }
    };
    let mut work = Counters::default();
    let mut samples: Vec<f64> = Vec::new();
    for _ in 0..repeats {
        let start = Instant::now();
        work = passes(file.any_hit);
        samples.push(start.elapsed().as_secs_f64());
    }
    passes(!file.any_hit);
    samples.sort_by(f64::total_cmp);
    Answers { closest, occluded, work, seconds: samples[samples.len() / 2] }
}

/// Runs a query for every ray, block by block.
fn pass<A: Send>(
    traversals: &mut [Traversal],
    rays: &[Ray],
    answers: &mut [A],
    tracer: TracerKind,
    many: impl Fn(&[Ray], &mut [A], &mut Traversal) + Sync,
    one: impl Fn(&Ray, &mut Traversal) -> A + Sync,
) -> Counters {
    let blocks = Mutex::new(answers.chunks_mut(BLOCK_RAYS).zip(rays.chunks(BLOCK_RAYS)));
    let next = || blocks.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work = traversals.par_iter_mut().with_max_len(1).map(|traversal| {
        (traversal.tests, traversal.kernels) = Default::default();
        while let Some((answers, rays)) = next() {
            match tracer {
                TracerKind::Wavefront => many(rays, answers, traversal),
                TracerKind::Recursive => {
                    for (answer, ray) in answers.iter_mut().zip(rays) {
                        *answer = one(ray, traversal);
                    }
                }
            }
        }
        let Traversal { tests, kernels, .. } = *traversal;
        Counters { tests, kernels, ..Counters::default() }
    });
    work.reduce(Counters::default, |mut all, own| {
        all += own;
        all
    })
}
