//! Shows work in progress: the stages of preparing a scene, and an image that is being rendered.

use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tokio_tungstenite::tungstenite::Message;

use super::exchange::{Exchange, Kind};
use wavecrest_base::{memory, progress};
use wavecrest_core::film::Film;
use wavecrest_core::render::Watch;
use wavecrest_core::tile::Tile;
use wavecrest_image::write::{Transfer, levels};

/// How often pages are shown what is new.
const SHOWING: Duration = Duration::from_millis(100);
/// Bytes of the head of an image: its half, its width and height, and flags, each as 32 bits.
const HEAD: usize = 16;

/// A message of values.
pub(super) fn text(value: &Value) -> Message {
    Message::text(value.to_string())
}

/// The message of an image: red, green, blue and opacity of each pixel, the top row first. `levels` lacks the opacity.
pub(super) fn image(half: usize, [width, height]: [u32; 2], levels: &[u8], moves: bool) -> Message {
    let mut bytes = Vec::with_capacity(HEAD + levels.len() / 3 * 4);
    bytes.extend(
        [half as u32, width, height, u32::from(moves)].map(u32::to_le_bytes).as_flattened(),
    );
    bytes.extend(levels.chunks_exact(3).flat_map(|rgb| [rgb[0], rgb[1], rgb[2], u8::MAX]));
    Message::binary(bytes)
}

/// Tells pages how far the preparation of a scene is, until it is dropped.
pub(super) struct Telling(Option<(Sender<()>, JoinHandle<()>)>);

impl Telling {
    pub(super) fn begin(exchange: Arc<Exchange>) -> Self {
        progress::begin();
        let (stop, stopped) = channel();
        let tell = move || {
            loop {
                let ([done, all], stage) = (progress::now(), memory::Stage::now().name());
                let told = json!({"kind": "progress", "stage": stage, "done": done, "all": all});
                exchange.tell(Kind::Progress, text(&told));
                if stopped.recv_timeout(SHOWING) != Err(RecvTimeoutError::Timeout) {
                    break;
                }
            }
        };
        // Without a thread nothing is told.
        Self(thread::Builder::new().spawn(tell).ok().map(|thread| (stop, thread)))
    }
}

impl Drop for Telling {
    fn drop(&mut self) {
        if let Some((stop, thread)) = self.0.take() {
            drop(stop);
            let _ = thread.join();
        }
    }
}

/// Shows a render in progress, if it takes long enough, and ends it when a request arrives.
pub(super) struct Showing<'a> {
    pub(super) exchange: &'a Exchange,
    pub(super) half: usize,
    pub(super) size: [u32; 2],
    pub(super) transfer: Transfer,
    pub(super) state: Mutex<Shown>,
}

/// What is shown of a render.
pub(super) struct Shown {
    /// The image so far: red, green and blue of each pixel.
    pub(super) levels: Vec<u8>,
    /// What is told beside it.
    pub(super) figures: Value,
    /// The pixels that are finished.
    pub(super) done: u64,
    /// When it was shown last.
    pub(super) last: Instant,
}

/// An image of another size, from the nearest pixels.
pub(super) fn enlarged(levels: &[u8], from: [u32; 2], to: [u32; 2]) -> Vec<u8> {
    let [[width, height], to] = [from, to].map(|size| size.map(|side| side as usize));
    let mut all = Vec::with_capacity(3 * to[0] * to[1]);
    for y in 0..to[1] {
        let row = &levels[3 * width * (y * height / to[1])..];
        all.extend((0..to[0]).flat_map(|x| {
            let at = 3 * (x * width / to[0]);
            [row[at], row[at + 1], row[at + 2]]
        }));
    }
    all
}

impl Watch for Showing<'_> {
    fn tile(&self, tile: &Tile, pixels: &[[f32; 3]]) {
        let Ok(film) = Film::from_pixels(tile.width, tile.height, pixels.to_vec()) else { return };
        let new = levels(&film, self.transfer);
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let Shown { levels, figures, done, last } = &mut *state;
        let [width, row] = [self.size[0], tile.width].map(|pixels| 3 * pixels as usize);
        let rows = levels.chunks_exact_mut(width).skip(tile.y as usize);
        for (all, new) in rows.zip(new.chunks_exact(row)) {
            all[3 * tile.x as usize..][..row].copy_from_slice(new);
        }
        *done += tile.len() as u64;
        if last.elapsed() >= SHOWING {
            *last = Instant::now();
            let share = *done as f64 / self.size.map(f64::from).iter().product::<f64>();
            if let Some(half) = figures["halves"].get_mut(self.half) {
                half["done"] = share.into();
            }
            self.exchange.tell(Kind::Figures, text(figures));
            self.exchange.tell(Kind::image(self.half), image(self.half, self.size, levels, false));
        }
    }

    fn cancelled(&self) -> bool {
        self.exchange.inbox.has_any()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_have_a_head_and_four_bytes_a_pixel_and_grow_by_whole_pixels() {
        let levels = [10, 20, 30, 40, 50, 60];
        let Message::Binary(bytes) = image(1, [2, 1], &levels, true) else { panic!("not binary") };
        let head = [1_u32, 2, 1, 1].map(u32::to_le_bytes);
        assert_eq!(bytes[..HEAD], *head.as_flattened());
        assert_eq!(bytes[HEAD..], [10, 20, 30, 255, 40, 50, 60, 255]);
        let large = enlarged(&levels, [2, 1], [4, 2]);
        let row = [10, 20, 30, 10, 20, 30, 40, 50, 60, 40, 50, 60];
        assert_eq!(large, [row, row].concat());
    }
}
