//! Reads images for comparison.
//!
//! PPM, PGM and PFM are read by this project's own reader; other formats by the `image` crate.
//! Integers become 0 to 1 without a transfer curve and floats are unchanged; alpha is dropped and
//! grey becomes equal red, green and blue. For animations the first frame is read.
//!
//! A file's header is not trusted: its size is checked against a limit and against the length of
//! the file before anything is allocated.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::{ColorType, ImageDecoder, ImageReader, Limits};

use super::netpbm;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::film::{Film, MAX_PIXELS, checked_pixel_count, reserve};

/// Largest number of bytes that a decoder may hold: [`MAX_PIXELS`] pixels of four floats.
const MAX_DECODED_BYTES: u64 = MAX_PIXELS * 16;

/// Largest unpacked size of a PNG file's header in bytes: larger colour profiles are ignored.
const MAX_METADATA: u64 = 8 << 20;

/// Decoded size in bytes up to which the length of an image's file does not matter.
const SMALL_IMAGE_BYTES: u64 = 1 << 26;

/// Largest ratio of a larger image to the length of its file. PNG and the ZIP method of EXR reach
/// 1032; only nearly empty images in other formats could exceed the limit.
const LARGEST_RATIO: u64 = 4096;

/// Reads the image at `path`.
///
/// # Errors
/// If the file cannot be read, has no known format, is damaged, or claims to be larger than
/// [`MAX_PIXELS`] or than its length allows. The error names the file.
pub fn read(path: &Path) -> Result<Film> {
    read_unnamed(path).map_err(|error| error.in_file(path))
}

fn read_unnamed(path: &Path) -> Result<Film> {
    let mut source = BufReader::new(open(path, "image")?);
    let length = source.get_ref().metadata().map_err(|e| read_error(path, e))?.len();
    let start = source.fill_buf().map_err(|e| read_error(path, e))?;
    if start.is_empty() {
        return Err(Error::new(ErrorKind::Syntax, "the file is empty").remedy("name an image"));
    }
    if netpbm::is_netpbm(start) {
        return netpbm::read(&mut source, length);
    }
    let mut reader = ImageReader::new(source);
    if let Ok(format) = image::ImageFormat::from_path(path) {
        // The content decides if it can; TGA has no magic number.
        reader.set_format(format);
    }
    let reader = reader.with_guessed_format().map_err(|e| read_error(path, e))?;
    // The decoders should not panic, but a damaged file must not end the program.
    catch_unwind(AssertUnwindSafe(|| decode(reader, length))).unwrap_or_else(|_| {
        Err(damaged("the decoder failed").remedy("the file is damaged or unusual"))
    })
}

/// Opens a regular file; `what` names its kind in messages. A pipe is refused before it is opened, which would
/// wait for a writer.
///
/// # Errors
/// If it is no regular file, or cannot be opened.
pub(crate) fn open(path: &Path, what: &str) -> Result<File> {
    let cannot = format!("cannot read the {what}");
    let data = path.metadata().map_err(|error| Error::io(&*cannot, path, error))?;
    if !data.is_file() {
        let found = if data.is_dir() { "a folder" } else { "not a regular file" };
        return Err(Error::new(ErrorKind::Io, format!("{cannot}: this is {found}"))
            .remedy("name a regular file"));
    }
    File::open(path).map_err(|error| Error::io(cannot, path, error))
}

fn read_error(path: &Path, error: std::io::Error) -> Error {
    Error::io("cannot read the image", path, error).remedy("check the file")
}

fn damaged(cause: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::Syntax, format!("cannot decode the image: {cause}"))
}

/// Decodes a file of `length` bytes after checking its header.
fn decode(mut reader: ImageReader<impl BufRead + Seek>, length: u64) -> Result<Film> {
    let Some(format) = reader.format() else {
        return Err(damaged("its format is unknown")
            .remedy("use PPM, PNG, EXR, PFM or another common format"));
    };
    let mut limits = Limits::no_limits();
    // These limits apply to the header of a PNG file; the sizes of all images are checked below.
    let is_png = format == image::ImageFormat::Png;
    limits.max_alloc = Some(if is_png { MAX_METADATA } else { MAX_DECODED_BYTES });
    reader.limits(limits);
    let fail = |error: image::ImageError| {
        damaged(&error)
            .remedy(format!("check that the file is a whole {format:?} image"))
            .because(error)
    };
    let decoder = reader.into_decoder().map_err(fail)?;
    let (width, height) = decoder.dimensions();
    let count = checked_pixel_count(width, height)?;
    check_ratio(&decoder, length)?;
    let color = decoder.color_type();
    let size = count * usize::from(color.bytes_per_pixel());
    let mut bytes = reserve(size)?;
    bytes.resize(size, 0);
    decoder.read_image(&mut bytes).map_err(fail)?;
    Film::from_pixels(width, height, pixels(&bytes, color, count)?)
}

fn check_ratio(decoder: &impl ImageDecoder, length: u64) -> Result<()> {
    let size = decoder.total_bytes();
    if size <= SMALL_IMAGE_BYTES.max(length.saturating_mul(LARGEST_RATIO)) {
        return Ok(());
    }
    let (width, height) = decoder.dimensions();
    let message = format!("the file is too short for {width} x {height} pixels");
    Err(Error::new(ErrorKind::Limit, message)
        .value(format!("{length} bytes"))
        .remedy("check that the file is whole"))
}

/// Decoded bytes, in native byte order, as colours.
fn pixels(bytes: &[u8], color: ColorType, count: usize) -> Result<Vec<[f32; 3]>> {
    let channels = usize::from(color.channel_count());
    let pixel_bytes = usize::from(color.bytes_per_pixel());
    let sample: fn(&[u8]) -> f32 = match pixel_bytes / channels {
        1 => |b| f32::from(b[0]) / 255.0,
        2 => |b| f32::from(u16::from_ne_bytes([b[0], b[1]])) / 65535.0,
        4 => |b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]),
        _ => return Err(damaged(format!("unknown numbers ({color:?})"))),
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
            "a.txt: cannot decode the image: its format is unknown; \
             use PPM, PNG, EXR, PFM or another common format"
        );
        assert_eq!(
            text("a.pfm", b"PF\n2 2\n-1\n1234"),
            "a.pfm: an image of 2 x 2 pixels needs 48 bytes after its header, found 4; \
             the file may be cut off"
        );
        assert!(text("a.png", b"\x89PNG\r\n\x1a\nrubbish").starts_with("a.png: cannot decode"));
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
                "{}: cannot read the image: this is a folder; name a regular file",
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
            qoi(17_000, 17_000),
            "a.qoi: an image has too many pixels, found 17000 x 17000 = 289000000; \
             at most 268435456 are allowed (such as 16384 x 16384)"
        );
        assert_eq!(
            qoi(16_384, 16_384),
            "a.qoi: the file is too short for 16384 x 16384 pixels, found 22 bytes; \
             check that the file is whole"
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

    /// Decodes without catching panics.
    fn decode_quietly(bytes: &[u8]) {
        let length = bytes.len() as u64;
        if netpbm::is_netpbm(bytes) {
            let _ = netpbm::read(&mut { bytes }, length);
        } else {
            let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().unwrap();
            let _ = decode(reader, length);
        }
    }
}
