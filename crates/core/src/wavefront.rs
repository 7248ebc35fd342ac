//! The wavefront tracer: batches of paths go through the passes in order, bounce after bounce
//! (Laine, Karras and Aila, *Megakernels Considered Harmful*, HPG 2013).
//!
//! [`crate::plan::schedule::PASSES`] lists the passes with their needs, reads and writes;
//! [`s1_generate`], [`s2_intersect`], [`s3_shade`], [`s4_shadow`] and [`s5_resolve`] implement
//! them. Passes outside the schedule do not run and have no columns: no lit points without lights,
//! no next rays without mirrors and transparent surfaces.
//!
//! A batch has [`DEFAULT_BATCH`] paths by default, so that its columns stay in the second-level
//! cache. All passes but the last process eight rows at a time, as vectors.

pub mod batch;
mod faces;
mod s1_generate;
mod s2_intersect;
mod s3_shade;
mod s4_shadow;
mod s5_resolve;

use std::marker::PhantomData;
use std::ops::Range;

use crate::accel::Traversal;
use crate::counters::Counters;
use crate::kernels::precision::Arithmetic;
use crate::plan::schedule::Schedule;
use crate::prepared::{LookUps, MOST_RAYS, MediumStack, PreparedScene};
use crate::tile::{PassClock, TimedPass, TraceSettings, Tracer, Unit};
use batch::Batch;

/// The default number of paths in a batch.
pub const DEFAULT_BATCH: usize = 1024;

/// The tracer.
#[derive(Debug)]
pub struct Wavefront<P> {
    seed: u64,
    schedule: Schedule,
    needs_points: bool,
    start: MediumStack,
    batch: Batch,
    traversal: Traversal,
    counters: Counters,
    clock: PassClock,
    precision: PhantomData<P>,
}

impl<P: Arithmetic> Tracer for Wavefront<P> {
    fn new(scene: &PreparedScene, settings: &TraceSettings) -> Self {
        let schedule = scene.plan.schedule();
        let mut traversal = scene.accel.traversal();
        traversal.notes_passed = schedule.has_transmission();
        Self {
            seed: settings.seed,
            schedule,
            needs_points: scene.needs_points(),
            start: scene.media_at_camera::<P>(&mut traversal),
            batch: Batch::new(scene, settings.batch),
            traversal,
            counters: Counters::default(),
            clock: PassClock::new(),
            precision: PhantomData,
        }
    }

    fn render(
        &mut self,
        scene: &PreparedScene,
        unit: &Unit,
        sums: &mut [[f64; 3]],
        cancelled: &dyn Fn() -> bool,
    ) -> bool {
        self.traversal.without_t = !scene.needs_t();
        self.render_watched(scene, unit, sums, cancelled, |_, _| {})
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

/// The passes over the batch, each timed.
impl<P: Arithmetic> Wavefront<P> {
    /// As [`Tracer::render`]; `watch` receives the batch after each bounce, with the number of the
    /// bounce.
    pub fn render_watched(
        &mut self,
        scene: &PreparedScene,
        unit: &Unit,
        sums: &mut [[f64; 3]],
        cancelled: &dyn Fn() -> bool,
        mut watch: impl FnMut(u32, &Batch),
    ) -> bool {
        let paths = unit.paths();
        let mut start = 0;
        while start < paths {
            let end = paths.min(start + self.batch.capacity() as u64);
            self.generate(scene, unit, start..end);
            for bounce in 0.. {
                self.intersect(scene);
                self.shade(scene, bounce);
                let is_lit = !self.schedule.has_shadows() || self.shadow(scene, bounce, cancelled);
                watch(bounce, &self.batch);
                if !is_lit || cancelled() {
                    self.batch.waiting.clear();
                    return false;
                }
                if !(self.schedule.goes_on() && self.batch.advance()) {
                    break;
                }
                if bounce + 1 == MOST_RAYS {
                    self.counters.cut_short += self.batch.rays.len() as u64;
                    self.batch.waiting.clear();
                    break;
                }
                self.counters.secondary_rays += self.batch.rays.len() as u64;
            }
            self.resolve(sums);
            start = end;
        }
        true
    }

    /// Fills the batch with the camera rays of the unit's `paths`, at most its capacity.
    pub fn generate(&mut self, scene: &PreparedScene, unit: &Unit, paths: Range<u64>) {
        let Self { seed, batch, counters, clock, .. } = self;
        clock.time(TimedPass::Generate, || {
            s1_generate::run(scene, unit, *seed, paths, batch, counters)
        });
    }

    /// Finds the closest hit of every ray.
    pub fn intersect(&mut self, scene: &PreparedScene) {
        let Self { batch, traversal, clock, .. } = self;
        clock.time(TimedPass::Intersect, || s2_intersect::run::<P>(scene, batch, traversal));
    }

    /// Adds the light of hits without further rays, and collects lit points and the next rays.
    pub fn shade(&mut self, scene: &PreparedScene, bounce: u32) {
        let Self { needs_points, start, batch, traversal, counters, clock, .. } = self;
        clock.start();
        let given = (bounce, *needs_points, *start);
        s3_shade::run::<P>(scene, given, batch, traversal, counters, clock);
        clock.lap(TimedPass::Shade);
    }

    /// Adds the light of unoccluded shadow rays. Returns whether it did so for all: it was not
    /// `cancelled`.
    pub fn shadow(
        &mut self,
        scene: &PreparedScene,
        bounce: u32,
        cancelled: &dyn Fn() -> bool,
    ) -> bool {
        let Self { seed, batch, traversal, counters, clock, .. } = self;
        let place = (*seed, bounce);
        clock.time(TimedPass::Shadow, || {
            s4_shadow::run::<P>(scene, place, batch, traversal, counters, cancelled)
        })
    }

    /// Adds the paths to their pixels' `sums`.
    pub fn resolve(&mut self, sums: &mut [[f64; 3]]) {
        let Self { batch, counters, clock, .. } = self;
        clock.time(TimedPass::Resolve, || s5_resolve::run(batch, sums, counters));
    }
}

/// Adds look-ups to the counters.
fn count(look_ups: LookUps, counters: &mut Counters) {
    counters.look_ups += look_ups;
}
