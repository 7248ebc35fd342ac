//! Passes over an image: each gives every pixel further samples, on top of all before.
//!
//! A render with a known number of samples is one pass. Towards a goal they follow one another, each with the next points
//! of one sequence, so that the image after any of them has the bits of a render with that number; its error is
//! measured on the way.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::checkpoint::Checkpoint;
use super::identity::Identity;
use super::part::{self, Author, PartHeader, Pass, StoredUnit};
use super::shard::Shard;
use wavecrest_base::error::{Error, Result};
use wavecrest_base::lock;
use wavecrest_core::film::Film;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::units::Grid;
use wavecrest_core::render::work::{RenderWork, Summed, Task, TaskList, run};
use wavecrest_core::render::{Painted, RenderOptions, Rendered, Watch};

/// An image, or a shard of one, whose pixels get more and more samples. It may be kept in a checkpoint.
pub struct Passes {
    options: RenderOptions,
    header: PartHeader,
    checkpoint: Option<Checkpoint>,
    grid: Grid,
    tiles: Vec<u32>,
    state: Mutex<State>,
    /// Pixels times samples of the pass: those finished.
    done: AtomicU64,
    /// The share of its pass that the checkpoint held, if there was one.
    resumed: Option<f64>,
    /// The time of the last save, and how long to wait for the next.
    last: Mutex<(Instant, Duration)>,
}

/// The passes so far.
#[derive(Debug, Default)]
struct State {
    pass: Pass,
    units: BTreeMap<u32, TileState>,
    /// Whether it is in no checkpoint yet.
    is_new: bool,
}

/// The sums of a tile, shared while they are saved and painted.
#[derive(Clone, Debug, Default)]
struct TileState {
    /// After the last pass that doubled the samples.
    half: Option<Arc<StoredUnit>>,
    /// At the end of the last finished pass.
    before: Option<Arc<StoredUnit>>,
    /// In the pass that is not finished.
    now: Option<Arc<StoredUnit>>,
}

/// The time between two saves is at least this many times the duration of a save, so that the
/// render of a huge image does not spend its time on checkpoints.
const PAUSE_FACTOR: u32 = 10;

impl Passes {
    /// Starts or resumes a render of `shard`, or of the whole image, with its `checkpoint`: one pass with all samples of
    /// the scene, or with `towards` a goal as many as [`Self::advance`] asks for, up to those of the scene.
    ///
    /// # Errors
    /// If the crop is not within the image, or the checkpoint is damaged, of another render, or
    /// exists but resuming was not requested.
    pub fn begin(
        scene: &PreparedScene,
        options: RenderOptions,
        author: Author,
        shard: Option<Shard>,
        (checkpoint, towards): (Option<Checkpoint>, bool),
    ) -> Result<Self> {
        let identity = Identity::of(scene, &options)?;
        let identity = if towards { identity.of_passes() } else { identity };
        let grid = identity.grid();
        let tiles = shard.unwrap_or(Shard::WHOLE).tiles(&grid);
        let pass = Pass { to: if towards { 0 } else { identity.samples }, ..Pass::default() };
        let header = PartHeader { identity, shard, author, pass, units: 0 };
        let held = checkpoint.as_ref().map_or(Ok(None), |checkpoint| checkpoint.load(&header))?;
        let is_resumed = held.is_some();
        let mut state = State { pass, is_new: !is_resumed, ..State::default() };
        let (mut found, units, misses) = held.unwrap_or((pass, Vec::new(), false));
        if misses {
            // What is missing is rendered first: without a finished pass.
            let to = if towards && found.from > 0 { found.from } else { found.to };
            found = Pass { to, error: found.error, ..Pass::default() };
        }
        state.pass = found;
        for unit in units.into_iter().filter(|unit| unit.samples <= found.to) {
            let tile = state.units.entry(unit.tile).or_default();
            let Pass { half, from, .. } = state.pass;
            let unit = Arc::new(unit);
            if unit.samples == half {
                tile.half = Some(Arc::clone(&unit));
            }
            if unit.samples == from {
                tile.before = Some(unit);
            } else if unit.samples > from {
                tile.now = Some(unit);
            }
        }
        let every = checkpoint.as_ref().map_or(Duration::MAX, |checkpoint| checkpoint.every);
        let last = Mutex::new((Instant::now(), every));
        let (state, done) = (Mutex::new(state), AtomicU64::new(0));
        let mut passes =
            Self { options, header, checkpoint, grid, tiles, state, done, resumed: None, last };
        passes.done = passes.finished().into();
        passes.resumed = is_resumed.then(|| passes.share());
        Ok(passes)
    }

    /// The share of its pass that the checkpoint held, from 0 to 1, if one was found.
    pub fn resumed(&self) -> Option<f64> {
        self.resumed
    }

