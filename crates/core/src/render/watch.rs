//! Progress and cancellation of a render.

use crate::tile::Tile;

/// Receives the progress of a render. Every method may be called from any thread; by default it does
/// nothing.
pub trait Watch: Sync {
    /// The number of pixels finished, and of all to render.
    fn progress(&self, _done: u64, _all: u64) {}

    /// A tile is finished, with the means of its pixels in linear colour, row by row. Tiles come in
    /// any order, each once in a pass.
    fn tile(&self, _tile: &Tile, _pixels: &[[f32; 3]]) {}

    /// A pass over the image is finished: the number of samples of each pixel, and the error if it is known.
    fn pass(&self, _samples: u32, _error: Option<f64>) {}

    /// Whether to stop rendering: called before each tile, and within it after a batch
    /// or some thousand rays.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Ignores all progress.
impl Watch for () {}

/// Receives progress only: a function of the number of pixels finished and of all.
pub struct Progress<F>(pub F);

impl<F: Fn(u64, u64) + Sync> Watch for Progress<F> {
    fn progress(&self, done: u64, all: u64) {
        (self.0)(done, all);
    }
}
