//! Shows on standard error how far a render is: a bar for people, lines of JSON for programs.
//!
//! A thread of its own looks ten times a second, so work waits for no terminal.
//!
//! A line of JSON has the keys `stage` (`load`, `build`, `trace`, `write`, `done`); `frame` and `frames`, the number of the
//! frame among all frames of the command, from 1 (null for one image); `done` and `all` of the stage, bytes read, triangles
//! or pixels (`all` is null until it is known); `seconds` since the start; and `left`, the estimated seconds to the end of
//! the stage, of a pass over the image, or of all frames (null if unknown). Each stage starts with a line; others follow at most ten times a
//! second, and one at the end of tracing.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar};
use serde_json::json;

use super::common::{progress_bar, tell};
use wavecrest_base::words::Size;
use wavecrest_base::{lock, memory, progress};

/// The template of the bar.
const BAR: &str = "{msg} {wide_bar} {prefix}";

/// The interval between two looks.
const INTERVAL: Duration = Duration::from_millis(100);

wavecrest_base::choices! {
    /// A phase of a render, in lines of progress the `stage`.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Phase {
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

/// How progress is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Style {
    /// A bar if standard error is a terminal, unless --quiet is given
    #[default]
    Auto,
    /// A bar if standard error is a terminal
    Bar,
    /// Lines of JSON, at most ten a second
    Json,
    /// Nothing
    None,
}

/// Shows the progress until it is dropped.
pub(crate) struct Display {
    shared: Arc<Shared>,
    ticker: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Display {
    /// In a `style`; without a bar if `quiet`. The first phase is [`Phase::Load`].
    pub(crate) fn new(style: Style, quiet: bool) -> Self {
        progress::begin();
        let has_bar = style == Style::Bar || (style == Style::Auto && !quiet);
        let bar = progress_bar(!has_bar, BAR);
        let is_shown = style == Style::Json || !bar.is_hidden();
        let (start, phase) = (Instant::now(), Phase::Load);
        let state = Mutex::new(State { phase, frame: None, began: start, pace: None });
        let traced = [AtomicU64::new(0), AtomicU64::new(0)];
        let shared = Arc::new(Shared { bar, lines: style == Style::Json, start, state, traced });
        let (stop, stopped) = mpsc::channel();
        let shown = Arc::clone(&shared);
        let tick = move || {
            while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                if lock(&shown.state).phase != Phase::Done {
                    shown.show();
                }
            }
        };
        // Without a thread, phases are shown at their starts.
        let ticker = is_shown.then(|| thread::Builder::new().spawn(tick).ok()).flatten();
        Self { shared, ticker: ticker.map(|thread| (stop, thread)) }
    }

    /// A phase starts.
    pub(crate) fn begin(&self, phase: Phase) {
        self.shared.begin(phase);
        self.shared.show();
    }

    /// The next is this frame of so many, from 1.
    pub(crate) fn frame(&self, frame: u64, frames: u64) {
        lock(&self.shared.state).frame = Some([frame, frames]);
    }

    /// The number of pixels finished, and of all. Threads may report out of order.
    pub(crate) fn traced(&self, done: u64, all: u64) {
        let [of_done, of_all] = &self.shared.traced;
        of_all.store(all, Ordering::Relaxed);
        of_done.fetch_max(done, Ordering::Relaxed);
    }

    /// Shows the end of a phase.
    pub(crate) fn finish(&self) {
        self.shared.show();
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        if let Some((stop, thread)) = self.ticker.take() {
            drop(stop);
            let _ = thread.join();
        }
        self.shared.bar.finish_and_clear();
    }
}

/// What the threads share that show it.
struct Shared {
    bar: ProgressBar,
    lines: bool,
    start: Instant,
    state: Mutex<State>,
    /// Pixels that are traced, and all of the frame.
    traced: [AtomicU64; 2],
}

#[derive(Clone, Copy)]
struct State {
    phase: Phase,
    frame: Option<[u64; 2]>,
    /// The start of the phase.
    began: Instant,
    /// When work was first seen, and how much was done by then: a checkpoint's tiles tell nothing of the time to go.
    pace: Option<(Instant, u64)>,
}

impl Shared {
    fn begin(&self, phase: Phase) {
        let mut state = lock(&self.state);
        let is_later_frame = state.frame.is_some_and(|[frame, _]| frame > 1);
        if phase == Phase::Trace {
            // A further pass over the image. Frames are equally large.
            let [done, all] = &self.traced;
            done.store(0, Ordering::Relaxed);
            if !is_later_frame {
                all.store(0, Ordering::Relaxed);
            }
        }
        // Frames have a pace of their own, which includes their writing.
        if state.frame.is_none() || (phase == Phase::Trace && !is_later_frame) {
            state.pace = None;
        }
        progress::begin();
        (state.phase, state.began) = (phase, Instant::now());
    }

