//! Writes a film: as a PPM, PNG or JPEG with 8 bits a value, or as an EXR or a PFM that keeps every
//! float.
//!
//! Files are replaced atomically (see [`wavecrest_base::replace`]). Their bytes depend only on the
//! film and its metadata, not on the machine.

use std::ffi::OsStr;
use std::io::Write;
use std::path::Path;

use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder as _, ImageError};

use super::metadata::{ALPHA, Entry, Extras, Values, full_name};
use super::transfer::linear_level;
use super::{netpbm, openexr};
use wavecrest_base::choice::Choice as _;
use wavecrest_base::error::{Error, ErrorKind, Result, did_you_mean};
use wavecrest_base::progress;
use wavecrest_base::replace::{
    STANDARD_OUTPUT, Sink, check_replaceable, replace_file, write_error,
};
use wavecrest_core::film::Film;

pub use super::transfer::{Develop, Tone, Transfer, levels, row_to_bytes};

wavecrest_base::choices! {
    /// The formats that can be written, by file extension in lower case.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Format {
        /// Binary PPM (`P6`), 8 bits a value.
        Ppm = "ppm",
        /// PNG, 8 bits a value.
        Png = "png",
        /// OpenEXR, 32-bit floats.
        Exr = "exr",
        /// Portable float map, 32-bit floats.
        Pfm = "pfm",
        /// JPEG, 8 bits a value with small errors.
        Jpg = "jpg" | "jpeg",
    }
}

impl Format {
    /// The format for the extension of `path`, in upper or lower case; PNG for standard output.
    ///
    /// # Errors
    /// If there is no extension or it is none of these.
    pub fn from_path(path: &Path) -> Result<Self> {
        const FORMATS: &str = "use .png, .jpg, .ppm, .exr or .pfm";
        let usage = |message: &str| Error::new(ErrorKind::Usage, message).in_file(path);
        if path == Path::new(STANDARD_OUTPUT) {
            return Ok(Self::Png);
        }
        let Some(extension) = path.extension().map(OsStr::to_string_lossy) else {
            return Err(usage("the name of an image must end in its format").remedy(FORMATS));
        };
        let lower = extension.to_lowercase();
        Self::by_name(&lower).ok_or_else(|| {
            let error = usage("unknown image format").value(format!(".{extension}"));
            match did_you_mean(&lower, Self::ALL.map(Self::name)) {
                Some(near) => error.remedy(format!("did you mean .{near}? {FORMATS}")),
                None => error.remedy(FORMATS),
            }
        })
    }

    /// Whether it stores floats, so that [`Transfer`] has no effect.
    pub fn is_float(self) -> bool {
        matches!(self, Self::Exr | Self::Pfm)
    }

    /// Whether it stores alpha; these formats store metadata, too.
    pub fn has_alpha(self) -> bool {
        matches!(self, Self::Png | Self::Exr)
    }

    /// Whether an image of this format is developed before it is written.
    pub fn is_developed(self, develop: Develop) -> bool {
        !self.is_float() && develop != Develop::default()
    }
}

/// Checks that an image of so many pixels can be written at `path`: the sides of a JPEG have 16 bits.
///
/// # Errors
/// If it cannot.
pub fn check_size(path: &Path, [width, height]: [u32; 2]) -> Result<()> {
    let is_jpeg = Format::from_path(path).is_ok_and(|format| format == Format::Jpg);
    if is_jpeg && width.max(height) > u16::MAX.into() {
        let message = format!("a side of a JPEG has at most {} pixels", u16::MAX);
        let error = Error::new(ErrorKind::Limit, message).in_file(path);
        let error = error.value(format!("{width} x {height}"));
        return Err(error.remedy("use .png, or a smaller --size"));
    }
    Ok(())
}

/// Writes `film` at `path` in the format of the extension. An existing file stays unchanged until
/// the new one is complete.
///
/// # Errors
/// If the extension is unknown, the folder is missing or not writable, the disk is full, or `path`
/// is a folder, a device or a read-only file.
pub fn write(film: &Film, path: &Path, transfer: Transfer) -> Result<()> {
    write_with(film, path, transfer, &Extras::default())
}

/// As [`write()`], with the `extras` that the format can store.
///
/// # Errors
/// As [`write()`], and if a channel does not have one value for each pixel of the film.
pub fn write_with(film: &Film, path: &Path, transfer: Transfer, extras: &Extras<'_>) -> Result<()> {
    let format = Format::from_path(path)?;
    progress::expect(film.pixels().len() as u64);
    replace_file(path, |sink| write_to(sink, path, film, format, transfer, extras))
}

/// As [`write_with`], to a `sink` that errors call `path`.
///
/// # Errors
/// If `sink` cannot be written to, or a channel does not have one value for each pixel of the film.
pub fn write_to(
    sink: &mut Sink<'_>,
    path: &Path,
    film: &Film,
    format: Format,
    transfer: Transfer,
    extras: &Extras<'_>,
) -> Result<()> {
    let failed = |error| encode_error(path, error).in_file(path);
    encode(sink, film, format, transfer, extras).map_err(failed)
}

/// `film` as the bytes of a PNG.
///
/// # Errors
/// If the encoder has no memory for it.
pub fn png(film: &Film, transfer: Transfer) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_png(&mut bytes, film, None, transfer, &[])
        .map_err(|e| encode_error("a PNG".as_ref(), png_error(e)))?;
    Ok(bytes)
}

/// The levels of pixels, as [`levels`] gives them, as the bytes of a JPEG with this quality of 100.
///
/// # Errors
/// If a side has more pixels than a JPEG can have.
pub fn jpeg(levels: &[u8], size: [u32; 2], quality: u8) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_jpeg(&mut bytes, levels, size, quality)
        .map_err(|e| encode_error("a JPEG".as_ref(), e))?;
    Ok(bytes)
}

