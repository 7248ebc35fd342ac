//! Textures: the images of shapes, each decoded once, at its first look-up. A scene without visible
//! textures opens no image.

use std::collections::HashMap;
use std::io::{BufRead, Read as _, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec2, Vec3};
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, ImageResult};

use crate::components::{self, Channels, Encoding, LookUp, TextureRef, TextureSource};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::texture::{Filter, Image, Texels};
use wavecrest_core::math::srgb::srgb_decode;
use wavecrest_core::prepared::{Coordinates, LazyImage, Placing, Texture, UvMap};

/// Largest decoded image, in texels on a side.
const MAX_SIDE: u32 = 1 << 16;
/// Largest image in bytes, as decoded and as stored.
const MAX_BYTES: u64 = 4 << 30;
/// Decoded size in bytes up to which the length of an image's file does not matter.
const SMALL_BYTES: u64 = 64 << 20;
/// Largest ratio of the decoded size of a larger image to the length of its file. PNG and EXR reach
/// 1032, JPEG about as much.
const LARGEST_RATIO: u64 = 4096;
/// Decoded size in bytes up to which an image is always looked at for whether it has one colour only, and
/// largest ratio of that to the length of its file for which it certainly has more: PNG, JPEG and EXR pack one
/// colour by more than a hundred, Radiance by 64.
const LOOKED_AT: u64 = 1 << 20;
const MOST_COLORS_RATIO: u64 = 50;
/// Largest unpacked size of an image's header in bytes: larger colour profiles are ignored.
const MAX_METADATA: u64 = 8 << 20;

/// The images of shapes, each once.
#[derive(Default)]
pub(crate) struct Images {
    /// Each with the place in the scene file that names it first.
    all: Vec<(TextureRef, String)>,
    /// Their numbers.
    numbers: HashMap<MadeOf, u32>,
    /// Those that are decoded already, and whether their first channel is 1 in every texel.
    decoded: HashMap<MadeOf, (Image, bool)>,
}

/// What the texels of an image are made of; the tint in bits.
type MadeOf = (TextureSource, Encoding, [u64; 3], Channels);

fn made_of(TextureRef { look_up, encoding, tint, channels }: &TextureRef) -> MadeOf {
    (look_up.source.clone(), *encoding, tint.to_array().map(f64::to_bits), *channels)
}

impl Images {
    /// The texture of a `reference`, which is under a `key` of the shape at `place`, with texture
    /// coordinates from `map`.
    pub(crate) fn texture(
        &mut self,
        reference: &TextureRef,
        (place, key): (&str, &str),
        map: UvMap,
    ) -> Texture {
        let LookUp { filter, wrap, placing: placed, .. } = &reference.look_up;
        let number = *self.numbers.entry(made_of(reference)).or_insert_with(|| {
            self.all.push((reference.clone(), format!("{place}.{key}")));
            self.all.len() as u32 - 1
        });
        if *filter == Filter::Trilinear {
            self.all[number as usize].0.look_up.filter = *filter;
        }
        let (filter, wrap, placing) = (*filter, *wrap, placed.map(placing));
        Texture { image: number, filter, wrap, coordinates: Coordinates { map, placing } }
    }

    /// Whether the texture's first channel is 1 in every texel. It is decoded for that, and kept; if `color` is
    /// of the same file, both are decoded at once. It is under a `key` of the object at `place` of a `file`.
    pub(super) fn is_one(
        &mut self,
        texture: &TextureRef,
        color: Option<&TextureRef>,
        place: (&Path, &str, &str),
    ) -> Result<bool> {
        Ok(self.decoded(texture, color, place)?.1)
    }

    /// The colour of a texture, if it is the same in every texel. Images too large to look at, unless they
    /// are compressed as one colour is, may have others.
    pub(crate) fn only_color(
        &mut self,
        texture: &TextureRef,
        place: (&Path, &str, &str),
    ) -> Result<Option<DVec3>> {
        let may_be = |head: Head| {
            head.decoded <= LOOKED_AT || head.decoded / head.length.max(1) > MOST_COLORS_RATIO
        };
        // What is wrong with its header is told later.
        if !Head::of(&texture.look_up.source).is_ok_and(may_be) {
            return Ok(None);
        }
        let (image, _) = self.decoded(texture, None, place)?;
        let ranges = [0, 1, 2].map(|channel| range(image, channel));
        let is_even = image.invalid == 0 && ranges.iter().all(|[low, high]| low == high);
        Ok(is_even.then(|| Vec3::from(ranges.map(|[value, _]| value)).as_dvec3()))
    }