    /// The finished passes: the number of samples of each pixel, and the error of the image if that is known. Also how
    /// many there are after a pass that is begun.
    pub fn pass(&self) -> Pass {
        lock(&self.state).pass
    }

    /// The share of the pass that is finished, from 0 to 1.
    pub fn share(&self) -> f64 {
        let Pass { from, to, .. } = self.pass();
        let all = self.pixels() * u64::from(to - from);
        // If there is no work, everything is finished.
        if all == 0 { 1.0 } else { self.done.load(Ordering::Relaxed) as f64 / all as f64 }
    }

    /// Whether every pixel has all samples of the scene.
    pub fn is_finished(&self) -> bool {
        self.tiles.is_empty() || self.pass().from == self.header.identity.samples
    }

    /// The number of pixels.
    fn pixels(&self) -> u64 {
        self.tiles.iter().map(|&tile| self.grid.tile(tile).len() as u64).sum()
    }

    /// Pixels times samples that are finished of the pass.
    fn finished(&self) -> u64 {
        let state = lock(&self.state);
        let of = |(&tile, state_of): (&u32, &TileState)| {
            let now = state_of.now.as_ref().map_or(0, |unit| unit.samples - state.pass.from);
            self.grid.tile(tile).len() as u64 * u64::from(now)
        };
        state.units.iter().map(of).sum()
    }

    /// Renders until every pixel has `to` samples: the pass that is begun comes first, if another one is. What `watch` ends
    /// goes on with the next call. A checkpoint that cannot be written is reported to `warn`, and the render continues.
    ///
    /// # Errors
    /// If an image cannot be decoded, or the plan's table of passes is inconsistent.
    pub fn advance(
        &self,
        scene: &PreparedScene,
        to: u32,
        watch: &dyn Watch,
        warn: &(dyn Fn(&Error) + Sync),
    ) -> Result<RenderWork> {
        let mut state = lock(&self.state);
        let Pass { from, to: begun, .. } = state.pass;
        let to = if begun > from { begun } else { to.max(from) };
        state.pass.to = to;
        let all = self.pixels();
        let pixels = AtomicU64::new(0);
        let paint = |summed: &Summed<'_>| {
            if summed.samples == to {
                let tile = self.grid.tile(summed.tile);
                watch.tile(&tile, &summed.means());
                let tile = tile.len() as u64;
                watch.progress(pixels.fetch_add(tile, Ordering::Relaxed) + tile, all);
            }
        };
        let (mut todo, mut done) = (Vec::new(), Vec::new());
        for &tile in &self.tiles {
            let TileState { before, now, .. } = state.units.entry(tile).or_default();
            let held = now.as_ref().or(before.as_ref());
            let samples = held.map_or(0, |unit| unit.samples);
            if samples < to {
                let sums = held.map(|unit| Arc::clone(&unit.sums));
                todo.push(Task { tile, samples: samples..to, sums });
            } else {
                done.extend(held.cloned());
            }
        }
        state.is_new |= !todo.is_empty();
        drop(state);
        done.iter().for_each(|unit| paint(&unit.summed()));
        let keep = |summed: &Summed<'_>| {
            let added = self.keep(summed);
            self.done.fetch_add(added, Ordering::Relaxed);
            paint(summed);
            self.save_if_due().unwrap_or_else(|error| warn(&error));
        };
        let task = |number: usize| todo[number].clone();
        let tasks =
            TaskList { grid: self.grid, samples: to - from, count: todo.len(), task: &task };
        let done = run(scene, &self.options, &tasks, watch, &keep)?;
        self.finish_pass();
        Ok(done)
    }

    /// Keeps the state of a tile. Returns its further samples, of all pixels.
    fn keep(&self, &Summed { tile, samples, invalid, sums }: &Summed<'_>) -> u64 {
        let mut state = lock(&self.state);
        let of = state.units.entry(tile).or_default();
        let known = of.now.as_ref().or(of.before.as_ref()).map_or(0, |unit| unit.samples);
        let invalid = invalid + of.before.as_ref().map_or(0, |before| before.invalid);
        of.now = Some(Arc::new(StoredUnit { tile, samples, invalid, sums: sums.into() }));
        sums.len() as u64 * u64::from(samples - known)
    }

    /// Ends the pass if every tile has its samples, and measures the error of the image.
    fn finish_pass(&self) {
        let mut state = lock(&self.state);
        let Pass { from, to, .. } = state.pass;
        let ends = |of: &TileState| of.now.as_ref().is_some_and(|unit| unit.samples == to);
        if to == from || !self.tiles.iter().all(|tile| state.units.get(tile).is_some_and(ends)) {
            return;
        }
        let doubles = to >= 2 * state.pass.half;
        let squared = difference(state.units.values());
        state.pass = squared.map_or(state.pass, |squared| state.pass.measured(squared));
        (state.pass.from, state.pass.half) = (to, if doubles { to } else { state.pass.half });
        for TileState { half, before, now } in state.units.values_mut() {
            *before = now.take();
            if doubles {
                half.clone_from(before);
            }
        }
        self.done.store(0, Ordering::Relaxed);
    }

    /// Renders the whole image, or the rest of it, in one pass.
    ///
    /// # Errors
    /// As [`Self::advance`], or if there is no memory for the film.
    pub fn render(
        &self,
        scene: &PreparedScene,
        watch: &dyn Watch,
        warn: &(dyn Fn(&Error) + Sync),
    ) -> Result<Rendered> {
        let work = self.advance(scene, self.header.identity.samples, watch, warn)?;
        self.save(warn);
        Ok(Rendered::new(self.painted()?, work))
    }

    /// The image: after the last finished pass, or before that the finished tiles of the first.
    ///
    /// # Errors
    /// If there is no memory for the film.
    pub fn painted(&self) -> Result<Painted> {
        let state = lock(&self.state);
        let window = self.grid.window;
        let (film, tiles) = (Film::new(window.width, window.height)?, Vec::new());
        let mut painted = Painted { film, tiles, pixels: 0 };
        for (&number, TileState { before, now, .. }) in &state.units {
            let is_whole = |unit: &&Arc<StoredUnit>| unit.samples == state.pass.to;
            let Some(unit) = before.as_ref().or(now.as_ref().filter(is_whole)) else { continue };
            let tile = self.grid.tile(number);
            let corner = [tile.x - window.x, tile.y - window.y];
            painted.film.paste(corner, tile.width, &unit.summed().means());
            painted.tiles.push(tile);
            painted.pixels += tile.len() as u64;
        }
        Ok(painted)
    }

    /// Writes what is finished as a part.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let (pass, units): (Pass, Vec<Arc<StoredUnit>>) = {
            let state = lock(&self.state);
            let all = |of: &TileState| {
                let half = of.half.clone().filter(|_| state.pass.half < state.pass.from);
                [half, of.before.clone(), of.now.clone()]
            };
            (state.pass, state.units.values().flat_map(all).flatten().collect())
        };
        let header = PartHeader { pass, units: units.len() as u64, ..self.header.clone() };
        part::write(path, &header, units.iter().map(|unit| &**unit))
    }

    /// Saves the checkpoint, if there is one and it has not all.
    pub fn save(&self, warn: &(dyn Fn(&Error) + Sync)) {
        let is_new = std::mem::take(&mut lock(&self.state).is_new);
        if let Some(checkpoint) = self.checkpoint.as_ref().filter(|_| is_new) {
            self.write(&checkpoint.file).unwrap_or_else(|error| warn(&error));
        }
    }

    /// Saves what is finished if it is due. Other threads continue; none of them saves too.
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

