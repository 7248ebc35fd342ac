//! Progress, log, viewer and unfinished image of a render.
//!
//! Failures here never end a render: they are warnings at most.

mod live;
mod log;
mod progress;
mod recorder;
mod saver;
pub(super) mod stage;

use super::args::RenderArgs;
use super::outputs::Outputs;
use crate::common::tell;
use crate::interrupt::Interrupt;
use live::Live;
use log::Log;
use progress::Progress;
use saver::Saver;
use stage::Stage;
use wavecrest_base::error::{Error, Result, Warning};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::Watch;
use wavecrest_core::tile::Tile;

/// The channels that show a render, during and after it, and the interrupt that ends it early.
pub(super) struct Seen<'a> {
    pub(super) outputs: &'a Outputs<'a>,
    pub(super) reporter: &'a Reporter,
    pub(super) interrupt: &'a Interrupt,
}

/// Reports on a command from its start to its end.
pub(super) struct Reporter {
    progress: Progress,
    log: Log,
}

impl Reporter {
    /// Starts the requested reports.
    ///
    /// # Errors
    /// If the log cannot be written to.
    pub(super) fn begin(args: &RenderArgs) -> Result<Self> {
        let log = Log::open(args.show.log.as_deref())?;
        let progress = Progress::new(args.show.progress, args.scene_options.quiet);
        Ok(Self { progress, log })
    }

    /// A stage starts.
    pub(super) fn stage(&self, stage: Stage) {
        self.progress.stage(stage);
        if stage != Stage::Done {
            self.log.line(stage.name(), || "begins".to_owned());
        }
    }

    /// An entry for the log only.
    pub(super) fn note(&self, topic: &str, text: impl FnOnce() -> String) {
        self.log.line(topic, text);
    }

    /// Adds warnings that are printed already to the log.
    pub(super) fn warnings(&self, warnings: &[Warning]) {
        warnings.iter().for_each(|warning| self.note("warning", || warning.to_string()));
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

/// Shows one render on the requested channels: the reporter's, the viewer and the file.
pub(super) struct Show<'a> {
    reporter: &'a Reporter,
    live: Option<Live>,
    saver: Option<Saver<'a>>,
}

impl<'a> Show<'a> {
    /// Prepares to show the render of `scene`.
    pub(super) fn new(
        args: &RenderArgs,
        outputs: &'a Outputs<'a>,
        scene: &PreparedScene,
        reporter: &'a Reporter,
    ) -> Self {
        let [width, height] = scene.camera.size();
        let window = args.crop.unwrap_or(Tile { x: 0, y: 0, width, height });
        let live =
            args.show.tev.as_ref().and_then(|address| {
                reporter.or_warn(Live::connect(address, &outputs.name(), window))
            });
        let saver = args
            .show
            .save_every
            .and_then(|seconds| reporter.or_warn(Saver::new(outputs, scene, window, seconds)));
        Self { reporter, live, saver }
    }
}

impl Watch for Show<'_> {
    fn progress(&self, done: u64, all: u64) {
        self.reporter.progress.update(done, all);
    }

    fn tile(&self, tile: &Tile, pixels: &[[f32; 3]]) {
        if let Some(live) = &self.live {
            live.send(tile, pixels);
        }
        if let Some(saver) = &self.saver
            && let Err(error) = saver.keep(tile, pixels)
        {
            self.reporter.warn(&error);
        }
    }
}

impl Drop for Show<'_> {
    fn drop(&mut self) {
        self.reporter.progress.pause();
        if let Some(error) = self.live.take().and_then(Live::finish) {
            self.reporter.warn(&error);
        }
    }
}
