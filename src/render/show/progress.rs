//! Progress on standard error: a bar for people, lines of JSON for programs.
//!
//! A line of JSON has the keys `stage` (`load`, `build`, `trace`, `write`, `done`), `done` and
//! `all` (pixels; `all` is null until it is known), `seconds` since the start, and `left`, the
//! estimated remaining seconds of tracing (null if unknown). Each stage starts with a line; tracing
//! prints at most ten a second, and one at the end.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use serde_json::json;

use crate::common::{progress_bar, tell};
use crate::render::args::Style;

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

/// Reports progress in one style.
pub(super) struct Progress {
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

impl Progress {
    pub(super) fn new(style: Style, quiet: bool) -> Self {
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
    pub(super) fn stage(&self, stage: Stage) {
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
    pub(super) fn update(&self, done: u64, all: u64) {
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
    pub(super) fn pause(&self) {
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
