//! Shows an image while it is rendered.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use serde_json::Value;
use tokio_tungstenite::tungstenite::Message;

use super::exchange::{Exchange, Kind};
use wavecrest_base::lock;
use wavecrest_core::film::Film;
use wavecrest_core::render::Watch;
use wavecrest_core::tile::Tile;
use wavecrest_image::write::{Transfer, levels, row_to_bytes};

/// How often pages are shown what is new.
const SHOWING: Duration = Duration::from_millis(100);

/// How long at least an image is not shown again, as a multiple of what it took.
const RARELY: u32 = 10;

/// Flags of an image: something moves, and all of it is finished.
const MOVES: u32 = 1;
const WHOLE: u32 = 2;

/// The message of an image: its half, width, height and flags as 32 bits each, then red, green, blue and opacity of each pixel, the top row first. What is not
/// finished is transparent. The flags are [`MOVES`] and [`WHOLE`].
fn image(half: usize, [width, height]: [u32; 2], pixels: &[[u8; 4]], flags: u32) -> Message {
    let head = [half as u32, width, height, flags].map(u32::to_le_bytes);
    Message::binary([head.as_flattened(), pixels.as_flattened()].concat())
}

/// Shows a render: at the end, and before if it takes long enough. At rest, it ends when a request arrives.
pub(super) struct Showing<'a> {
    exchange: &'a Exchange,
    half: usize,
    size: [u32; 2],
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
        transfer: Transfer,
        moves: bool,
        figures: Value,
    ) -> Self {
        let pixels = vec![[0; 4]; size[0] as usize * size[1] as usize];
        let state = Mutex::new(Shown { pixels, figures, done: 0, next: Instant::now() + SHOWING });
        Self { exchange, half, size, transfer, moves, state }
    }

    /// Shows the whole image.
    pub(super) fn finish(&self, film: &Film) {
        let whole = Tile { x: 0, y: 0, width: self.size[0], height: self.size[1] };
        let mut state = lock(&self.state);
        self.keep(&mut state.pixels, &whole, &levels(film, self.transfer));
        self.show(&state.pixels, WHOLE);
    }

    fn show(&self, pixels: &[[u8; 4]], state: u32) {
        let flags = state | if self.moves { MOVES } else { 0 };
        let message = image(self.half, self.size, pixels, flags);
        self.exchange.send(Kind::image(self.half), message);
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
        let levels = row_to_bytes(means, self.transfer);
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
        self.show(pixels, 0);
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
    fn images_have_a_head_and_what_is_not_finished_is_transparent() {
        let exchange = Exchange::default();
        let showing = Showing::new(&exchange, 1, [2, 2], Transfer::Linear, true, Value::Null);
        let right = Tile { x: 1, y: 1, width: 1, height: 1 };
        let pixels = &mut [[0; 4]; 4];
        showing.keep(pixels, &right, &[255, 0, 51]);
        assert_eq!(pixels[..], [[0; 4], [0; 4], [0; 4], [255, 0, 51, 255]]);
        let Message::Binary(bytes) = image(1, [2, 2], pixels, MOVES) else { panic!("not binary") };
        assert_eq!(bytes[..16], *[1_u32, 2, 2, 1].map(u32::to_le_bytes).as_flattened());
        assert_eq!(bytes[16..], *pixels.as_flattened());
    }
}
