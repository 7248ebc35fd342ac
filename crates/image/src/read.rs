//! Reads images for comparison.
//!
//! PPM, PGM and PFM are read by this project's own reader; other formats by the `image` crate.
//! Integers become 0 to 1 without a transfer curve and floats are unchanged; alpha is dropped and
//! grey becomes equal red, green and blue. For animations the first frame is read.
//!
//! A file's header is not trusted: see [`super::decoder`].

use std::io::{BufRead, BufReader};
use std::path::Path;

use image::{ColorType, ImageDecoder, ImageError};

use super::decoder;
use super::netpbm;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::read::open;
use wavecrest_core::film::{Film, checked_pixel_count, reserve};

/// Reads the image at `path`.
///
/// # Errors
/// If the file cannot be read, has no known format, is damaged, or claims to be larger than a film
/// can be or than its length allows. The error names the file.
pub fn read(path: &Path) -> Result<Film> {
    read_unnamed(path).map_err(|error| error.in_file(path))
}

fn read_unnamed(path: &Path) -> Result<Film> {
    let failed = |error| Error::io("cannot read the image", path, error);
    let (file, length) = open(path).map_err(failed)?;
    let mut source = BufReader::new(file);
    let start = source.fill_buf().map_err(|error| failed(error).remedy("check the file"))?;
    if start.is_empty() {
        return Err(Error::new(ErrorKind::Syntax, "the file is empty").remedy("name an image"));
    }
    if netpbm::is_netpbm(start) {
        return netpbm::read(&mut source, length);
    }
    decoder::decode("the image", Some(path), || Ok((Box::new(source), length)), film)
}

/// The film of a decoder whose header has been checked.
fn film(decoder: Box<dyn ImageDecoder + '_>, fail: &dyn Fn(ImageError) -> Error) -> Result<Film> {
    let (width, height) = decoder.dimensions();
    let count = checked_pixel_count(width, height)?;
    let color = decoder.color_type();
    let size = count * usize::from(color.bytes_per_pixel());
    let mut bytes = reserve(size)?;
    bytes.resize(size, 0);
    decoder.read_image(&mut bytes).map_err(fail)?;
    Film::from_pixels(width, height, pixels(&bytes, color, count)?)
}

/// Decoded bytes, in native byte order, as colours.
fn pixels(bytes: &[u8], color: ColorType, count: usize) -> Result<Vec<[f32; 3]>> {
    let channels = usize::from(color.channel_count());
    let pixel_bytes = usize::from(color.bytes_per_pixel());
    let sample: fn(&[u8]) -> f32 = match pixel_bytes / channels {
        1 => |b| f32::from(b[0]) / 255.0,
        2 => |b| f32::from(u16::from_ne_bytes([b[0], b[1]])) / 65535.0,
        4 => |b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]),
        _ => {
            let message = format!("cannot read the image: unknown numbers ({color:?})");
            return Err(Error::new(ErrorKind::Texture, message));
        }
    };
    // With one or two channels, the first is grey.
    let places = if channels < 3 { [0, 0, 0] } else { [0, 1, 2] };
    let step = pixel_bytes / channels;
    let mut pixels = reserve(count)?;
    pixels.extend(bytes.chunks_exact(pixel_bytes).map(|b| places.map(|p| sample(&b[p * step..]))));
    Ok(pixels)
}
