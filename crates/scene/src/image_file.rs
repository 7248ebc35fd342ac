//! Image files: what their headers tell, within limits, and their texels. No image is decoded before its header is
//! checked.

use std::io::{BufRead, Read as _, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use glam::{DVec3, Vec3};
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, ImageResult};

use crate::components::{Channels, Encoding, TextureRef, TextureSource};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::texture::{Filter, Image, Texels};
use wavecrest_core::math::srgb::srgb_decode;

/// Largest decoded image, in texels on a side.
const MAX_SIDE: u32 = 1 << 16;
/// Largest image in bytes, as decoded and as stored.
const MAX_BYTES: u64 = 4 << 30;
/// Decoded size in bytes up to which the length of an image's file does not matter.
const SMALL_BYTES: u64 = 64 << 20;
/// Largest ratio of the decoded size of a larger image to the length of its file. PNG and EXR reach
/// 1032, JPEG about as much.
const LARGEST_RATIO: u64 = 4096;
/// Decoded size in bytes up to which an image is looked at before rays need it: some milliseconds.
const LOOKED_AT: u64 = 1 << 20;
/// Largest unpacked size of an image's header in bytes: larger colour profiles are ignored.
const MAX_METADATA: u64 = 8 << 20;

/// The file content of an image, for fingerprints: nothing if it cannot be read.
pub(crate) fn content(source: &TextureSource) -> Vec<u8> {
    let mut bytes = Vec::new();
    let read = source.open().and_then(|mut content| content.read_to_end(&mut bytes));
    read.map_or(Vec::new(), |_| bytes)
}

/// Bytes of these channels of an image, and additional bytes while it is decoded, from the header of
/// its file; 0 if that cannot be read, which is reported when the scene is prepared.
pub(crate) fn survey(source: &TextureSource, filter: Filter, channels: Channels) -> [u64; 2] {
    Head::of(source).map_or([0; 2], |head| head.bytes(filter, channels))
}

/// Whether the image has an alpha channel; if its header cannot be read, which is reported when the
/// scene is prepared, it may have one.
pub(crate) fn has_alpha(source: &TextureSource) -> bool {
    Head::of(source).map_or(true, |head| head.has_alpha)
}

/// Checks that the image at `path` can be decoded, as far as its header tells.
///
/// # Errors
/// If it cannot be read, or has no known format.
pub(crate) fn check(path: &Path) -> Result<()> {
    let source = TextureSource::File(path.to_owned());
    decoding(&source, |decoder| Ok(decoder.dimensions())).and_then(|size| check_size(&source, size))
}

/// Properties of an image from its header.
#[derive(Clone, Copy)]
pub(crate) struct Head {
    size: (u32, u32),
    /// Whether its values are bytes.
    pub(crate) is_bytes: bool,
    pub(crate) has_alpha: bool,
    /// Decoded size in bytes, and the additional bytes of the decoder.
    decoded: u64,
    scratch: u64,
    /// Bytes of its file content in memory.
    embedded: u64,
}

impl Head {
    /// The header of an image, if the image can be decoded as far as its header tells and is not too large.
    pub(crate) fn of(source: &TextureSource) -> Result<Self> {
        let (length, embedded) = match source {
            TextureSource::File(path) => (path.metadata().map_or(0, |file| file.len()), 0),
            TextureSource::Embedded { bytes, .. } => (bytes.len() as u64, bytes.len() as u64),
        };
        let head = decoding(source, |decoder| {
            let color = decoder.color_type();
            let is_bytes = color.bytes_per_pixel() == color.channel_count();
            let decoded = decoder.total_bytes();
            Ok(Self {
                size: decoder.dimensions(),
                is_bytes,
                has_alpha: color.has_alpha(),
                decoded,
                // JPEG keeps two bytes for each number if it has several scans, EXR a whole copy.
                scratch: decoded * if is_bytes { 2 } else { 1 },
                embedded,
            })
        })?;
        check_size(source, head.size)?;
        head.check_bytes(source, length)?;
        Ok(head)
    }

    /// Whether decoding it takes next to no time.
    pub(crate) fn is_small(&self) -> bool {
        self.decoded <= LOOKED_AT
    }

