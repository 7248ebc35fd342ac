//! The unfinished image of a render, beside its [progress](crate::progress).
//!
//! Failures here never end a render: they are warnings at most.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::outputs::Outputs;
use crate::common::tell;
use crate::interrupt;
use crate::progress::{Display, Phase};
use wavecrest_base::error::{Error, Result};
use wavecrest_base::lock;
use wavecrest_core::film::Film;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{Watch, window};
use wavecrest_core::tile::Tile;
use wavecrest_image::metadata::Entry;

/// A failure that does not end a render, such as of a checkpoint that cannot be written: the warning is printed even with
/// `--quiet`.
pub(super) fn warn(error: &Error) {
    tell(&format!("warning: {error}"));
}

/// Shows one render: its progress, and the image so far in the file. Ends it on a signal.
pub(super) struct Show<'a> {
    progress: &'a Display,
    saver: Option<ImageSaver<'a>>,
}

impl<'a> Show<'a> {
    /// Begins to show the render of `scene`; unfinished images have entries if the camera's samples are theirs.
    pub(super) fn begin(
        outputs: &'a Outputs<'a>,
        progress: &'a Display,
        scene: &PreparedScene,
        has_entries: bool,
    ) -> Self {
        progress.begin(Phase::Trace);
        let saver = outputs.args.save_every.and_then(|seconds| {
            let saver = ImageSaver::new(outputs, (scene, has_entries), seconds);
            saver.inspect_err(warn).ok()
        });
        Self { progress, saver }
    }

    /// There is this image already.
    pub(super) fn go_on(&self, film: Film) {
        self.saver.iter().for_each(|saver| lock(&saver.kept).film = film.clone());
    }
}

impl Watch for Show<'_> {
    fn progress(&self, done: u64, all: u64) {
        self.progress.traced(done, all);
    }

    fn pass(&self, _samples: u32, _error: Option<f64>) {
        self.progress.begin(Phase::Trace);
        self.saver.iter().for_each(ImageSaver::begin_pass);
    }

    fn tile(&self, tile: &Tile, pixels: &[[f32; 3]]) {
        if let Some(saver) = &self.saver
            && let Err(error) = saver.keep(tile, pixels)
        {
            warn(&error);
        }
    }

    fn cancelled(&self) -> bool {
        interrupt::signal().is_some()
    }
}

impl Drop for Show<'_> {
    fn drop(&mut self) {
        self.progress.finish();
    }
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
    /// If the crop is not within the image, or there is no memory for a film.
    fn new(
        outputs: &'a Outputs<'a>,
        (scene, has_entries): (&PreparedScene, bool),
        seconds: f64,
    ) -> Result<Self> {
        let window = window(scene, outputs.args.crop)?;
        let film = Film::new(window.width, window.height)?;
        let kept = Mutex::new(KeptTiles { film, pixels: 0, saved: Instant::now() });
        // Intervals that are too long mean never.
        let every = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        let entries = if has_entries { outputs.entries(scene)? } else { Vec::new() };
        Ok(Self { outputs, entries, window, every, kept, writing: AtomicBool::new(false) })
    }

    /// The tiles of a further pass follow.
    fn begin_pass(&self) {
        lock(&self.kept).pixels = 0;
    }

    /// Adds a tile; writes the image if it is due.
    ///
    /// # Errors
    /// If a file cannot be written.
    fn keep(&self, tile: &Tile, pixels: &[[f32; 3]]) -> Result<()> {
        let Some((film, share)) = self.paint(tile, pixels) else { return Ok(()) };
        let paths = &self.outputs.paths;
        let written = self.outputs.write_part(paths, &film, &self.entries, share);
        self.writing.store(false, Ordering::Release);
        written
    }

    /// Adds the tile; returns the image so far and its finished share, if this thread should write
    /// it.
    fn paint(&self, tile: &Tile, pixels: &[[f32; 3]]) -> Option<(Film, f64)> {
        let mut kept = lock(&self.kept);
        let corner = [tile.x - self.window.x, tile.y - self.window.y];
        kept.film.paste(corner, tile.width, pixels);
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
