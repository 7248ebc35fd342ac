//! An image on its way to pages: exact, or as a JPEG, smaller if need be, for a page whose line is slow.
//!
//! A JPEG is made when the first page needs it, and once for all pages. A slow line takes an image in parts, so that what
//! moves need not wait behind one that does not.

use std::sync::{Arc, OnceLock};

use hyper::body::Bytes;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::protocol::frame::Frame;
use tokio_tungstenite::tungstenite::protocol::frame::coding::{Data, OpCode};

use wavecrest_image::write::jpeg;

/// Flags of an image: something moves, all of it is finished, it is a JPEG.
pub(super) const MOVES: u32 = 1;
pub(super) const WHOLE: u32 = 2;
const LOSSY: u32 = 4;

/// The most by which the sides of an image are divided: fewer pixels show nothing.
const MOST_REDUCED: usize = 16;
/// Of 100. Of noisy images a file's quality would take twice the bytes, for a moment.
const QUALITY: u8 = 75;
/// The longest frame of a message, in bytes.
const LONGEST_FRAME: usize = 64 << 10;

/// An image of a half.
pub(super) struct Picture {
    half: usize,
    size: [u32; 2],
    flags: u32,
    /// Whether it is the last one until something changes, which is exact on every line.
    rests: bool,
    /// Red, green, blue and opacity of each pixel, the top row first. What is not finished is transparent.
    exact: Bytes,
    /// As JPEGs, with sides divided by 1, by 2, and so on.
    lossy: [OnceLock<Option<Bytes>>; MOST_REDUCED],
}

impl Picture {
    pub(super) fn new(
        half: usize,
        size: [u32; 2],
        pixels: &[[u8; 4]],
        flags: u32,
        rests: bool,
    ) -> Self {
        let exact = Bytes::copy_from_slice(pixels.as_flattened());
        Self { half, size, flags, rests, exact, lossy: Default::default() }
    }

    /// The pixels.
    #[cfg(test)]
    pub(super) fn exact(&self) -> &Bytes {
        &self.exact
    }

    fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// By what its sides are divided in a JPEG of about `budget` bytes, at so many bytes a pixel; `None` if it is to be exact.
    /// What rests is a JPEG at most the `first` time, with all its pixels.
    pub(super) fn reduction(&self, budget: usize, density: f64, first: bool) -> Option<usize> {
        // A JPEG has no place for what is not finished.
        let is_lossy = self.has(WHOLE) && (first || !self.rests);
        if !is_lossy || self.exact.len() <= budget {
            return None;
        }
        let pixels = f64::from(self.size[0]) * f64::from(self.size[1]);
        let by = (pixels * density / budget as f64).sqrt().ceil() as usize;
        Some(if self.has(MOVES) { by.clamp(1, MOST_REDUCED) } else { 1 })
    }

    /// Whether a line that passes `budget` bytes between two images is without it: it moves, and soon all of it comes.
    pub(super) fn is_spared(&self, budget: usize) -> bool {
        self.has(MOVES) && !self.has(WHOLE) && self.exact.len() > budget
    }

    /// Whether the rest of it is not sent any more once there is `newer`.
    pub(super) fn gives_way(&self, newer: &Self) -> bool {
        let is_better = newer.has(MOVES) || self.rests || !self.has(WHOLE) && newer.has(WHOLE);
        !self.has(MOVES) && is_better
    }

    /// What is sent of it: a JPEG with sides divided by `by`, or the pixels.
    pub(super) fn parcel(self: Arc<Self>, by: Option<usize>) -> Parcel {
        let made = by.and_then(|by| {
            let made = self.lossy[by - 1].get_or_init(|| {
                let (levels, size) = self.reduced(by);
                jpeg(&levels, size, QUALITY).ok().map(Bytes::from)
            });
            made.clone().map(|bytes| (bytes, self.sides(by).map(|side| side as u32), LOSSY))
        });
        let (bytes, size, lossy) = made.unwrap_or_else(|| (self.exact.clone(), self.size, 0));
        let head = [self.half as u32, size[0], size[1], self.flags | lossy, bytes.len() as u32];
        Parcel { head, bytes, sent: 0, picture: self }
    }

    fn sides(&self, by: usize) -> [usize; 2] {
        self.size.map(|side| (side as usize).div_ceil(by))
    }