fn encode_jpeg(
    sink: impl Write,
    levels: &[u8],
    [width, height]: [u32; 2],
    quality: u8,
) -> std::result::Result<(), ImageError> {
    let encoder = JpegEncoder::new_with_quality(sink, quality);
    encoder.write_image(levels, width, height, ExtendedColorType::Rgb8)
}

/// With `alpha`, the coverage of each pixel, the colours are stored unmultiplied beside it.
fn encode_png(
    sink: impl Write,
    film: &Film,
    alpha: Option<&[f32]>,
    transfer: Transfer,
    entries: &[Entry],
) -> std::result::Result<(), png::EncodingError> {
    let (color, levels) = match alpha {
        None => (png::ColorType::Rgb, levels(film, transfer)),
        Some(alpha) => (png::ColorType::Rgba, straight_levels(film, alpha, transfer)),
    };
    let mut encoder = png_encoder(sink, [film.width(), film.height()], color, entries)?;
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&levels)?;
    writer.finish()
}

/// An encoder of images of this size, with the entries as text.
pub(super) fn png_encoder<'a, W: Write>(
    sink: W,
    [width, height]: [u32; 2],
    color: png::ColorType,
    entries: &[Entry],
) -> std::result::Result<png::Encoder<'a, W>, png::EncodingError> {
    let mut encoder = png::Encoder::new(sink, width, height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    entries.iter().try_for_each(|entry| add_text(&mut encoder, entry))?;
    Ok(encoder)
}

/// The levels of colours that are not multiplied by their coverage, and of the coverage.
fn straight_levels(film: &Film, alpha: &[f32], transfer: Transfer) -> Vec<u8> {
    let straight = |(color, &alpha): (&[f32; 3], &f32)| match alpha > 0.0 {
        true => color.map(|value| value / alpha),
        false => [0.0; 3],
    };
    let mut bytes = Vec::with_capacity(4 * film.pixels().len());
    for (colors, alpha) in film.rows().zip(alpha.chunks(film.width() as usize)) {
        let colors: Vec<[f32; 3]> = colors.iter().zip(alpha).map(straight).collect();
        for (level, &share) in row_to_bytes(&colors, transfer).chunks_exact(3).zip(alpha) {
            bytes.extend_from_slice(level);
            bytes.push(linear_level(share));
        }
    }
    bytes
}

/// The coverage of each pixel, if there is a channel for it.
fn alpha<'a>(film: &Film, extras: &Extras<'a>) -> std::io::Result<Option<&'a [f32]>> {
    let found = extras.channels.iter().find(|channel| channel.name == ALPHA);
    match found.map(|channel| &channel.values) {
        Some(Values::Floats(values)) if values.len() == film.pixels().len() => Ok(Some(values)),
        Some(_) => Err(std::io::Error::other("the alpha has another size")),
        None => Ok(None),
    }
}

/// Adds a text chunk; in Unicode, which fewer programs show, only if necessary.
fn add_text(
    encoder: &mut png::Encoder<'_, impl Write>,
    Entry { name, text }: &Entry,
) -> std::result::Result<(), png::EncodingError> {
    // The format has a standard name for the program.
    let name = if *name == "software" { "Software".to_owned() } else { full_name(name) };
    if text.is_ascii() {
        encoder.add_text_chunk(name, text.clone())
    } else {
        encoder.add_itxt_chunk(name, text.clone())
    }
}

pub(super) fn png_error(error: png::EncodingError) -> ImageError {
    match error {
        png::EncodingError::IoError(io) => ImageError::IoError(io),
        other => ImageError::IoError(other.into()),
    }
}

/// Whether [`write()`] could currently write at `path`; call it before a long render.
///
/// # Errors
/// As [`write()`], except for a full disk.
pub fn check_writable(path: &Path) -> Result<()> {
    Format::from_path(path)?;
    check_replaceable(path)
}

/// Of 100. With less, edges have visible ripples; with more, files are larger and look the same.
const JPEG_QUALITY: u8 = 92;

fn encode(
    sink: &mut Sink<'_>,
    film: &Film,
    format: Format,
    transfer: Transfer,
    extras: &Extras<'_>,
) -> std::result::Result<(), ImageError> {
    let comments = if extras.comments { extras.entries } else { &[] };
    let alpha = if format.is_float() { None } else { alpha(film, extras)? };
    let is_developed = format.is_developed(extras.develop);
    let developed = is_developed.then(|| extras.develop.film(film, alpha));
    let film = developed.as_ref().unwrap_or(film);
    match format {
        Format::Ppm => Ok(netpbm::write_ppm(sink, film, transfer, comments)?),
        Format::Pfm => Ok(netpbm::write_pfm(sink, film)?),
        Format::Jpg => {
            let size = [film.width(), film.height()];
            encode_jpeg(sink, &levels(film, transfer), size, JPEG_QUALITY)
        }
        Format::Png => encode_png(sink, film, alpha, transfer, extras.entries).map_err(png_error),
        // To memory first: the encoder turns the system's errors, such as a full disk, into text.
        // Nor does it have to seek in the file.
        Format::Exr => Ok(sink.write_all(&openexr::encode(film, extras)?)?),
    }
}

/// The system's own error, if there is one: it leads to the remedy.
pub(super) fn encode_error(path: &Path, error: ImageError) -> Error {
    match error {
        ImageError::IoError(io) => write_error(path, io),
        other => {
            Error::new(ErrorKind::Io, format!("cannot write the image: {other}")).because(other)
        }
    }
}