    /// The decoded image of a texture, and whether its first channel is 1 in every texel.
    fn decoded(
        &mut self,
        texture: &TextureRef,
        color: Option<&TextureRef>,
        (file, place, key): (&Path, &str, &str),
    ) -> Result<&(Image, bool)> {
        if !self.decoded.contains_key(&made_of(texture)) {
            let source = &texture.look_up.source;
            let read = Head::of(source).and_then(|_| decoded(source));
            let read = read.map_err(|e| e.in_file(file).at(format!("{place}.{key}")))?;
            let mut keep = |texture: &TextureRef, read: DynamicImage| {
                let image = of_texture(read, texture, false);
                let is_one = range(&image, 0) == [1.0; 2];
                self.decoded.insert(made_of(texture), (image, is_one));
            };
            if let Some(color) = color.filter(|color| color.look_up.source == *source) {
                keep(color, read.clone());
            }
            keep(texture, read);
        }
        Ok(&self.decoded[&made_of(texture)])
    }

    /// Reads the headers of all images: each is decoded at its first look-up, with a pyramid if any
    /// shape uses it with the trilinear filter. `file` is the scene's, for messages.
    pub(super) fn prepare(self, file: &Path) -> Result<Vec<LazyImage>> {
        let Self { all, mut decoded, .. } = self;
        let image = |(texture, place): (TextureRef, String)| {
            let head = Head::of(&texture.look_up.source).map_err(|e| e.in_file(file).at(&place))?;
            let known = decoded.remove(&made_of(&texture)).map(|(image, _)| image);
            Ok(lazy(texture, false, (head, known), (file.to_owned(), place)))
        };
        all.into_iter().map(image).collect()
    }
}

/// A change of coordinates in single precision.
pub(super) fn placing(components::Placing([u, v]): components::Placing) -> Placing {
    let vec2 = |x: f64, y: f64| Vec2::new(x as f32, y as f32);
    Placing { turned: [vec2(u[0], u[1]), vec2(v[0], v[1])], moved: vec2(u[2], v[2]) }
}

/// The image of a texture whose file has this `head`, unless it is `decoded` already; in a mask, brightness
/// replaces missing alpha.
pub(super) fn lazy(
    texture: TextureRef,
    is_mask: bool,
    (head, decoded): (Head, Option<Image>),
    (file, place): (PathBuf, String),
) -> LazyImage {
    let TextureRef { look_up: LookUp { source, filter, .. }, encoding, tint, channels } =
        texture.clone();
    let read = match channels {
        Channels::Color => format!("{encoding:?}{tint:?}{filter:?}"),
        Channels::Alpha => format!("{channels:?}{filter:?}"),
    };
    let name = source.name();
    let made_of = move || [content(&source), read.into()].concat();
    let decode = move || {
        let source = &texture.look_up.source;
        let read = || self::decoded(source).map(|read| of_texture(read, &texture, is_mask));
        let mut image = match decoded {
            Some(image) => image,
            None => read().map_err(|e| e.in_file(file).at(place))?,
        };
        if filter == Filter::Trilinear {
            image.build_pyramid();
        }
        Ok(image)
    };
    LazyImage::new(name, head.bytes(filter, channels), decode).made_of(made_of)
}

/// The file content of an image, for fingerprints: nothing if it cannot be read.
fn content(source: &TextureSource) -> Vec<u8> {
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
pub(super) struct Head {
    size: (u32, u32),
    /// Whether its values are bytes.
    is_bytes: bool,
    pub(super) has_alpha: bool,
    /// Decoded size in bytes, and the additional bytes of the decoder.
    decoded: u64,
    scratch: u64,
    /// Length of its file content in bytes, and how many of them are in memory.
    length: u64,
    embedded: u64,
}

impl Head {
    /// The header of an image, if the image can be decoded as far as its header tells and is not too large.
    pub(super) fn of(source: &TextureSource) -> Result<Self> {
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
                length,
                embedded,
            })
        })?;
        check_size(source, head.size)?;
        head.check_bytes(source)?;
        Ok(head)
    }

    /// Refuses an image that is too large, or larger than its file can hold.
    fn check_bytes(self, source: &TextureSource) -> Result<()> {
        let length = self.length;
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
    fn bytes(self, filter: Filter, channels: Channels) -> [u64; 2] {
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
fn decoded(source: &TextureSource) -> Result<DynamicImage> {
    decoding(source, |decoder| DynamicImage::from_decoder(decoder))
}

/// The channels of a decoded image that a texture looks up.
fn of_texture(decoded: DynamicImage, texture: &TextureRef, is_mask: bool) -> Image {
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
pub(super) fn range(image: &Image, channel: usize) -> [f32; 2] {
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

fn cannot_read(name: &str, error: ImageError) -> Error {
    let remedy = match &error {
        ImageError::Limits(_) => {
            format!("use at most {MAX_SIDE} texels on a side and {MAX_BYTES} bytes")
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
        .map_err(|e| cannot_read(&source.name(), e))
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
