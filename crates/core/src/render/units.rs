//! What a render is cut into: tiles of the image, and blocks of the samples of a pixel.
//!
//! A block is summed by itself, and a pixel's blocks are added in their order. So one process after the other,
//! or many at a time, can each do some blocks, and the image is the same to the last bit. Where blocks begin
//! depends on the number of samples alone, as it decides how sums are rounded.

use std::ops::Range;

use crate::tile::Tile;

/// Samples of a block, at least, where there is more than one: so many that what a block takes besides its
/// rays does not count.
const LEAST_SAMPLES: u32 = 256;

/// Blocks of a pixel, at most.
const MOST_BLOCKS: u32 = 64;

/// A pixel's samples, cut into blocks of one length but for the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocks {
    samples: u32,
    length: u32,
}

impl Blocks {
    /// Those of a pixel of so many `samples`, at least one.
    pub fn new(samples: u32) -> Self {
        let samples = samples.max(1);
        let count = (samples / LEAST_SAMPLES).clamp(1, MOST_BLOCKS);
        Self { samples, length: samples.div_ceil(count) }
    }

    /// How many there are, from 1 to 64.
    pub fn count(&self) -> u32 {
        self.samples.div_ceil(self.length)
    }

    /// Samples of the longest.
    pub fn longest(&self) -> u32 {
        self.length
    }

    /// Samples of the pixel.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The samples of a block, by number.
    pub fn range(&self, block: u32) -> Range<u32> {
        let start = (block * self.length).min(self.samples);
        start..(start + self.length).min(self.samples)
    }
}

/// A rectangle of the image cut into square tiles, numbered row by row. Those at its right and at its bottom
/// may be cut short.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    window: Tile,
    edge: u32,
}

impl Grid {
    /// `window` cut into tiles of `edge` pixels a side, at least one.
    pub fn new(window: Tile, edge: u32) -> Self {
        Self { window, edge: edge.max(1) }
    }

    /// The rectangle.
    pub fn window(&self) -> &Tile {
        &self.window
    }

    /// The side of a tile in pixels.
    pub fn edge(&self) -> u32 {
        self.edge
    }

    /// Number of tiles in a row of them.
    pub fn columns(&self) -> u32 {
        self.window.width.div_ceil(self.edge)
    }

    /// Number of tiles.
    pub fn len(&self) -> u32 {
        self.columns() * self.window.height.div_ceil(self.edge)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The tile of a number below [`Grid::len`].
    pub fn tile(&self, number: u32) -> Tile {
        let Tile { x, y, width, height } = self.window;
        let [left, top] = [number % self.columns(), number / self.columns()].map(|i| i * self.edge);
        Tile {
            x: x + left,
            y: y + top,
            width: self.edge.min(width - left),
            height: self.edge.min(height - top),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_follow_each_other_and_are_long_and_few() {
        for samples in (1..2000).chain([16_384, 16_385, 40_000, 1 << 24]) {
            let blocks = Blocks::new(samples);
            let mut next = 0;
            for block in 0..blocks.count() {
                let range = blocks.range(block);
                assert_eq!(range.start, next);
                assert!(!range.is_empty() && range.len() as u32 <= blocks.longest());
                next = range.end;
            }
            assert_eq!(next, samples);
            assert!(blocks.count() <= MOST_BLOCKS);
            assert!(blocks.count() == 1 || blocks.longest() >= LEAST_SAMPLES);
        }
        assert_eq!([1, 511, 512, 1 << 24].map(|n| Blocks::new(n).count()), [1, 1, 2, 64]);
    }

    #[test]
    fn tiles_cover_the_window_once() {
        for (window, edge) in [
            (Tile { x: 3, y: 5, width: 21, height: 17 }, 8),
            (Tile { x: 0, y: 0, width: 16, height: 16 }, 8),
            (Tile { x: 9, y: 0, width: 1, height: 30 }, 64),
        ] {
            let grid = Grid::new(window, edge);
            let mut seen = std::collections::BTreeSet::new();
            for tile in (0..grid.len()).map(|number| grid.tile(number)) {
                assert!(!tile.is_empty());
                for index in 0..tile.len() as u32 {
                    assert!(seen.insert(tile.pixel(index)), "{tile:?}");
                }
            }
            let all = (0..window.len() as u32).map(|index| window.pixel(index)).collect();
            assert_eq!(seen, all);
        }
    }
}
