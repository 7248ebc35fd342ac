//! Watching a render, and cancelling it.

use crate::tile::Tile;

/// Receives the progress of a render. Every method may be called from any thread; by default it does
/// nothing.
pub trait Watch: Sync {
    /// So many pixels are done, of all that are to be rendered.
    fn progress(&self, _done: u64, _all: u64) {}

    /// A tile is finished, with the means of its pixels, in linear colour, row by row. Tiles come in any
    /// order, each once.
    fn tile(&self, _tile: &Tile, _pixels: &[[f32; 3]]) {}

    /// Whether to render no more: asked before each tile, and within a tile of very many samples before
    /// each block of them.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Watches nothing.
impl Watch for () {}

/// Receives progress alone: a function of the pixels done and of all.
pub struct Progress<F>(pub F);

impl<F: Fn(u64, u64) + Sync> Watch for Progress<F> {
    fn progress(&self, done: u64, all: u64) {
        (self.0)(done, all);
    }
}
