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

#[cfg(test)]
mod tests {
    use super::super::write::{Format, Transfer, write};
    use super::*;
    use image::{DynamicImage, ImageFormat};
    use std::io::Cursor;

    fn bytes_of(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn read_bytes(name: &str, bytes: &[u8]) -> Result<Film> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let strip = folder.path().display().to_string() + "/";
        read(&path).map_err(|e| {
            let text = e.to_string().replace(&strip, "");
            Error::new(e.kind(), text)
        })
    }

    #[test]
    fn numbers_of_8_and_16_bits_become_0_to_1() {
        let narrow =
            DynamicImage::ImageRgb8(image::RgbImage::from_raw(1, 1, vec![0, 51, 255]).unwrap());
        let wide = image::ImageBuffer::from_raw(1, 1, vec![0u16, 13107, 65535]).unwrap();
        let wide = DynamicImage::ImageRgb16(wide);
        for (image, format) in [
            (&narrow, ImageFormat::Png),
            (&wide, ImageFormat::Png),
            (&narrow, ImageFormat::Bmp),
            (&narrow, ImageFormat::Tiff),
            (&wide, ImageFormat::Tiff),
            (&narrow, ImageFormat::Qoi),
        ] {
            // The content decides, not the name.
            let film = read_bytes("a.jpg", &bytes_of(image, format)).unwrap();
            assert_eq!(film.pixels(), [[0.0, 0.2, 1.0]], "{format:?}");
        }
        let tga = read_bytes("a.tga", &bytes_of(&narrow, ImageFormat::Tga)).unwrap();
        assert_eq!(tga.pixels(), [[0.0, 0.2, 1.0]]);
    }

    #[test]
    fn grey_is_spread_and_alpha_left_out() {
        let grey = DynamicImage::ImageLuma8(image::GrayImage::from_raw(1, 1, vec![51]).unwrap());
        let both = image::GrayAlphaImage::from_raw(1, 1, vec![51, 0]).unwrap();
        let rgba = image::RgbaImage::from_raw(1, 1, vec![51, 102, 255, 3]).unwrap();
        let pixel =
            |image| read_bytes("a.png", &bytes_of(&image, ImageFormat::Png)).unwrap().pixels()[0];
        assert_eq!(pixel(grey), [0.2; 3]);
        assert_eq!(pixel(DynamicImage::ImageLumaA8(both)), [0.2; 3]);
        assert_eq!(pixel(DynamicImage::ImageRgba8(rgba)), [0.2, 0.4, 1.0]);
    }

    #[test]
    fn files_that_are_no_images_have_their_messages() {
        let text = |name, bytes: &[u8]| read_bytes(name, bytes).unwrap_err().to_string();
        assert_eq!(text("a.png", b""), "a.png: the file is empty; name an image");
        assert_eq!(
            text("a.txt", b"hello there, world"),
            "a.txt: cannot read the image: The image format could not be determined; \
             use PNG, EXR or another common format"
        );
        assert_eq!(
            text("a.pfm", b"PF\n2 2\n-1\n1234"),
            "a.pfm: an image of 2 x 2 pixels needs 48 bytes after its header, found 4; \
             the file may be cut off"
        );
        assert!(text("a.png", b"\x89PNG\r\n\x1a\nrubbish").starts_with("a.png: cannot read"));
    }

    #[test]
    fn files_that_cannot_be_opened_have_their_messages() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let text = read(&path).unwrap_err().to_string();
        assert_eq!(
            text,
            format!(
                "{}: cannot read the image: there is no such file; check the path",
                path.display()
            )
        );
        assert_eq!(
            read(folder.path()).unwrap_err().to_string(),
            format!(
                "{}: cannot read the image: it is a folder; name a file",
                folder.path().display()
            )
        );
    }

    #[test]
    fn a_header_that_asks_for_too_much_is_refused() {
        // A QOI file begins with a magic number, two sizes, channels and colour space, all easy to
        // forge.
        let qoi = |width: u32, height: u32| {
            let mut bytes = b"qoif".to_vec();
            bytes.extend(width.to_be_bytes());
            bytes.extend(height.to_be_bytes());
            bytes.extend([3, 0, 0, 0, 0, 0, 0, 0, 0, 1]);
            read_bytes("a.qoi", &bytes).unwrap_err().to_string()
        };
        assert_eq!(
            qoi(16_384, 16_384),
            "a.qoi: the image has more pixels than its file can hold, found 16384 x 16384 in \
             22 bytes; check that the file is whole"
        );
    }

    #[test]
    fn damaged_files_never_panic() {
        let folder = tempfile::tempdir().unwrap();
        let film =
            Film::from_pixels(9, 7, (0..63).map(|i| [i as f32 / 63.0; 3]).collect()).unwrap();
        for format in Format::ALL {
            let path = folder.path().join(format!("a.{}", format.name()));
            write(&film, &path, Transfer::Linear).unwrap();
            let whole = std::fs::read(&path).unwrap();
            for cut in (0..whole.len()).step_by(whole.len() / 40 + 1) {
                decode_quietly(&whole[..cut]);
            }
            for place in 0..whole.len().min(600) {
                let mut bytes = whole.clone();
                for value in [0, 0x7f, 0xff, bytes[place] ^ 1] {
                    bytes[place] = value;
                    decode_quietly(&bytes);
                }
            }
        }
    }

    /// Decodes, and checks that no decoder panics.
    fn decode_quietly(bytes: &[u8]) {
        let length = bytes.len() as u64;
        let read = match netpbm::is_netpbm(bytes) {
            true => netpbm::read(&mut { bytes }, length),
            false => {
                decoder::decode("it", None, || Ok((Box::new(Cursor::new(bytes)), length)), film)
            }
        };
        let told = read.map_or_else(|error| error.to_string(), |_| String::new());
        assert!(!told.contains("the decoder failed"), "{told}");
    }
}
