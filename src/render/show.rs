//! Progress, log, viewer and unfinished image of a render.
//!
//! Failures here never end a render: they are warnings at most.

mod live;
mod log;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use serde_json::json;

use super::args::{RenderArgs, Style};
use super::outputs::Outputs;
use crate::common::{progress_bar, tell};
use crate::interrupt;
use live::Live;
use log::Log;
use wavecrest_base::error::{Error, Result};
use wavecrest_core::film::Film;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::Watch;
use wavecrest_core::tile::Tile;
use wavecrest_image::metadata::Entry;
use wavecrest_report::accuracy::pilot::budget::Pace;

/// A render: what is requested, its files, and the channels that show it, during and after it.
pub(super) struct Rendering<'a> {
    pub(super) args: &'a RenderArgs,
    pub(super) outputs: &'a Outputs<'a>,
    pub(super) reporter: &'a Reporter,
}

/// Reports on a command from its start to its end.
pub(super) struct Reporter {
    progress: ProgressDisplay,
    pub(super) log: Log,
}

impl Reporter {
    /// Starts the requested reports.
    ///
    /// # Errors
    /// If the log cannot be written to.
    pub(super) fn begin(args: &RenderArgs) -> Result<Self> {
        let log = Log::open(args.log.as_deref())?;
        let progress = ProgressDisplay::new(args.progress, args.scene_options.quiet);
        Ok(Self { progress, log })
    }

    /// A stage starts.
    pub(super) fn stage(&self, stage: Stage) {
        self.progress.stage(stage);
        if stage != Stage::Done {
            self.log.note(stage.name(), || "begins".to_owned());
        }
    }

    /// An entry for the log only.
    pub(super) fn note(&self, topic: &str, text: impl FnOnce() -> String) {
        self.log.note(topic, text);
    }

    /// The value, or a warning with the reason for none.
    fn or_warn<T>(&self, made: Result<T>) -> Option<T> {
        made.map_err(|error| self.warn(&error)).ok()
    }

    /// A warning, printed even with `--quiet`.
    pub(super) fn warn(&self, error: &Error) {
        tell(&format!("warning: {error}"));
        self.note("warning", || error.to_string());
    }
}

/// Shows one render on the requested channels: the reporter's, the viewer and the file. Ends it on a
/// signal, or if it is too slow.
pub(super) struct Show<'a> {
    rendering: &'a Rendering<'a>,
    live: Option<Live>,
    saver: Option<ImageSaver<'a>>,
    pace: Option<&'a Pace<'a>>,
}

impl<'a> Show<'a> {
    /// Begins to show the render of `scene`.
    pub(super) fn begin(
        rendering: &'a Rendering<'a>,
        scene: &PreparedScene,
        pace: Option<&'a Pace<'a>>,
    ) -> Self {
        let Rendering { args, outputs, reporter } = *rendering;
        reporter.stage(Stage::Trace);
        let [width, height] = scene.camera.size();
        let window = args.crop.unwrap_or(Tile { x: 0, y: 0, width, height });
        let live = args
            .tev
            .as_ref()
            .and_then(|address| reporter.or_warn(Live::connect(address, &outputs.name(), window)));
        let saver = args
            .save_every
            .and_then(|seconds| reporter.or_warn(ImageSaver::new(outputs, scene, window, seconds)));
        Self { rendering, live, saver, pace }
    }
}

impl Watch for Show<'_> {
    fn progress(&self, done: u64, all: u64) {
        self.rendering.reporter.progress.update(done, all);
        if let Some(pace) = self.pace {
            pace.progress(done, all);
        }
    }

    fn tile(&self, tile: &Tile, pixels: &[[f32; 3]]) {
        if let Some(live) = &self.live {
            live.send(tile, pixels);
        }
        if let Some(saver) = &self.saver
            && let Err(error) = saver.keep(tile, pixels)
        {
            self.rendering.reporter.warn(&error);
        }
    }

    fn cancelled(&self) -> bool {
        interrupt::signal().is_some() || self.pace.is_some_and(Pace::is_late)
    }
}

impl Drop for Show<'_> {
    fn drop(&mut self) {
        self.rendering.reporter.progress.pause();
        if let Some(error) = self.live.take().and_then(Live::finish) {
            self.rendering.reporter.warn(&error);
        }
    }
}

/// The template of the bar.
const BAR: &str = "{wide_bar} {percent:>3} % {millions} Mpixels/s, {eta} left";

/// The shortest interval between two lines of one stage.
const INTERVAL: Duration = Duration::from_millis(100);

wavecrest_base::choices! {
    /// A stage of a render. Names are those in lines of progress and in the log.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Stage {
        /// Reading the scene and its meshes.
        Load = "load",
        /// Building the tree.
        Build = "build",
        /// Following rays.
        Trace = "trace",
        /// Writing files.
        Write = "write",
        /// Nothing any more.
        Done = "done",
    }
}

/// Progress on standard error, in one style: a bar for people, lines of JSON for programs.
///
/// A line of JSON has the keys `stage` (`load`, `build`, `trace`, `write`, `done`), `done` and
/// `all` (pixels; `all` is null until it is known), `seconds` since the start, and `left`, the
/// estimated remaining seconds of tracing (null if unknown). Each stage starts with a line; tracing
/// prints at most ten a second, and one at the end.
struct ProgressDisplay {
    bar: ProgressBar,
    lines: Option<Mutex<Lines>>,
}

