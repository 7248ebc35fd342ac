//! Progress on standard error: a bar for people, lines of JSON for programs.
//!
//! A line of JSON has the keys `stage` (`load`, `build`, `trace`, `write`, `done`), `done` and `all` (pixels; `all`
//! is null until it is known), `seconds` since the start, and `left`, the seconds that the rays are likely to take
//! still (null where it is not known). Each stage begins with a line; while rays are followed there are ten a second
//! at most, and one at the end.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use serde_json::json;

use super::stage::Stage;
use crate::common::{progress_bar, tell};
use crate::render::args::Style;

/// What the bar shows.
const BAR: &str = "{wide_bar} {percent:>3} % {millions} Mpixels/s, {eta} left";

/// The least time between two lines of one stage.
const INTERVAL: Duration = Duration::from_millis(100);

/// Tells progress in one style.
pub(super) struct Progress {
    bar: ProgressBar,
    lines: Option<Mutex<Lines>>,
}

/// What the lines of JSON are made from.
struct Lines {
    start: Instant,
    stage: Stage,
    /// When the stage began, and when the last line was written.
    began: Instant,
    told: Option<Instant>,
    done: u64,
    all: Option<u64>,
}

impl Progress {
    pub(super) fn new(style: Style, quiet: bool) -> Self {
        let has_bar = style == Style::Bar || (style == Style::Auto && !quiet);
        let now = Instant::now();
        let lines =
            Lines { start: now, stage: Stage::Load, began: now, told: None, done: 0, all: None };
        Self {
            bar: progress_bar(!has_bar, BAR),
            lines: (style == Style::Json).then(|| Mutex::new(lines)),
        }
    }

    /// A stage begins.
    pub(super) fn stage(&self, stage: Stage) {
        let Some(lines) = &self.lines else { return };
        let mut lines = lines.lock().unwrap_or_else(PoisonError::into_inner);
        (lines.stage, lines.began) = (stage, Instant::now());
        if stage == Stage::Trace {
            // A render for a target error begins again.
            lines.done = 0;
        }
        lines.tell();
    }

    /// So many pixels of all are done.
    pub(super) fn update(&self, done: u64, all: u64) {
        self.bar.set_length(all);
        self.bar.set_position(done);
        let Some(lines) = &self.lines else { return };
        let mut lines = lines.lock().unwrap_or_else(PoisonError::into_inner);
        // Threads may come in another order than that in which they were done.
        lines.done = if lines.all == Some(all) { lines.done.max(done) } else { done };
        lines.all = Some(all);
        let is_due = lines.told.is_none_or(|told| told.elapsed() >= INTERVAL);
        if is_due || done == all {
            lines.tell();
        }
    }

    /// Leaves the terminal as it was.
    pub(super) fn pause(&self) {
        self.bar.finish_and_clear();
    }
}

impl Lines {
    fn tell(&mut self) {
        let now = Instant::now();
        self.told = Some(now);
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
