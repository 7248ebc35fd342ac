//! The order of the pixels of a tile.
//!
//! Consecutive rays are traced together, so they should be close to each other. Pixels are ordered
//! in blocks, and within a block along a Z-order curve, in which every run of 4, 16 or 64 is a
//! square. Sixty-four rays are thus a square block with one, four or sixteen samples for each
//! pixel.

/// Width and height of a block in pixels: with one ray for each pixel, the unit of the kernels.
const SIDE: u32 = 8;

/// Pixels of a block.
const BLOCK: u32 = SIDE * SIDE;

/// A walk over the pixels of a tile.
///
/// Blocks cut by the tile's edges come last, so that all others start at a multiple of their size.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileWalk {
    /// Width and height of the tile.
    tile: [u32; 2],
    block: u32,
    /// The block's first pixel, and the width and height of its part in the tile.
    first: [u32; 2],
    size: [u32; 2],
    /// The step along the Z-order curve.
    step: u32,
    /// Column and row of the current pixel in the tile.
    pub(super) pixel: [u32; 2],
}

impl TileWalk {
    /// A walk over a tile of this size, after `taken` pixels.
    pub(super) fn new(tile: [u32; 2], taken: u32) -> Self {
        let mut walk = Self { tile, block: 0, first: [0; 2], size: [0; 2], step: 0, pixel: [0; 2] };
        walk.enter(0);
        let mut left = taken;
        while left >= walk.size[0] * walk.size[1] && walk.size[0] > 0 {
            left -= walk.size[0] * walk.size[1];
            walk.enter(walk.block + 1);
        }
        for _ in 0..left {
            walk.advance();
        }
        walk
    }

    /// Advances to the next pixel.
    #[inline(always)]
    pub(super) fn advance(&mut self) {
        loop {
            self.step += 1;
            if self.step == BLOCK {
                return self.enter(self.block + 1);
            }
            let [x, y] = [along_z(self.step), along_z(self.step >> 1)];
            if x < self.size[0] && y < self.size[1] {
                self.pixel = [self.first[0] + x, self.first[1] + y];
                return;
            }
        }
    }

    /// Moves to the first pixel of a block. Beyond the last, blocks are empty.
    fn enter(&mut self, block: u32) {
        let [width, height] = self.tile;
        let [columns, rows] = [width / SIDE, height / SIDE];
        let whole = columns * rows;
        let cut_right = if width.is_multiple_of(SIDE) { 0 } else { rows };
        let [column, row] = if block < whole {
            [block % columns, block / columns]
        } else if block < whole + cut_right {
            [columns, block - whole]
        } else {
            [block - whole - cut_right, rows]
        };
        self.block = block;
        self.first = [column * SIDE, row * SIDE];
        self.size = [
            width.saturating_sub(self.first[0]).min(SIDE),
            height.saturating_sub(self.first[1]).min(SIDE),
        ];
        self.step = 0;
        self.pixel = self.first;
    }
}

/// Every second bit of a number below 64.
#[inline(always)]
fn along_z(step: u32) -> u32 {
    step & 1 | step >> 1 & 2 | step >> 2 & 4
}

#[cfg(test)]
mod tests;