    /// Red, green and blue, as means of squares of pixels.
    fn reduced(&self, by: usize) -> (Vec<u8>, [u32; 2]) {
        let [width, height] = self.sides(by);
        let mut levels = Vec::with_capacity(3 * width * height);
        let rows: Vec<&[u8]> = self.exact.chunks_exact(4 * self.size[0] as usize).collect();
        let mut sums = vec![[0_u32; 3]; width];
        for rows in rows.chunks(by) {
            sums.fill([0; 3]);
            for row in rows {
                for (sum, pixels) in sums.iter_mut().zip(row.chunks(4 * by)) {
                    for pixel in pixels.chunks_exact(4) {
                        *sum = [0, 1, 2].map(|channel| sum[channel] + u32::from(pixel[channel]));
                    }
                }
            }
            for (x, sum) in sums.iter().enumerate() {
                let count = rows.len() * by.min(self.size[0] as usize - x * by);
                levels.extend(sum.map(|sum| (sum / count as u32) as u8));
            }
        }
        (levels, [width as u32, height as u32])
    }
}

/// The bytes of an image for a page, and how many of them have been sent.
pub(super) struct Parcel {
    /// The half, width, height, flags and number of bytes.
    head: [u32; 5],
    bytes: Bytes,
    sent: usize,
    pub(super) picture: Arc<Picture>,
}

impl Parcel {
    /// Whether it is a JPEG of what is exact in the end.
    pub(super) fn is_preview(&self) -> bool {
        self.picture.rests && self.density().is_some()
    }

    /// The bytes of each of its pixels, if it is a JPEG.
    pub(super) fn density(&self) -> Option<f64> {
        let [_, width, height, flags, length] = self.head.map(f64::from);
        (flags as u32 & LOSSY != 0).then(|| length / (width * height))
    }

    pub(super) fn is_sent(&self) -> bool {
        self.sent == self.bytes.len()
    }

    /// The next `most` bytes: a head of 32 bits each, which ends with the number of bytes before, and the bytes, in frames
    /// of a length of which a page that does not read holds few: they share the bytes.
    pub(super) fn part(&mut self, most: usize) -> (usize, Vec<Message>) {
        let [a, b, c, d, e] = self.head;
        let head = [a, b, c, d, e, self.sent as u32].map(u32::to_le_bytes);
        let bytes = self.bytes.slice(self.sent..self.bytes.len().min(self.sent + most));
        self.sent += bytes.len();
        let starts = (0..bytes.len()).step_by(LONGEST_FRAME);
        let frames = starts.map(|from| {
            let to = bytes.len().min(from + LONGEST_FRAME);
            let code = OpCode::Data(Data::Continue);
            Message::Frame(Frame::message(bytes.slice(from..to), code, to == bytes.len()))
        });
        let head = Bytes::copy_from_slice(head.as_flattened());
        let head = Message::Frame(Frame::message(head, OpCode::Data(Data::Binary), false));
        let frames = std::iter::once(head).chain(frames).collect();
        (bytes.len(), frames)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_divided_into_parts_and_what_moves_is_made_small() {
        let pixels = [[10, 20, 30, 255], [30, 40, 50, 255], [50, 60, 70, 255]].repeat(2);
        let picture = |flags, rests| Arc::new(Picture::new(1, [3, 2], &pixels, flags, rests));
        let moving = picture(MOVES | WHOLE, false);
        assert_eq!(moving.reduced(2), (vec![20, 30, 40, 50, 60, 70], [2, 1]));
        assert_eq!(moving.reduced(1).0, [10, 20, 30, 30, 40, 50, 50, 60, 70].repeat(2));
        let choose = |picture: &Picture, budget| picture.reduction(budget, 0.5, false);
        assert_eq!([choose(&moving, 24), choose(&moving, 1)], [None, Some(2)]);
        let (pass, part) = (picture(WHOLE, false), picture(0, false));
        assert_eq!(
            [&pass, &part, &picture(WHOLE, true)].map(|p| choose(p, 1)),
            [Some(1), None, None]
        );
        assert_eq!(picture(WHOLE, true).reduction(1, 0.5, true), Some(1));
        assert!(pass.gives_way(&moving) && part.gives_way(&pass) && !pass.gives_way(&part));
        assert!(!moving.gives_way(&moving) && picture(MOVES, false).is_spared(1));

        let mut exact = pass.parcel(None);
        let (length, frames) = exact.part(16);
        let [Message::Frame(head), Message::Frame(bytes)] = &frames[..] else {
            panic!("{frames:?}")
        };
        assert_eq!(
            head.payload()[..],
            *[1_u32, 3, 2, 2, 24, 0].map(u32::to_le_bytes).as_flattened()
        );
        assert!(length == 16 && bytes.payload()[..] == pixels.as_flattened()[..16]);
        assert!(exact.part(16).0 == 8 && exact.is_sent() && exact.density().is_none());
        assert!(moving.parcel(Some(2)).density().is_some());
    }
}
