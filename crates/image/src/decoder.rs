//! Decoders of image files: of the `image` crate, but for the colours of [`exr`] and the headers of
//! [`radiance`].
//!
//! A file's header is not trusted: the sizes in it are checked against limits and against the length
//! of the file before anything is allocated, and a decoder that panics ends in an error.

mod exr;
mod radiance;

use std::cell::Cell;
use std::fmt;
use std::io::{self, BufRead, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::error::{DecodingError, ImageFormatHint};
use image::{ImageDecoder, ImageError, ImageFormat, ImageReader, ImageResult, Limits};

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::words::Size;

/// Largest image, in pixels on a side.
const MAX_SIDE: u32 = 1 << 16;
/// Largest image in bytes, as decoded and as held.
const MAX_BYTES: u64 = 4 << 30;
/// Decoded size in bytes up to which the length of an image's file does not matter.
const SMALL_BYTES: u64 = 64 << 20;
/// Largest ratio of the decoded size of a larger image to the length of its file. PNG and the ZIP
/// method of EXR reach 1032, JPEG about as much; only nearly empty images in other formats could
/// exceed the limit.
const LARGEST_RATIO: u64 = 4096;
/// Largest unpacked size of an image's header in bytes: larger colour profiles are ignored.
const MAX_METADATA: u64 = 8 << 20;

/// The first bytes of a KTX2 file, which glTF files may have.
const KTX2: &[u8] = b"\xABKTX 20\xBB";

/// What is wrong with a file, and what helps.
#[derive(Debug)]
struct Fault {
    message: String,
    remedy: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(&self.message)
    }
}

impl std::error::Error for Fault {}

impl From<Fault> for ImageError {
    fn from(fault: Fault) -> Self {
        Self::Decoding(DecodingError::new(ImageFormatHint::Unknown, fault))
    }
}

/// The content of an image file. Decoders read it as such, so that each is compiled once.
pub trait Content: BufRead + Seek {}

impl<T: BufRead + Seek> Content for T {}

/// Runs `work` with the decoder of an image file, which has read only the header, and with what makes
/// an error about the file from that of the decoder. `what` names the file in messages; a format
/// without a magic number is known by its `path`. `open` gives the content and its length in bytes.
///
/// # Errors
/// If the file cannot be opened, the format is unknown, the header is malformed, there are no pixels,
/// or more than allowed or than a file of this length can hold; or if `work` fails.
pub fn decode<'a, R>(
    what: &str,
    path: Option<&Path>,
    open: impl FnOnce() -> io::Result<(Box<dyn Content + 'a>, u64)>,
    work: impl FnOnce(Box<dyn ImageDecoder + 'a>, &dyn Fn(ImageError) -> Error) -> Result<R>,
) -> Result<R> {
    let is_packed = Cell::new(false);
    let fail = |error| cannot_read(what, error, is_packed.get());
    // The decoders should not panic, but a damaged file must not end the program.
    catch_unwind(AssertUnwindSafe(|| {
        let (mut content, length) = open().map_err(|error| fail(error.into()))?;
        is_packed.set(content.fill_buf().is_ok_and(|start| start.starts_with(KTX2)));
        let decoder = decoder(content, path).map_err(fail)?;
        check(what, &decoder, length)?;
        work(decoder, &fail)
    }))
    .unwrap_or_else(|_| Err(fail(io::Error::other("the decoder failed").into())))
}

/// The decoder of the format of the first bytes, or else of the extension.
fn decoder<'a>(
    mut content: Box<dyn Content + 'a>,
    path: Option<&Path>,
) -> ImageResult<Box<dyn ImageDecoder + 'a>> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    let start = content.fill_buf()?;
    let mut decoder: Box<dyn ImageDecoder + 'a> = if start.starts_with(exr::MAGIC) {
        Box::new(exr::Exr::new(content)?)
    } else if start.starts_with(radiance::MAGIC) {
        Box::new(radiance::Radiance::new(content)?)
    } else {
        let mut reader = ImageReader::new(content);
        if let Some(format) = path.and_then(|path| ImageFormat::from_path(path).ok()) {
            reader.set_format(format);
        }
        let mut reader = reader.with_guessed_format()?;
        // These limits apply only to the headers of PNG files; decoding uses those below.
        limits.max_alloc = Some(MAX_METADATA);
        reader.limits(limits.clone());
        Box::new(reader.into_decoder()?)
    };
    limits.max_alloc = Some(MAX_BYTES);
    limits.reserve(decoder.total_bytes())?;
    decoder.set_limits(limits)?;
    Ok(decoder)
}

/// Checks the size in a header against limits, and against the `length` of the file.
fn check(what: &str, decoder: &dyn ImageDecoder, length: u64) -> Result<()> {
    let ((width, height), color) = (decoder.dimensions(), decoder.color_type());
    let refused = |message: &str, found: String, remedy: String| {
        let error = Error::new(ErrorKind::Limit, format!("{what} {message}"));
        Err(error.value(format!("{width} x {height}{found}")).remedy(remedy))
    };
    let whole = || "check that the file is whole".to_owned();
    if width == 0 || height == 0 {
        return refused("has no pixels", String::new(), whole());
    }
    // Bytes are held as four for each pixel, other numbers as three floats.
    let is_bytes = color.bytes_per_pixel() == color.channel_count();
    let held = u64::from(width) * u64::from(height) * if is_bytes { 4 } else { 12 };
    if held > MAX_BYTES {
        let remedy = format!("use a smaller image: at most {} are allowed", Size(MAX_BYTES));
        return refused("takes too much memory once decoded", format!(", {}", Size(held)), remedy);
    }
    if decoder.total_bytes() > SMALL_BYTES.max(length.saturating_mul(LARGEST_RATIO)) {
        let found = format!(" in {length} bytes");
        return refused("has more pixels than its file can hold", found, whole());
    }
    Ok(())
}

fn cannot_read(what: &str, error: ImageError, is_packed: bool) -> Error {
    let whole = "check that the file is whole and is an image";
    let source = std::error::Error::source(&error);
    let fault = source.and_then(|source| source.downcast_ref::<Fault>());
    let (message, remedy) = match (&error, fault) {
        (_, Some(fault)) => (fault.to_string(), fault.remedy.clone()),
        (ImageError::Limits(_), _) => {
            let remedy = format!("use at most {MAX_SIDE} pixels on a side and {MAX_BYTES} bytes");
            (error.to_string(), remedy)
        }
        _ if is_packed => {
            (error.to_string(), "unpack it: gltf-transform ktxdecompress IN OUT".to_owned())
        }
        (ImageError::Unsupported(_), _) => {
            (error.to_string(), "use PNG, EXR or another common format".to_owned())
        }
        (ImageError::IoError(io), _) => match io.kind() {
            io::ErrorKind::UnexpectedEof => ("it ends too early".to_owned(), whole.to_owned()),
            io::ErrorKind::NotFound => {
                ("there is no such file".to_owned(), "check the path".to_owned())
            }
            io::ErrorKind::PermissionDenied => (io.to_string(), "check who owns it".to_owned()),
            _ => (io.to_string(), whole.to_owned()),
        },
        _ => (error.to_string(), whole.to_owned()),
    };
    let message = format!("cannot read {what}: {message}");
    Error::new(ErrorKind::Texture, message).remedy(remedy).because(error)
}