    /// Refuses an image that is too large, or larger than a file of this `length` can be.
    fn check_bytes(self, source: &TextureSource, length: u64) -> Result<()> {
        let [held, _] = self.bytes(Filter::Nearest, Channels::Color);
        let (width, height) = self.size;
        let refused = |message: &str, found: String| {
            let message = format!("the texture {} {message}", source.name());
            Error::new(ErrorKind::Limit, message).value(found)
        };
        if held > MAX_BYTES {
            let found = format!("{width} x {height} texels, {:.1} GB", held as f64 / 1e9);
            let allowed = format!("at most {:.1} GB are allowed", MAX_BYTES as f64 / 1e9);
            return Err(refused("takes too much memory once decoded", found)
                .remedy(format!("use a smaller image: {allowed}")));
        }
        if self.decoded > SMALL_BYTES.max(length.saturating_mul(LARGEST_RATIO)) {
            let found = format!("{width} x {height} texels in {length} bytes");
            return Err(refused("has more texels than its file can hold", found)
                .remedy("check that the file is whole"));
        }
        Ok(())
    }

    /// Bytes of these channels, with a pyramid if the filter needs one; and the additional bytes while
    /// they are made: by the decoder before they are there, as decoded, or as one more copy.
    pub(crate) fn bytes(self, filter: Filter, channels: Channels) -> [u64; 2] {
        let Self { size: (width, height), decoded, scratch, embedded, .. } = self;
        let is_bytes = self.is_bytes || channels == Channels::Alpha;
        let texel = if is_bytes { size_of::<[u8; 4]>() } else { size_of::<[f32; 3]>() };
        let coarser = if filter == Filter::Trilinear { pyramid_bytes((width, height)) } else { 0 };
        let texels = u64::from(width).saturating_mul(u64::from(height));
        let finest = texels.saturating_mul(texel as u64);
        let all = [finest, coarser, embedded].into_iter().fold(0, u64::saturating_add);
        let before = decoded.saturating_add(scratch).saturating_sub(finest);
        [all, before.max(decoded).max(finest)]
    }
}

/// Bytes of the levels above an image of this size, each half as wide and high as the one below.
fn pyramid_bytes((width, height): (u32, u32)) -> u64 {
    let levels = (1..=width.max(height).max(1).ilog2()).map(|level| {
        let side = |length: u32| u64::from((length >> level).max(1));
        side(width) * side(height)
    });
    levels.sum::<u64>() * size_of::<[f32; 3]>() as u64
}

/// Decodes an image, in any format of the `image` crate.
pub(crate) fn decoded(source: &TextureSource) -> Result<DynamicImage> {
    decoding(source, |decoder| DynamicImage::from_decoder(decoder))
}

/// The channels of a decoded image that a texture looks up.
pub(crate) fn of_texture(decoded: DynamicImage, texture: &TextureRef, is_mask: bool) -> Image {
    let (width, height) = (decoded.width(), decoded.height());
    let values = decoded.as_flat_samples_f32().map_or(&[][..], |all| all.samples);
    let invalid = values.iter().filter(|value| !value.is_finite()).count() as u64;
    let texels = match texture.channels {
        Channels::Color => texels(decoded, texture.encoding, texture.tint),
        Channels::Alpha if is_mask && !decoded.color().has_alpha() => {
            Texels::Bytes(decoded.into_luma8().pixels().map(|pixel| [pixel.0[0]; 4]).collect())
        }
        Channels::Alpha => {
            Texels::Bytes(decoded.into_rgba8().pixels().map(|pixel| [pixel.0[3]; 4]).collect())
        }
    };
    let mut image = Image::new(width, height, texels);
    image.invalid = invalid;
    image
}

/// The lowest and the highest value in a channel of an image, as in look-ups.
pub(crate) fn range(image: &Image, channel: usize) -> [f32; 2] {
    let levels = |texels: &[[u8; 4]]| {
        let levels = texels.iter().map(|texel| texel[channel]);
        [levels.clone().min(), levels.max()].map(|level| level.unwrap_or(u8::MAX))
    };
    match &image.texels {
        Texels::Bytes(texels) => levels(texels).map(|level| f32::from(level) / 255.0),
        // Decoding keeps the order.
        Texels::Levels(texels, values) => {
            levels(texels).map(|level| values[usize::from(level)][channel])
        }
        Texels::Floats(texels) => {
            let values = || texels.iter().map(|texel| texel[channel]);
            [values().fold(f32::INFINITY, f32::min), values().fold(f32::NEG_INFINITY, f32::max)]
        }
    }
}