/// The state behind the lines of JSON.
struct Lines {
    start: Instant,
    stage: Stage,
    /// The start of the stage, and the time of the last line.
    began: Instant,
    printed: Option<Instant>,
    done: u64,
    all: Option<u64>,
}

impl ProgressDisplay {
    fn new(style: Style, quiet: bool) -> Self {
        let has_bar = style == Style::Bar || (style == Style::Auto && !quiet);
        let now = Instant::now();
        let lines =
            Lines { start: now, stage: Stage::Load, began: now, printed: None, done: 0, all: None };
        Self {
            bar: progress_bar(!has_bar, BAR),
            lines: (style == Style::Json).then(|| Mutex::new(lines)),
        }
    }

    /// A stage starts.
    fn stage(&self, stage: Stage) {
        let Some(lines) = &self.lines else { return };
        let mut lines = lines.lock().unwrap_or_else(PoisonError::into_inner);
        (lines.stage, lines.began) = (stage, Instant::now());
        if stage == Stage::Trace {
            // A render for a target error starts again.
            lines.done = 0;
        }
        lines.print();
    }

    /// The number of pixels finished, and of all.
    fn update(&self, done: u64, all: u64) {
        self.bar.set_length(all);
        self.bar.set_position(done);
        let Some(lines) = &self.lines else { return };
        let mut lines = lines.lock().unwrap_or_else(PoisonError::into_inner);
        // Threads may report out of order.
        lines.done = if lines.all == Some(all) { lines.done.max(done) } else { done };
        lines.all = Some(all);
        let is_due = lines.printed.is_none_or(|printed| printed.elapsed() >= INTERVAL);
        if is_due || done == all {
            lines.print();
        }
    }

    /// Restores the terminal.
    fn pause(&self) {
        self.bar.finish_and_clear();
    }
}

impl Lines {
    fn print(&mut self) {
        let now = Instant::now();
        self.printed = Some(now);
        let Self { start, stage, began, done, all, .. } = *self;
        let left = all.filter(|_| stage == Stage::Trace && done > 0).map(|all| {
            let spent = now.duration_since(began).as_secs_f64();
            milliseconds(spent * all.saturating_sub(done) as f64 / done as f64)
        });
        let line = json!({
            "stage": stage.name(), "done": done, "all": all,
            "seconds": milliseconds(now.duration_since(start).as_secs_f64()), "left": left
        });
        tell(&line.to_string());
    }
}

/// Seconds, to the millisecond.
fn milliseconds(seconds: f64) -> f64 {
    (seconds * 1e3).round() / 1e3
}

/// Collects finished tiles, and writes the unfinished image at intervals.
///
/// Each time the outputs are replaced atomically, as at the end, so that a reader never sees a part
/// of a file; unrendered parts of the image are black.
struct ImageSaver<'a> {
    outputs: &'a Outputs<'a>,
    entries: Vec<Entry>,
    window: Tile,
    every: Duration,
    kept: Mutex<KeptTiles>,
    /// Whether a thread is writing.
    writing: AtomicBool,
}

struct KeptTiles {
    film: Film,
    pixels: usize,
    saved: Instant,
}

impl<'a> ImageSaver<'a> {
    /// Writes `outputs` at this interval in seconds.
    ///
    /// # Errors
    /// If there is no memory for a film.
    fn new(
        outputs: &'a Outputs<'a>,
        scene: &PreparedScene,
        window: Tile,
        seconds: f64,
    ) -> Result<Self> {
        let film = Film::new(window.width, window.height)?;
        let kept = Mutex::new(KeptTiles { film, pixels: 0, saved: Instant::now() });
        // Intervals that are too long mean never.
        let every = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        let entries = outputs.entries(scene)?;
        Ok(Self { outputs, entries, window, every, kept, writing: AtomicBool::new(false) })
    }

    /// Adds a tile; writes the image if it is due.
    ///
    /// # Errors
    /// If a file cannot be written.
    fn keep(&self, tile: &Tile, pixels: &[[f32; 3]]) -> Result<()> {
        let Some((film, share)) = self.paint(tile, pixels) else { return Ok(()) };
        let written = self.outputs.write_part(&film, &self.entries, share);
        self.writing.store(false, Ordering::Release);
        written
    }

    /// Adds the tile; returns the image so far and its finished share, if this thread should write
    /// it.
    fn paint(&self, tile: &Tile, pixels: &[[f32; 3]]) -> Option<(Film, f64)> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let (left, top) = ((tile.x - self.window.x) as usize, (tile.y - self.window.y) as usize);
        let width = tile.width as usize;
        for (row, means) in kept.film.rows_mut().skip(top).zip(pixels.chunks_exact(width)) {
            row[left..left + width].copy_from_slice(means);
        }
        kept.pixels += tile.len();
        // The complete image is written at the end anyway.
        let is_due = kept.saved.elapsed() >= self.every && kept.pixels < self.window.len();
        if !is_due || self.writing.swap(true, Ordering::Acquire) {
            return None;
        }
        kept.saved = Instant::now();
        Some((kept.film.clone(), kept.pixels as f64 / self.window.len() as f64))
    }
}
