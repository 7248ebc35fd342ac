//! Writes a film: as a PPM or a PNG with 8 bits a value, or as an EXR or a PFM that keeps every
//! float.
//!
//! Files are replaced atomically (see [`wavecrest_base::replace`]). Their bytes depend only on the
//! film and its metadata, not on the machine.

use std::ffi::OsStr;
use std::io::Write;
use std::path::Path;

use image::ImageError;

use super::metadata::{ALPHA, Entry, Extras, Values, full_name};
use super::transfer::{linear_level, row_to_bytes};
use super::{idat, netpbm, openexr};
use wavecrest_base::error::{Error, ErrorKind, Result, did_you_mean};
use wavecrest_base::replace::{Sink, check_replaceable, replace_file, write_error};
use wavecrest_core::film::Film;

pub use super::transfer::{Develop, Tone, Transfer};

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
    }
}

impl Format {
    /// The format for the extension of `path`, in upper or lower case.
    ///
    /// # Errors
    /// If there is no extension or it is none of the four.
    pub fn from_path(path: &Path) -> Result<Self> {
        const FORMATS: &str = "use .ppm, .png, .exr or .pfm";
        let usage = |message: &str| Error::new(ErrorKind::Usage, message).in_file(path);
        if path == Path::new("-") {
            return Err(usage("an image cannot be written to standard output")
                .remedy("name a file that ends in .ppm, .png, .exr or .pfm"));
        }
        let Some(extension) = path.extension().map(OsStr::to_string_lossy) else {
            return Err(usage("the name of an image must end in its format").remedy(FORMATS));
        };
        let lower = extension.to_lowercase();
        Self::ALL.into_iter().find(|format| format.name() == lower).ok_or_else(|| {
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
    replace_file(path, |sink| {
        encode(sink, film, format, transfer, extras).map_err(|error| encode_error(path, error))
    })
}

/// Upper bound on the bytes that [`write_with`] takes beside the film and its channels, which have `values` values in each
/// pixel.
pub fn bytes_to_write(format: Format, pixels: u64, values: u64) -> u64 {
    let [rgb, rgba] = [size_of::<[u8; 3]>(), size_of::<[u8; 4]>()].map(|bytes| bytes as u64);
    let each = match format {
        // Row by row.
        Format::Ppm | Format::Pfm => 0,
        // The bands and the stream that joins them.
        Format::Png if values == 0 => 2 * rgb,
        // The levels, with alpha if it is among the channels, and their stream.
        Format::Png => 2 * rgba,
        // The file.
        Format::Exr => size_of::<[f32; 3]>() as u64 + values * size_of::<f32>() as u64,
    };
    pixels.saturating_mul(each)
}

/// `film` as the bytes of a PNG.
///
/// # Errors
/// If the encoder has no memory for it.
pub fn png(film: &Film, transfer: Transfer) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_png(&mut bytes, film, transfer, &[]).map_err(|e| encode_error("a PNG".as_ref(), e))?;
    Ok(bytes)
}

fn encode_png(
    sink: impl Write,
    film: &Film,
    transfer: Transfer,
    entries: &[Entry],
) -> std::result::Result<(), ImageError> {
    let compressed = idat::compressed(film, transfer)?;
    let mut writer = png_writer(sink, film, png::ColorType::Rgb, entries).map_err(png_error)?;
    if let Some(bytes) = compressed {
        writer.write_chunk(png::chunk::IDAT, &bytes).map_err(png_error)?;
    } else {
        let bytes: Vec<u8> = film.rows().flat_map(|row| row_to_bytes(row, transfer)).collect();
        writer.write_image_data(&bytes).map_err(png_error)?;
    }
    writer.finish().map_err(png_error)
}

/// A writer of the film's size that does not compress.
fn png_writer<W: Write>(
    sink: W,
    film: &Film,
    color: png::ColorType,
    entries: &[Entry],
) -> std::result::Result<png::Writer<W>, png::EncodingError> {
    let mut encoder = png::Encoder::new(sink, film.width(), film.height());
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    let is_plain = color == png::ColorType::Rgb;
    encoder.set_compression(match is_plain {
        true => png::Compression::NoCompression,
        false => png::Compression::Fast,
    });
    entries.iter().try_for_each(|entry| add_text(&mut encoder, entry))?;
    encoder.write_header()
}

/// The coverage of each pixel, if there is a channel for it.
fn alpha<'a>(
    film: &Film,
    extras: &Extras<'a>,
) -> std::result::Result<Option<&'a [f32]>, ImageError> {
    let found = extras.channels.iter().find(|channel| channel.name == ALPHA);
    match found.map(|channel| &channel.values) {
        Some(Values::Floats(values)) if values.len() == film.pixels().len() => Ok(Some(values)),
        Some(_) => Err(ImageError::IoError(std::io::Error::other("the alpha has another size"))),
        None => Ok(None),
    }
}

/// As [`encode_png`], with alpha. A PNG stores unmultiplied colours.
fn encode_transparent(
    sink: impl Write,
    film: &Film,
    alpha: &[f32],
    transfer: Transfer,
    entries: &[Entry],
) -> std::result::Result<(), ImageError> {
    let mut writer = png_writer(sink, film, png::ColorType::Rgba, entries).map_err(png_error)?;
    let straight = |(color, &alpha): (&[f32; 3], &f32)| match alpha > 0.0 {
        true => color.map(|value| value / alpha),
        false => [0.0; 3],
    };
    let width = film.width() as usize;
    let mut bytes = Vec::with_capacity(4 * film.pixels().len());
    for (colors, alpha) in film.rows().zip(alpha.chunks(width)) {
        let colors: Vec<[f32; 3]> = colors.iter().zip(alpha).map(straight).collect();
        for (level, &share) in row_to_bytes(&colors, transfer).chunks_exact(3).zip(alpha) {
            bytes.extend_from_slice(level);
            bytes.push(linear_level(share));
        }
    }
    writer.write_image_data(&bytes).map_err(png_error)?;
    writer.finish().map_err(png_error)
}

/// Adds a text chunk; in Unicode, which fewer programs show, only if necessary.
pub(super) fn add_text(
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

fn encode(
    sink: &mut Sink<'_>,
    film: &Film,
    format: Format,
    transfer: Transfer,
    extras: &Extras<'_>,
) -> std::result::Result<(), ImageError> {
    let comments = if extras.comments { extras.entries } else { &[] };
    match format {
        Format::Ppm => Ok(netpbm::write_ppm(sink, film, transfer, comments)?),
        Format::Pfm => Ok(netpbm::write_pfm(sink, film)?),
        Format::Png => match alpha(film, extras)? {
            Some(alpha) => encode_transparent(sink, film, alpha, transfer, extras.entries),
            None => encode_png(sink, film, transfer, extras.entries),
        },
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

#[cfg(test)]
mod tests;
