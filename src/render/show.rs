//! Progress, log, viewer and unfinished image of a render.
//!
//! Failures here never end a render: they are warnings at most.

mod live;
mod log;
mod progress;
mod saver;

use super::args::RenderArgs;
use super::outputs::Outputs;
use crate::common::tell;
use crate::interrupt;
use live::Live;
use log::Log;
use progress::Progress;
use saver::Saver;
use wavecrest_base::error::{Error, Result};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::Watch;
use wavecrest_core::tile::Tile;
use wavecrest_report::accuracy::pilot::budget::Pace;

pub(super) use progress::Stage;

/// A render: what is requested, its files, and the channels that show it, during and after it.
pub(super) struct Rendering<'a> {
    pub(super) args: &'a RenderArgs,
    pub(super) outputs: &'a Outputs<'a>,
    pub(super) reporter: &'a Reporter,
}

/// Reports on a command from its start to its end.
pub(super) struct Reporter {
    progress: Progress,
    pub(super) log: Log,
}

impl Reporter {
    /// Starts the requested reports.
    ///
    /// # Errors
    /// If the log cannot be written to.
    pub(super) fn begin(args: &RenderArgs) -> Result<Self> {
        let log = Log::open(args.log.as_deref())?;
        let progress = Progress::new(args.progress, args.scene_options.quiet);
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
    saver: Option<Saver<'a>>,
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
            .and_then(|seconds| reporter.or_warn(Saver::new(outputs, scene, window, seconds)));
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
