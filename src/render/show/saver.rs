//! Saves the unfinished image at intervals.
//!
//! Each time the outputs are replaced atomically, as at the end, so that a reader never sees a part
//! of a file; unrendered parts of the image are black.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::render::outputs::Outputs;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::tile::Tile;
use wavecrest_image::metadata::Entry;

/// Collects finished tiles, and writes the image.
pub(super) struct Saver<'a> {
    outputs: &'a Outputs<'a>,
    entries: Vec<Entry>,
    window: Tile,
    every: Duration,
    kept: Mutex<Kept>,
    /// Whether a thread is writing.
    writing: AtomicBool,
}

struct Kept {
    film: Film,
    pixels: usize,
    saved: Instant,
}

impl<'a> Saver<'a> {
    /// Writes `outputs` at this interval in seconds.
    ///
    /// # Errors
    /// If there is no memory for a film.
    pub(super) fn new(
        outputs: &'a Outputs<'a>,
        scene: &PreparedScene,
        window: Tile,
        seconds: f64,
    ) -> Result<Self> {
        let film = Film::new(window.width, window.height)?;
        let kept = Mutex::new(Kept { film, pixels: 0, saved: Instant::now() });
        // Intervals that are too long mean never.
        let every = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        let entries = outputs.entries(scene)?;
        Ok(Self { outputs, entries, window, every, kept, writing: AtomicBool::new(false) })
    }

    /// Adds a tile; writes the image if it is due.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub(super) fn keep(&self, tile: &Tile, pixels: &[[f32; 3]]) -> Result<()> {
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
