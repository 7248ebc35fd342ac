//! The wavefront tracer: batches of paths go through the passes in order, bounce after bounce
//! (Laine, Karras and Aila, *Megakernels Considered Harmful*, HPG 2013).
//!
//! [`crate::plan::schedule::PASSES`] lists the passes with their needs, reads and writes;
//! [`s1_generate`], [`s2_intersect`], [`s3_shade`], [`s4_shadow`] and [`s5_resolve`] have a method of
//! the tracer each. Passes outside the schedule do not run and have no columns: no lit points without lights,
//! no next rays without mirrors and transparent surfaces.
//!
//! A batch has [`DEFAULT_BATCH`] paths by default, so that its columns stay in the second-level
//! cache. All passes but the last process eight rows at a time as vectors where instructions are wide; rays are traced
//! in packets of their own size.

pub mod batch;
mod faces;
mod s1_generate;
mod s2_intersect;
mod s3_shade;
mod s4_shadow;
mod s5_resolve;
mod sight;

use std::marker::PhantomData;

use crate::accel::Traversal;
use crate::counters::Counters;
use crate::kernels::Arithmetic;
use crate::prepared::{MOST_RAYS, MediumStack, PreparedScene};
use crate::tile::{PassClock, TimedPass, Tracer, Unit};
use batch::Batch;
use faces::{GROUPS, SortedHits};

pub use sight::{Seen, Sight, sight};

/// The default number of paths in a batch.
pub const DEFAULT_BATCH: usize = 1024;

/// The tracer.
#[derive(Debug)]
pub struct Wavefront<P> {
    seed: u64,
    needs_points: bool,
    start: MediumStack,
    batch: Batch,
    traversal: Traversal,
    counters: Counters,
    clock: PassClock,
    precision: PhantomData<P>,
}

impl<P: Arithmetic> Wavefront<P> {
    /// The tracer for `scene`, with the seed of random numbers and the largest number of paths in a batch.
    pub fn new(scene: &PreparedScene, seed: u64, batch: usize) -> Self {
        let mut traversal = scene.accel.traversal();
        Self {
            seed,
            needs_points: scene.needs_points(),
            start: scene.media_at_camera::<P>(&mut traversal),
            batch: Batch::new(scene, batch),
            traversal,
            counters: Counters::default(),
            clock: PassClock::new(),
            precision: PhantomData,
        }
    }
}

impl<P: Arithmetic> Tracer for Wavefront<P> {
    fn render(
        &mut self,
        scene: &PreparedScene,
        unit: &Unit,
        sums: &mut [[f64; 3]],
        cancelled: &dyn Fn() -> bool,
    ) -> bool {
        self.traversal.without_t = !scene.needs_t();
        let (paths, schedule) = (unit.paths(), scene.plan.schedule());
        let mut start = 0;
        while start < paths {
            let end = paths.min(start + self.batch.capacity() as u64);
            self.timed(TimedPass::Generate, |own| own.generate(scene, unit, start..end));
            for bounce in 0.. {
                self.timed(TimedPass::Intersect, |own| own.intersect(scene));
                self.timed(TimedPass::Shade, |own| own.shade(scene, bounce));
                let is_lit = !schedule.has_shadows()
                    || self.timed(TimedPass::Shadow, |own| own.shadow(scene, bounce, cancelled));
                if !is_lit || cancelled() {
                    self.batch.waiting.clear();
                    return false;
                }
                if !(schedule.goes_on() && self.batch.advance()) {
                    break;
                }
                if bounce + 1 == MOST_RAYS {
                    self.counters.cut_short += self.batch.rays.len() as u64;
                    self.batch.waiting.clear();
                    break;
                }
                self.counters.rays.secondary += self.batch.rays.len() as u64;
            }
            self.timed(TimedPass::Resolve, |own| own.resolve(sums));
            start = end;
        }
        true
    }

    fn bytes(&self) -> u64 {
        self.batch.bytes()
    }

    fn counters(&self) -> Counters {
        let Traversal { tests, kernels, .. } = self.traversal;
        Counters { tests, kernels, ..self.counters }
    }

    fn pass_seconds(&self) -> Vec<(&'static str, f64)> {
        self.clock.by_name()
    }
}

impl<P: Arithmetic> Wavefront<P> {
    /// Does the work of a pass, and adds its time.
    fn timed<T>(&mut self, pass: TimedPass, work: impl FnOnce(&mut Self) -> T) -> T {
        self.clock.start();
        let done = work(self);
        self.clock.lap(pass);
        done
    }
}
