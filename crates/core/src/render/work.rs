//! The loop over all work on all threads, each with its own tracer.

use std::borrow::Cow;
use std::ops::Range;
use std::time::Instant;

use super::{Backdrop, Blocks, Grid, RenderOptions, TracerKind, Watch, batch_size};
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

/// Blocks of samples to render for the pixels of a tile.
#[derive(Clone, Debug)]
pub struct Task {
    /// The tile's number in the grid.
    pub tile: u32,
    /// The blocks. If they do not start with the first and there are no `sums`, there is only one.
    pub blocks: Range<u32>,
    /// For each pixel of the tile, the sum of the blocks before these; all their samples were
    /// finite.
    pub sums: Option<Vec<[f64; 3]>>,
}

/// The rendered blocks of a tile so far, with their sum for each pixel, row by row.
#[derive(Clone, Debug)]
pub struct Summed<'a> {
    /// The tile's number in the grid.
    pub tile: u32,
    /// The blocks: all up to some block, or a single one.
    pub blocks: Range<u32>,
    /// Number of their samples that were not finite.
    pub invalid: u64,
    /// Their sums.
    pub sums: Cow<'a, [[f64; 3]]>,
}

/// The work to render: `count` tasks, by number.
pub struct TaskList<'a> {
    /// The tiles.
    pub grid: Grid,
    /// The blocks of each pixel.
    pub blocks: Blocks,
    /// Number of tasks.
    pub count: usize,
    /// The task with this number. No two tasks share a block of a tile.
    pub task: &'a (dyn Fn(usize) -> Task + Sync),
}

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

/// Renders `tasks` on the threads of the current pool, and passes the state of a tile to `keep` after
/// each block. `watch` may end it early.
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
    let options = RenderOptions { batch: batch_size(scene, options.batch), ..*options };
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
    /// The sums of the current block, if there are several.
    block: Vec<[f64; 3]>,
}

impl Worker {
    fn new(tracer: Box<dyn Tracer>, tasks: &TaskList<'_>) -> Self {
        let pixels = tasks.grid.edge as usize * tasks.grid.edge as usize;
        let block = if tasks.blocks.count() > 1 { pixels } else { 0 };
        Self { tracer, sums: vec![[0.0; 3]; pixels], block: vec![[0.0; 3]; block] }
    }

    fn render(
        &mut self,
        backdrop: &Backdrop<'_>,
        tasks: &TaskList<'_>,
        task: &Task,
        watch: &dyn Watch,
        keep: &(dyn Fn(&Summed<'_>) + Sync),
    ) {
        let tile = tasks.grid.tile(task.tile);
        let Self { tracer, sums, block } = self;
        let sums = &mut sums[..tile.len()];
        let first = match &task.sums {
            Some(before) => {
                sums.copy_from_slice(before);
                0
            }
            None => task.blocks.start,
        };
        let invalid = tracer.counters().invalid;
        let is_backdrop = backdrop.fills(&tile);
        for number in task.blocks.clone() {
            // The loop over tasks has checked before the first block.
            if number > task.blocks.start && watch.cancelled() {
                return;
            }
            let unit = Unit { tile, samples: tasks.blocks.range(number) };
            let own = if number == first { &mut *sums } else { &mut block[..tile.len()] };
            own.fill([0.0; 3]);
            if is_backdrop {
                backdrop.add(&unit, own);
            } else if !tracer.render(backdrop.scene, &unit, own, &|| watch.cancelled()) {
                return;
            }
            if number != first {
                add(sums, &block[..tile.len()]);
            }
            let invalid = tracer.counters().invalid - invalid;
            let (blocks, sums) = (first..number + 1, Cow::Borrowed(&*sums));
            keep(&Summed { tile: task.tile, blocks, invalid, sums });
        }
    }
}

/// Adds a block to the blocks before it.
pub fn add(sums: &mut [[f64; 3]], block: &[[f64; 3]]) {
    for (sum, value) in sums.as_flattened_mut().iter_mut().zip(block.as_flattened()) {
        *sum += value;
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
        for (index, (name, seconds)) in tracer.pass_seconds().into_iter().enumerate() {
            match pass_seconds.get_mut(index) {
                Some(sum) => sum.1 += seconds,
                None => pass_seconds.push((name, seconds)),
            }
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    RenderWork { counters, columns, pass_seconds, seconds, precision }
}
