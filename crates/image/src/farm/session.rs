//! A session: one run of the program that renders an image or a shard, with a checkpoint, and may
//! resume from it.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::checkpoint::{Checkpoint, UnitStore};
use super::identity::Identity;
use super::part::{Author, PartHeader};
use super::shard::Shard;
use wavecrest_base::error::{Error, Result};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::units::Grid;
use wavecrest_core::render::work::{RenderWork, Summed, Task, TaskList, run};
use wavecrest_core::render::{Canvas, RenderOptions, Rendered, Watch};

/// The work to render, and its state.
pub struct Session<'a> {
    scene: &'a PreparedScene,
    options: RenderOptions,
    header: PartHeader,
    checkpoint: Option<Checkpoint>,
    grid: Grid,
    store: UnitStore,
    todo: Vec<Task>,
    /// Pixels times blocks: all, and those finished.
    all: u64,
    done: AtomicU64,
    /// The part of `done` that came from a checkpoint, if there was one.
    resumed: Option<u64>,
    /// The time of the last save, and how long to wait for the next.
    last: Mutex<(Instant, Duration)>,
}

/// The time between two saves is at least this many times the duration of a save, so that the
/// render of a huge image does not spend its time on checkpoints.
const PAUSE_FACTOR: u32 = 10;

impl<'a> Session<'a> {
    /// Starts or resumes a render of `shard`, or of the whole image, with its `checkpoint`.
    ///
    /// # Errors
    /// If the crop is not within the image, or the checkpoint is damaged, of another render, or
    /// exists but resuming was not requested.
    pub fn begin(
        scene: &'a PreparedScene,
        options: RenderOptions,
        author: Author,
        shard: Option<Shard>,
        checkpoint: Option<Checkpoint>,
    ) -> Result<Self> {
        let identity = Identity::of(scene, &options)?;
        let grid = identity.grid();
        let header = PartHeader { identity, shard, author, units: 0 };
        let held = checkpoint.as_ref().map_or(Ok(None), |checkpoint| checkpoint.load(&header))?;
        let is_resumed = held.is_some();
        let store = held.unwrap_or_default();
        let tasks = shard.unwrap_or(Shard::WHOLE).tasks(&grid, header.identity.blocks());
        let size = |tasks: &[Task]| -> u64 {
            let one = |task: &Task| grid.tile(task.tile).len() as u64 * task.blocks.len() as u64;
            tasks.iter().map(one).sum()
        };
        let all = size(&tasks);
        let todo: Vec<Task> = tasks.into_iter().filter_map(|task| store.rest(task)).collect();
        let resumed = all - size(&todo);
        let (done, resumed) = (AtomicU64::new(resumed), is_resumed.then_some(resumed));
        let every = checkpoint.as_ref().map_or(Duration::MAX, |checkpoint| checkpoint.every);
        let last = Mutex::new((Instant::now(), every));
        Ok(Self { scene, options, header, checkpoint, grid, store, todo, all, done, resumed, last })
    }

    /// The share of the work that the checkpoint held, from 0 to 1, if one was found.
    pub fn resumed(&self) -> Option<f64> {
        self.resumed.map(|resumed| self.part_of_all(resumed))
    }

    /// The share of the work that is finished, from 0 to 1.
    pub fn share(&self) -> f64 {
        self.part_of_all(self.done.load(Ordering::Relaxed))
    }

    /// If there is no work, everything is finished.
    fn part_of_all(&self, part: u64) -> f64 {
        if self.all == 0 { 1.0 } else { part as f64 / self.all as f64 }
    }

    /// Renders the whole image, or the rest of it. A checkpoint that cannot be written is reported
    /// to `warn`, and the render continues.
    ///
    /// # Errors
    /// If there is no memory for the film, or the plan's table of passes is inconsistent.
    pub fn render(&self, watch: &dyn Watch, warn: &(dyn Fn(&Error) + Sync)) -> Result<Rendered> {
        let canvas = Canvas::new(self.grid, self.header.identity.blocks(), watch)?;
        self.store.all().iter().for_each(|unit| canvas.keep(unit));
        let done = self.run(watch, warn, &|summed| canvas.keep(summed))?;
        Ok(Rendered::new(canvas.finish(), done))
    }

    /// Renders the units, or the rest of them, without an image, and returns the work done. `warn`
    /// as for [`Session::render`].
    ///
    /// # Errors
    /// If the plan's table of passes is inconsistent.
    pub fn render_units(
        &self,
        watch: &dyn Watch,
        warn: &(dyn Fn(&Error) + Sync),
    ) -> Result<RenderWork> {
        let each = u64::from(self.header.identity.blocks().count());
        self.run(watch, warn, &|_| {
            watch.progress(self.done.load(Ordering::Relaxed) / each, self.all.div_ceil(each));
        })
    }

    /// Writes the finished units as a part.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        self.store.write(path, &self.header)
    }

    fn run(
        &self,
        watch: &dyn Watch,
        warn: &(dyn Fn(&Error) + Sync),
        finished: &(dyn Fn(&Summed<'_>) + Sync),
    ) -> Result<RenderWork> {
        let keep = |summed: &Summed<'_>| {
            self.store.keep(summed);
            let pixels = self.grid.tile(summed.tile).len() as u64;
            self.done.fetch_add(pixels, Ordering::Relaxed);
            finished(summed);
            self.save_if_due().unwrap_or_else(|error| warn(&error));
        };
        let task = |number: usize| self.todo[number].clone();
        let blocks = self.header.identity.blocks();
        let tasks = TaskList { grid: self.grid, blocks, count: self.todo.len(), task: &task };
        let done = run(self.scene, &self.options, &tasks, watch, &keep)?;
        // A checkpoint that held everything stays unchanged.
        let is_new = !self.todo.is_empty() || self.resumed.is_none();
        if let Some(checkpoint) = self.checkpoint.as_ref().filter(|_| is_new) {
            self.write(&checkpoint.file).unwrap_or_else(|error| warn(&error));
        }
        Ok(done)
    }

    /// Saves the finished units if it is due. Other threads continue; none of them saves too.
    fn save_if_due(&self) -> Result<()> {
        let Some(checkpoint) = &self.checkpoint else { return Ok(()) };
        let Ok(mut last) = self.last.try_lock() else { return Ok(()) };
        let (at, pause) = *last;
        if at.elapsed() < pause {
            return Ok(());
        }
        let start = Instant::now();
        let saved = self.write(&checkpoint.file);
        let pause = checkpoint.every.max(start.elapsed().saturating_mul(PAUSE_FACTOR));
        *last = (Instant::now(), pause);
        saved
    }
}