    fn show(&self) {
        let now = Instant::now();
        let mut state = lock(&self.state);
        let of_pixels =
            state.phase == Phase::Trace || state.frame.is_some() && state.phase == Phase::Write;
        let counts = self.traced.each_ref().map(|count| count.load(Ordering::Relaxed));
        let [done, all] = if of_pixels { counts } else { progress::now() };
        let [frame, frames] = state.frame.filter(|_| of_pixels).unwrap_or([1, 1]);
        let whole = [(frame - 1) * all + done, frames * all];
        if all > 0 && state.pace.is_none() {
            state.pace = Some((now, whole[0]));
        }
        let left = state.left(now, whole);
        if self.lines {
            self.print(*state, now, [done, all], left);
        } else if state.phase == Phase::Done {
            self.bar.finish_and_clear();
        } else {
            self.draw(*state, now, whole, left);
        }
    }

    fn print(&self, state: State, now: Instant, [done, all]: [u64; 2], left: Option<f64>) {
        let line = json!({
            "stage": state.phase.name(),
            "frame": state.frame.map(|[frame, _]| frame),
            "frames": state.frame.map(|[_, frames]| frames),
            "done": done,
            "all": (all > 0).then_some(all),
            "seconds": milliseconds(now.duration_since(self.start).as_secs_f64()),
            "left": left.map(milliseconds),
        });
        tell(&line.to_string());
    }

    fn draw(&self, state: State, now: Instant, [done, all]: [u64; 2], left: Option<f64>) {
        let words = match (state.frame, state.phase) {
            (Some([frame, frames]), Phase::Trace | Phase::Write) => {
                format!("image {frame} of {frames}")
            }
            // What is read is then prepared.
            (_, Phase::Load) => memory::Stage::now().name().to_owned(),
            (_, Phase::Build) => memory::Stage::Build.name().to_owned(),
            (_, Phase::Trace) => memory::Stage::Trace.name().to_owned(),
            (_, Phase::Write | Phase::Done) => memory::Stage::Write.name().to_owned(),
        };
        let numbers = match left.filter(|_| done < all) {
            Some(left) => {
                let left = HumanDuration(Duration::try_from_secs_f64(left).unwrap_or_default());
                match state.phase {
                    Phase::Load => format!("{} of {}, {left:#} left", Size(done), Size(all)),
                    _ => format!("{} %, {left:#} left", 100 * done / all),
                }
            }
            None => format!("{:#}", HumanDuration(now.duration_since(state.began))),
        };
        self.bar.set_length(all.max(1));
        self.bar.set_position(done);
        self.bar.set_message(words);
        self.bar.set_prefix(numbers);
        self.bar.tick();
    }
}

impl State {
    /// The estimated seconds until all is done, at the pace since work was first seen.
    fn left(&self, now: Instant, [done, all]: [u64; 2]) -> Option<f64> {
        let (began, before) = self.pace?;
        if done >= all {
            return Some(0.0);
        }
        let spent = now.duration_since(began).as_secs_f64();
        let since = done.checked_sub(before).filter(|since| *since > 0)?;
        Some(spent * (all - done) as f64 / since as f64)
    }
}

/// Seconds, to the millisecond.
fn milliseconds(seconds: f64) -> f64 {
    (seconds * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_to_go_is_that_of_the_work_since_it_was_first_seen() {
        let began = Instant::now();
        let now = began + Duration::from_secs(10);
        let state = |pace| State { phase: Phase::Trace, frame: None, began, pace };
        assert_eq!(state(None).left(now, [0, 0]), None);
        assert_eq!(state(Some((began, 0))).left(now, [0, 100]), None);
        assert_eq!(state(Some((began, 0))).left(now, [50, 100]), Some(10.0));
        // A checkpoint held 80.
        assert_eq!(state(Some((began, 80))).left(now, [90, 100]), Some(10.0));
        assert_eq!(state(Some((began, 80))).left(now, [100, 100]), Some(0.0));
    }

    #[test]
    fn frames_count_as_one_work() {
        let display = Display::new(Style::None, true);
        display.frame(3, 4);
        display.begin(Phase::Trace);
        display.traced(50, 100);
        display.finish();
        let state = *lock(&display.shared.state);
        assert_eq!(state.pace.map(|(_, done)| done), Some(250));
        display.begin(Phase::Write);
        assert_eq!(lock(&display.shared.state).pace, state.pace);
        display.frame(4, 4);
        display.begin(Phase::Trace);
        assert_eq!(lock(&display.shared.state).pace, state.pace);
    }
}
