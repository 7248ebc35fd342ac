//! The loop over all work on all threads, each with its own tracer.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use super::{Backdrop, Grid, RenderOptions, TracerKind, Watch, batch_size};
use crate::counters::Counters;
use crate::kernels::Precision;
use crate::prepared::PreparedScene;
use crate::recursive::Recursive;
use crate::tile::{Tracer, Unit};
use crate::wavefront::Wavefront;
use crate::with_precision;
use wavecrest_base::error::Result;
use wavecrest_base::memory::Stage;
use wavecrest_base::parallel::with_state;

/// Samples to render for the pixels of a tile.
#[derive(Clone, Debug)]
pub struct Task {
    /// The tile's number in the grid.
    pub tile: u32,
    /// The samples.
    pub samples: Range<u32>,
    /// For each pixel of the tile, the sum of all samples before these; none if these are the first.
    pub sums: Option<Arc<[[f64; 3]]>>,
}

/// The samples of a tile so far, with their sum for each pixel, row by row.
#[derive(Clone, Debug)]
pub struct Summed<'a> {
    /// The tile's number in the grid.
    pub tile: u32,
    /// The number of samples of each pixel.
    pub samples: u32,
    /// How many of those of this render were not finite.
    pub invalid: u64,
    /// Their sums.
    pub sums: &'a [[f64; 3]],
}

impl Summed<'_> {
    /// The mean of each pixel.
    pub fn means(&self) -> Vec<[f32; 3]> {
        let samples = f64::from(self.samples);
        self.sums.iter().map(|sum| sum.map(|s| (s / samples) as f32)).collect()
    }
}

/// The work to render: `count` tasks, by number.
pub struct TaskList<'a> {
    /// The tiles.
    pub grid: Grid,
    /// The largest number of samples of a task.
    pub samples: u32,
    /// Number of tasks.
    pub count: usize,
    /// The task with this number. No two tasks have the same tile.
    pub task: &'a (dyn Fn(usize) -> Task + Sync),
}

/// Number of samples of a pixel after which the state of a tile is passed on: enough for that not to matter.
const STRIDE: u32 = 256;

/// The work of a render.
#[derive(Clone, Debug)]
pub struct RenderWork {
    /// The work, counted.
    pub counters: Counters,
    /// Bytes of the columns of all threads' batches.
    pub columns: u64,
    /// Seconds in each pass, summed over threads.
    pub pass_seconds: Vec<(&'static str, f64)>,
    /// Seconds from start to end.
    pub seconds: f64,
    /// The precision of its hits.
    pub precision: Precision,
}

impl RenderWork {
    /// The work to add nothing to an image of `scene`.
    pub fn none(scene: &PreparedScene) -> Self {
        gather(Vec::new(), Instant::now(), scene.accel.geometry().precision)
    }

    /// Adds the work of a further pass.
    pub fn add(&mut self, other: Self) {
        self.counters += other.counters;
        self.columns = self.columns.max(other.columns);
        self.seconds += other.seconds;
        add_seconds(&mut self.pass_seconds, other.pass_seconds);
    }
}

/// Adds the seconds of passes, by their order.
fn add_seconds(all: &mut Vec<(&'static str, f64)>, more: Vec<(&'static str, f64)>) {
    for (index, (name, seconds)) in more.into_iter().enumerate() {
        match all.get_mut(index) {
            Some(sum) => sum.1 += seconds,
            None => all.push((name, seconds)),
        }
    }
}

/// Renders `tasks` on the threads of the current pool, and passes the state of a tile to `keep` at its end, and now and
/// then before. `watch` may end it early.
///
/// # Errors
/// If an image cannot be decoded.
pub fn run(
    scene: &PreparedScene,
    options: &RenderOptions,
    tasks: &TaskList<'_>,
    watch: &dyn Watch,
    keep: &(dyn Fn(&Summed<'_>) + Sync),
) -> Result<RenderWork> {
    Stage::Trace.begin();
    let start = Instant::now();
    let backdrop = Backdrop::of(scene);
    let options = RenderOptions { batch: batch_size(tasks, options.batch), ..*options };
    let worker = || Worker::new(tracer(scene, &options), tasks);
    let workers = with_state(0..tasks.count, worker, |worker, number| {
        if !watch.cancelled() && scene.appearance.check().is_ok() {
            worker.render(&backdrop, tasks, &(tasks.task)(number), watch, keep);
        }
    });
    scene.appearance.check()?;
    Ok(gather(workers, start, scene.accel.geometry().precision))
}

/// A tracer, and the sums of its current tile.
struct Worker {
    tracer: Box<dyn Tracer>,
    sums: Vec<[f64; 3]>,
}

impl Worker {
    fn new(tracer: Box<dyn Tracer>, tasks: &TaskList<'_>) -> Self {
        Self { tracer, sums: vec![[0.0; 3]; tasks.grid.edge as usize * tasks.grid.edge as usize] }
    }

    fn render(
        &mut self,
        backdrop: &Backdrop<'_>,
        tasks: &TaskList<'_>,
        Task { tile: number, samples, sums: before }: &Task,
        watch: &dyn Watch,
        keep: &(dyn Fn(&Summed<'_>) + Sync),
    ) {
        let (tile, tracer) = (tasks.grid.tile(*number), &mut self.tracer);
        let sums = &mut self.sums[..tile.len()];
        match before {
            Some(before) => sums.copy_from_slice(before),
            None => sums.fill([0.0; 3]),
        }
        let invalid = tracer.counters().invalid;
        let is_backdrop = backdrop.fills(&tile);
        for start in samples.clone().step_by(STRIDE as usize) {
            // The loop over tasks has checked before the first ones.
            if start > samples.start && watch.cancelled() {
                return;
            }
            let end = samples.end.min(start.saturating_add(STRIDE));
            let unit = Unit { tile, samples: start..end };
            if is_backdrop {
                backdrop.add(&unit, sums);
            } else if !tracer.render(backdrop.scene, &unit, sums, &|| watch.cancelled()) {
                return;
            }
            let invalid = tracer.counters().invalid - invalid;
            keep(&Summed { tile: *number, samples: end, invalid, sums });
        }
    }
}

/// A tracer of the scene, compiled for its precision.
pub fn tracer(scene: &PreparedScene, options: &RenderOptions) -> Box<dyn Tracer> {
    let RenderOptions { tracer, seed, batch, .. } = *options;
    with_precision!(scene.accel.geometry().precision, P => match tracer {
        TracerKind::Wavefront => Box::new(Wavefront::<P>::new(scene, seed, batch)),
        TracerKind::Recursive => Box::new(Recursive::<P>::new(scene, seed)),
    })
}

/// Adds up the counts of the tracers.
fn gather(workers: Vec<Worker>, start: Instant, precision: Precision) -> RenderWork {
    let mut counters = Counters::default();
    let mut pass_seconds: Vec<(&'static str, f64)> = Vec::new();
    let mut columns = 0;
    for Worker { tracer, .. } in workers {
        counters += tracer.counters();
        columns += tracer.bytes();
        add_seconds(&mut pass_seconds, tracer.pass_seconds());
    }
    let seconds = start.elapsed().as_secs_f64();
    RenderWork { counters, columns, pass_seconds, seconds, precision }
}