impl Pass {
    /// After a finished pass, for which the difference between the samples that were there when their number was last
    /// doubled and all since has this mean square.
    ///
    /// For a samples with the error e and b more with the error f, both unbiased and independent, that is e^2 + f^2, and
    /// the squared error of the mean of all (a^2 e^2 + b^2 f^2) / (a + b)^2. Where b is a, that is a fourth of the
    /// difference, whatever e is. But the halves of a sequence complement each other: the error of the whole is to that
    /// of independent halves as the fall of the error in a doubling is to that of independent points. So much is
    /// taken off, by the fall in the doubling before; no more than for the steepest that there is, the power -3/2.
    fn measured(self, squared: f64) -> Self {
        let [a, b] = [self.half, self.to - self.half].map(f64::from);
        if b < a {
            let Some([e, _]) = self.half_error else { return self };
            let f = (squared - e * e).max(0.0).sqrt();
            return Self { error: Some((a * e).hypot(b * f) / (a + b)), ..self };
        }
        let found = squared.sqrt() * (a * b).sqrt() / (a + b);
        let fall = self.half_error.map_or(1.0, |[_, before]| found / before);
        let gain = (fall * std::f64::consts::SQRT_2).clamp(0.5, 1.0);
        let error = if gain.is_nan() { found } else { found * gain };
        Self { error: Some(error), half_error: Some([error, found]), ..self }
    }
}

/// The mean square of the difference between the mean of the samples at the last doubling and that of all since. `None`
/// if nothing was before.
fn difference<'a>(tiles: impl Iterator<Item = &'a TileState>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_u64);
    for of in tiles {
        let (Some(half), Some(now)) = (&of.half, &of.now) else { continue };
        let [first, later] = [half.samples, now.samples - half.samples].map(f64::from);
        let pairs = half.sums.as_flattened().iter().zip(now.sums.as_flattened());
        sum += pairs.fold(0.0, |sum, (a, s)| {
            let difference = a / first - (s - a) / later;
            sum + difference * difference
        });
        count += now.sums.as_flattened().len() as u64;
    }
    (count > 0).then(|| sum / count as f64)
}
