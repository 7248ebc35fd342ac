//! Who looks on while an image is rendered, and may end it before its time.

use crate::tile::Tile;

/// Someone who is told how a render goes. Every method may be called from any thread, and does nothing
/// unless it is written.
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

/// Nobody.
impl Watch for () {}

/// Someone who is told of progress alone: a function of the pixels done and of all.
pub struct Progress<F>(pub F);

impl<F: Fn(u64, u64) + Sync> Watch for Progress<F> {
    fn progress(&self, done: u64, all: u64) {
        (self.0)(done, all);
    }
}
