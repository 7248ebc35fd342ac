//! The film during a render: finished tiles are written to their places, from any thread.

use std::sync::{Mutex, PoisonError};

use super::{Grid, Summed, Watch};
use crate::film::Film;
use crate::tile::Tile;
use wavecrest_base::error::Result;

/// A film for a grid's window, and its finished tiles.
pub struct Canvas<'a> {
    grid: Grid,
    /// The number of samples of a finished pixel.
    samples: u32,
    watch: &'a dyn Watch,
    painted: Mutex<Painted>,
}

/// The finished part of an image.
pub struct Painted {
    /// The film, black where nothing is rendered.
    pub film: Film,
    /// The finished tiles.
    pub tiles: Vec<Tile>,
    /// Number of their pixels.
    pub pixels: u64,
}

impl<'a> Canvas<'a> {
    /// A black canvas for an image of so many `samples` in each pixel. `watch` receives tiles and progress.
    ///
    /// # Errors
    /// If there is no memory for the film.
    pub fn new(grid: Grid, samples: u32, watch: &'a dyn Watch) -> Result<Self> {
        let film = Film::new(grid.window.width, grid.window.height)?;
        let painted = Mutex::new(Painted { film, tiles: Vec::new(), pixels: 0 });
        Ok(Self { grid, samples, watch, painted })
    }

    /// Writes a tile to the film, if it has all its samples.
    pub fn keep(&self, summed: &Summed<'_>) {
        if summed.samples != self.samples {
            return;
        }
        let (tile, means) = (self.grid.tile(summed.tile), summed.means());
        self.watch.tile(&tile, &means);
        let mut painted = self.painted.lock().unwrap_or_else(PoisonError::into_inner);
        let window = self.grid.window;
        painted.film.paste([tile.x - window.x, tile.y - window.y], tile.width, &means);
        painted.tiles.push(tile);
        painted.pixels += tile.len() as u64;
        let done = painted.pixels;
        drop(painted);
        self.watch.progress(done, window.len() as u64);
    }

    /// The film so far, with its tiles in the order of the grid.
    pub fn finish(self) -> Painted {
        let mut painted = self.painted.into_inner().unwrap_or_else(PoisonError::into_inner);
        painted.tiles.sort_unstable_by_key(|tile| (tile.y, tile.x));
        painted
    }
}
