//! The pixels of a PNG, filtered and compressed in bands on all threads.
//!
//! Each band is a separate stream of the crate fdeflate, which the crate png uses too; the streams
//! are joined into one (RFC 1950, RFC 1951). The bands depend only on the image, and so do the
//! bytes.

use std::io;

use fdeflate::{Compressor, StoredOnlyCompressor};
use rayon::prelude::*;
use wavecrest_core::film::Film;

use super::transfer::{Transfer, row_to_bytes};

/// Size of a band in bytes before compression, rounded to whole rows: far more than the 62 that it
/// adds to the file, and small enough that every thread has work.
const BAND: usize = 1 << 17;

/// Bytes of a pixel: red, green and blue.
const PIXEL: usize = 3;

/// The film as the content of a PNG's `IDAT` chunks, with 8 bits a value. `None` if that would be
/// longer than the uncompressed bytes.
///
/// # Errors
/// Only those of writing to memory, which never fails.
pub(super) fn compressed(film: &Film, transfer: Transfer) -> io::Result<Option<Vec<u8>>> {
    let width = film.width() as usize;
    let length = 1 + width * PIXEL;
    let rows = BAND.div_ceil(length);
    let bands = film.pixels().par_chunks(rows * width).enumerate().map(|(i, pixels)| {
        let start = i * rows * width;
        let above = match start.checked_sub(width) {
            Some(above) => row_to_bytes(&film.pixels()[above..start], transfer),
            None => vec![0; length - 1],
        };
        Band::new(&filtered(pixels.chunks_exact(width), above, transfer))
    });
    let joined = joined(&bands.collect::<io::Result<Vec<_>>>()?);
    let stored = StoredOnlyCompressor::<()>::compressed_size(length * film.height() as usize);
    Ok((joined.len() <= stored).then_some(joined))
}

/// Compressed rows.
struct Band {
    /// A header of [`HEADER`] bytes, one deflate block and a checksum.
    stream: Vec<u8>,
    /// Length before compression in bytes.
    length: usize,
}

/// Length in bytes of the header before a stream's block, and of the checksum after it.
const HEADER: usize = 2;
const CHECKSUM: usize = 4;

impl Band {
    fn new(bytes: &[u8]) -> io::Result<Self> {
        let mut compressor = Compressor::new(Vec::with_capacity(bytes.len() / 2))?;
        compressor.write_data(bytes)?;
        Ok(Self { stream: compressor.finish()?, length: bytes.len() })
    }

    fn block(&self) -> &[u8] {
        &self.stream[HEADER..self.stream.len() - CHECKSUM]
    }

    /// The two sums of Adler-32 (RFC 1950).
    fn sums(&self) -> [u64; 2] {
        let bytes = &self.stream[self.stream.len() - CHECKSUM..];
        let checksum = bytes.iter().fold(0, |sum, &byte| sum << 8 | u64::from(byte));
        [checksum & 0xFFFF, checksum >> 16]
    }
}

/// The bands as one stream.
fn joined(bands: &[Band]) -> Vec<u8> {
    /// The largest prime below 2^16, the modulus of Adler-32.
    const BASE: u64 = 65_521;
    let mut joined = Vec::with_capacity(bands.iter().map(|band| band.stream.len()).sum());
    joined.extend(bands.iter().take(1).flat_map(|band| &band.stream[..HEADER]));
    let [mut a, mut b] = [1, 0];
    for (i, band) in bands.iter().enumerate() {
        let first = joined.len();
        joined.extend_from_slice(band.block());
        if i + 1 < bands.len() {
            joined[first] &= !LAST;
            end_block(&mut joined);
        }
        // The sums of a band restart at 1 and 0.
        let [own_a, own_b] = band.sums();
        b = (b + own_b + band.length as u64 % BASE * (a + BASE - 1)) % BASE;
        a = (a + own_a + BASE - 1) % BASE;
    }
    joined.extend_from_slice(&((b << 16 | a) as u32).to_be_bytes());
    joined
}

/// The first bit of the last block.
const LAST: u8 = 1;

/// Ends the stream so far at a whole byte, with an empty block; its last block is padded with
/// zeros.
fn end_block(stream: &mut Vec<u8>) {
    // The new block starts with three zero bits for its kind, then its own padding. The code that
    // ends fdeflate's block has a 1 last.
    let padding = stream.last().map_or(0, |byte| byte.leading_zeros());
    if padding < 3 {
        stream.push(0);
    }
    stream.extend_from_slice(&[0, 0, 0xFF, 0xFF]);
}

/// The rows, each after the number of the filter that leaves the smallest residual. `above` is the
/// row before the first.
fn filtered<'a>(
    rows: impl ExactSizeIterator<Item = &'a [[f32; 3]]>,
    mut above: Vec<u8>,
    transfer: Transfer,
) -> Vec<u8> {
    let length = above.len();
    let mut filtered = Vec::with_capacity(rows.len() * (1 + length));
    let (mut tried, mut best) = (vec![0; length], vec![0; length]);
    for row in rows {
        let row = row_to_bytes(row, transfer);
        let (mut number, mut least) = (0, u64::MAX);
        for (n, filter) in FILTERS {
            filter(&row, &above, &mut tried);
            let rest = rest(&tried);
            if rest < least {
                (number, least) = (n, rest);
                std::mem::swap(&mut tried, &mut best);
            }
        }
        filtered.push(number);
        filtered.extend_from_slice(&best);
        above = row;
    }
    filtered
}