fn check_size(source: &TextureSource, (width, height): (u32, u32)) -> Result<()> {
    if width > 0 && height > 0 {
        return Ok(());
    }
    let message = format!("the texture {} has no texels", source.name());
    Err(Error::new(ErrorKind::Texture, message).value(format!("{width} x {height}")))
}

/// The first bytes of a KTX2 file, which glTF files may have.
const KTX2: &[u8] = b"\xABKTX 20\xBB";

fn cannot_read(source: &TextureSource, error: ImageError) -> Error {
    let name = source.name();
    let is_packed = || {
        let mut start = [0; KTX2.len()];
        let read = source.open().and_then(|mut file| file.read_exact(&mut start));
        read.is_ok() && start == KTX2
    };
    let remedy = match &error {
        ImageError::Limits(_) => {
            format!("use at most {MAX_SIDE} texels on a side and {MAX_BYTES} bytes")
        }
        ImageError::Unsupported(_) if is_packed() => {
            "unpack it: gltf-transform ktxdecompress IN OUT".to_owned()
        }
        ImageError::Unsupported(_) => "use PNG or JPEG".to_owned(),
        _ => "check that the file is whole and is an image".to_owned(),
    };
    Error::new(ErrorKind::Texture, format!("cannot read the texture {name}: {error}"))
        .remedy(remedy)
        .because(error)
}

/// Runs `work` with the decoder of an image, which has read only its header.
fn decoding<R>(
    source: &TextureSource,
    work: impl FnOnce(Box<dyn ImageDecoder + '_>) -> ImageResult<R>,
) -> Result<R> {
    let format = source.file().and_then(|path| ImageFormat::from_path(path).ok());
    // The decoders should not panic, but a damaged file must not end the program.
    catch_unwind(AssertUnwindSafe(|| work(decoder_of(source.open()?, format)?)))
        .unwrap_or_else(|_| Err(ImageError::IoError(std::io::Error::other("the decoder failed"))))
        .map_err(|e| cannot_read(source, e))
}

/// The decoder of the format of the first bytes, or else of `format`.
fn decoder_of<'a>(
    bytes: impl BufRead + Seek + 'a,
    format: Option<ImageFormat>,
) -> ImageResult<Box<dyn ImageDecoder + 'a>> {
    let mut reader = ImageReader::new(bytes);
    if let Some(format) = format {
        reader.set_format(format);
    }
    let mut reader = reader.with_guessed_format()?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    // These limits apply only to the headers of PNG files; decoding uses those below.
    limits.max_alloc = Some(MAX_METADATA);
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder()?;
    limits.max_alloc = Some(MAX_BYTES);
    limits.reserve(decoder.total_bytes())?;
    decoder.set_limits(limits)?;
    Ok(Box::new(decoder))
}

fn texels(decoded: DynamicImage, encoding: Encoding, tint: DVec3) -> Texels {
    let tint = tint.as_vec3();
    let is_plain = encoding == Encoding::Linear && tint == Vec3::ONE;
    let linear = |value: f32| match encoding {
        Encoding::Linear => value,
        Encoding::Srgb => srgb_decode(value),
    };
    let bytes = decoded.color().bytes_per_pixel() / decoded.color().channel_count();
    if bytes == 1 {
        let texels = decoded.into_rgba8().pixels().map(|p| p.0).collect();
        if is_plain {
            return Texels::Bytes(texels);
        }
        let value = |level: usize| tint * linear(level as f32 / 255.0);
        return Texels::Levels(texels, Box::new(std::array::from_fn(value)));
    }
    let finite = |x: f32| if x.is_finite() { x } else { 0.0 };
    let texel = |pixel: [f32; 3]| match is_plain {
        true => pixel.map(finite),
        false => (tint * Vec3::from(pixel.map(|x| linear(finite(x))))).to_array(),
    };
    Texels::Floats(decoded.into_rgb32f().pixels().map(|p| texel(p.0)).collect())
}
