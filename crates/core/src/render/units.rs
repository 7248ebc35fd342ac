//! The units of a render: tiles of the image.

use crate::tile::Tile;

/// A rectangle of the image, cut into square tiles, numbered row by row. Tiles at its right and
/// bottom edges may be smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// The rectangle.
    pub window: Tile,
    /// The side of a tile in pixels.
    pub edge: u32,
}

impl Grid {
    /// `window`, cut into tiles with sides of `edge` pixels, at least one.
    pub fn new(window: Tile, edge: u32) -> Self {
        Self { window, edge: edge.max(1) }
    }

    /// Number of tiles in a row.
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

    /// The tile with this number, below [`Grid::len`].
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

/// The distance between the numbers of successive tiles, of `count` tiles counted in a circle, with which any number of
/// them is spread over the image: those finished at any time are a fair sample of all. It meets each once.
pub fn spread(count: u32) -> u32 {
    // The golden ratio spreads any number of points in a circle evenly.
    const RATIO: f64 = 0.618_033_988_749_895;
    let first = (f64::from(count) * RATIO) as u32;
    (first..count).find(|&step| gcd(step, count) == 1).unwrap_or(1)
}

/// The greatest common divisor.
fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_tile_comes_once_and_all_parts_soon() {
        for count in (1..200).chain([300, 4096, 65_536]) {
            let step = u64::from(spread(count));
            let tiles = (0..count).map(|n| u64::from(n) * step % u64::from(count));
            let seen: std::collections::BTreeSet<u64> = tiles.clone().collect();
            assert_eq!(seen.len(), count as usize, "{count}");
            let upper = tiles.take(count as usize / 8).filter(|n| 2 * n < u64::from(count));
            let (upper, eighth) = (upper.count() as f64, f64::from(count / 8));
            assert!((upper - eighth / 2.0).abs() <= 2.0, "{count}: {upper} of {eighth}");
        }
    }
}