/// Filters a row, given the one above it.
type RowFilter = fn(&[u8], &[u8], &mut [u8]);

/// With their numbers. The format has two more, none and the mean, which are rarely the best.
const FILTERS: [(u8, RowFilter); 3] = [(1, sub), (2, up), (4, paeth)];

/// The sum of the magnitudes.
fn rest(bytes: &[u8]) -> u64 {
    let magnitude = |&byte: &u8| u16::from((byte as i8).unsigned_abs());
    // Short chunks, so that their sum fits into narrow lanes.
    bytes.chunks(128).map(|few| u64::from(few.iter().map(magnitude).sum::<u16>())).sum()
}

fn sub(row: &[u8], _: &[u8], out: &mut [u8]) {
    out[..PIXEL].copy_from_slice(&row[..PIXEL]);
    for ((out, x), left) in out[PIXEL..].iter_mut().zip(&row[PIXEL..]).zip(row) {
        *out = x.wrapping_sub(*left);
    }
}

fn up(row: &[u8], above: &[u8], out: &mut [u8]) {
    for ((out, x), up) in out.iter_mut().zip(row).zip(above) {
        *out = x.wrapping_sub(*up);
    }
}

fn paeth(row: &[u8], above: &[u8], out: &mut [u8]) {
    up(&row[..PIXEL], &above[..PIXEL], &mut out[..PIXEL]);
    let rest = out[PIXEL..].iter_mut().zip(&row[PIXEL..]).zip(&above[PIXEL..]);
    for ((((out, x), &up), &left), &corner) in rest.zip(row).zip(above) {
        let [a, b, c] = [left, up, corner].map(i16::from);
        let (to_left, to_up, to_corner) = ((b - c).abs(), (a - c).abs(), (a + b - c - c).abs());
        let other = if to_up <= to_corner { up } else { corner };
        let nearest = if to_left <= to_up && to_left <= to_corner { left } else { other };
        *out = x.wrapping_sub(nearest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavecrest_core::math::random::Stream;

    /// A film of several bands: partly smooth, flat and noisy.
    fn film(width: u32, height: u32, noise: f32) -> Film {
        let pixels = (0..width * height).map(|pixel| {
            let (x, y) = ((pixel % width) as f32, (pixel / width) as f32);
            let [a, b, c, _] = Stream { seed: 3, pixel, sample: 0, bounce: 0 }.uniform(0);
            let smooth = [x / width as f32, y / height as f32, (x * y).sin()];
            let mix = |smooth: f32, random: f32| smooth * (1.0 - noise) + random * noise;
            [mix(smooth[0], a), mix(smooth[1], b), mix(smooth[2], c)]
        });
        Film::from_pixels(width, height, pixels.collect()).unwrap()
    }

    #[test]
    fn bands_are_one_picture() {
        for (width, height) in [(1, 1), (1, 50_000), (700, 199), (50_000, 3)] {
            let film = film(width, height, 0.1);
            let bytes = super::super::write::png(&film, Transfer::Linear).unwrap();
            let found = image::load_from_memory(&bytes).unwrap().into_rgb8();
            let expected: Vec<u8> =
                film.rows().flat_map(|row| row_to_bytes(row, Transfer::Linear)).collect();
            assert!(*found.into_raw() == expected, "{width} x {height}");
        }
    }

    /// Each end of a band is tested: the zeros after it may or may not hold the next block's kind.
    #[test]
    fn streams_of_any_length_can_be_joined() {
        let mut paddings = [0; 8];
        for i in 0..200_u8 {
            let parts = [vec![i; 3], vec![0; 5 + usize::from(i)], (0..i).collect(), vec![]];
            let bands: Vec<Band> = parts.iter().map(|part| Band::new(part).unwrap()).collect();
            for band in &bands {
                paddings[band.block().last().unwrap().leading_zeros() as usize] += 1;
            }
            let inflated = fdeflate_decompress(&joined(&bands));
            assert_eq!(inflated, parts.concat(), "{i}");
        }
        assert!(paddings.iter().all(|&n| n > 0), "{paddings:?}");
    }

    fn fdeflate_decompress(stream: &[u8]) -> Vec<u8> {
        fdeflate::decompress_to_vec(stream).expect("one stream with its checksum")
    }

    #[test]
    fn bytes_do_not_depend_on_threads_and_noise_is_stored() {
        let bytes = |film: &Film, threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| super::super::write::png(film, Transfer::Srgb).unwrap())
        };
        let (smooth, noise) = (film(500, 300, 0.0), film(500, 300, 1.0));
        assert!(compressed(&smooth, Transfer::Linear).unwrap().is_some());
        assert!(compressed(&noise, Transfer::Linear).unwrap().is_none());
        for film in [&smooth, &noise] {
            assert!(bytes(film, 1) == bytes(film, 3));
            assert!(bytes(film, 1).len() < 500 * 300 * 3 + 2000);
        }
    }
}
