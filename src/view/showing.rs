//! Shows an image while it is rendered.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::exchange::{Exchange, Kind};
use super::picture::{MOVES, Picture, WHOLE};
use wavecrest_base::lock;
use wavecrest_core::film::Film;
use wavecrest_core::render::Watch;
use wavecrest_core::tile::Tile;
use wavecrest_image::write::{Develop, Transfer, levels, row_to_bytes};

/// How often pages are shown what is new.
const SHOWING: Duration = Duration::from_millis(100);

/// How long at least an image is not shown again, as a multiple of what it took.
const RARELY: u32 = 10;

/// Shows a render: at the end, and before if it takes long enough. At rest, it ends when a request arrives.
pub(super) struct Showing<'a> {
    exchange: &'a Exchange,
    half: usize,
    size: [u32; 2],
    develop: Develop,
    transfer: Transfer,
    /// Whether something moves: then the render is short, and no request ends it.
    moves: bool,
    state: Mutex<Shown>,
}

/// What is shown of a render.
struct Shown {
    pixels: Vec<[u8; 4]>,
    /// The figures that are sent with the image.
    figures: Value,
    /// The pixels that are finished.
    done: u64,
    /// When it is shown next.
    next: Instant,
}

impl<'a> Showing<'a> {
    /// Begins to show the image of a half, of this size in pixels, with `figures` about all halves.
    pub(super) fn new(
        exchange: &'a Exchange,
        half: usize,
        size: [u32; 2],
        (develop, transfer): (Develop, Transfer),
        moves: bool,
        figures: Value,
    ) -> Self {
        let pixels = vec![[0; 4]; size[0] as usize * size[1] as usize];
        let state = Mutex::new(Shown { pixels, figures, done: 0, next: Instant::now() + SHOWING });
        Self { exchange, half, size, develop, transfer, moves, state }
    }

    /// Shows the whole image, which is the last if all `rests`. Returns what is to be saved of it.
    pub(super) fn finish(&self, film: &Film, rests: bool) -> (Film, Transfer) {
        let whole = Tile { x: 0, y: 0, width: self.size[0], height: self.size[1] };
        let mut state = lock(&self.state);
        let developed = self.develop.film(film, None);
        self.keep(&mut state.pixels, &whole, &levels(&developed, self.transfer));
        self.show(&state.pixels, WHOLE, rests);
        (developed, self.transfer)
    }

    fn show(&self, pixels: &[[u8; 4]], state: u32, rests: bool) {
        let flags = state | if self.moves { MOVES } else { 0 };
        let picture = Picture::new(self.half, self.size, pixels, flags, rests);
        self.exchange.send(Kind::image(self.half), picture);
    }

    /// Puts the levels of a tile into the image.
    fn keep(&self, pixels: &mut [[u8; 4]], tile: &Tile, levels: &[u8]) {
        let [left, width] = [tile.x, tile.width].map(|x| x as usize);
        let rows = pixels.chunks_exact_mut(self.size[0] as usize).skip(tile.y as usize);
        for (row, levels) in rows.zip(levels.chunks_exact(3 * width)) {
            for (pixel, level) in row[left..].iter_mut().zip(levels.chunks_exact(3)) {
                *pixel = [level[0], level[1], level[2], u8::MAX];
            }
        }
    }
}

impl Watch for Showing<'_> {
    fn tile(&self, tile: &Tile, means: &[[f32; 3]]) {
        if self.cancelled() {
            return;
        }
        // By this thread alone, which is in the middle of the work of its pool.
        let develop = |mean: &[f32; 3]| mean.map(|light| self.develop.of(light));
        let developed: Vec<[f32; 3]> = means.iter().map(develop).collect();
        let levels = row_to_bytes(&developed, self.transfer);
        let mut state = lock(&self.state);
        let Shown { pixels, figures, done, next } = &mut *state;
        self.keep(pixels, tile, &levels);
        *done += tile.len() as u64;
        let start = Instant::now();
        if start < *next {
            return;
        }
        if let Some(half) = figures["halves"].get_mut(self.half) {
            half["done"] = (*done as f64 / pixels.len() as f64).into();
        }
        self.exchange.send(Kind::Figures, figures.to_string());
        self.show(pixels, 0, false);
        // A large image takes long to show, which is to take a small share of the time.
        *next = Instant::now() + SHOWING.max(start.elapsed() * RARELY);
    }

    fn cancelled(&self) -> bool {
        !self.moves && self.exchange.inbox.cancelled()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finished_is_transparent() {
        let exchange = Exchange::default();
        let showing = Showing::new(&exchange, 1, [2, 2], Default::default(), true, Value::Null);
        let right = Tile { x: 1, y: 1, width: 1, height: 1 };
        let pixels = &mut [[0; 4]; 4];
        showing.keep(pixels, &right, &[255, 0, 51]);
        assert_eq!(pixels[..], [[0; 4], [0; 4], [0; 4], [255, 0, 51, 255]]);
        let picture = Picture::new(1, [2, 2], pixels, MOVES, false);
        assert_eq!(picture.exact()[..], *pixels.as_flattened());
    }
}
