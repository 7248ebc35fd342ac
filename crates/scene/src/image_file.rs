//! Image files: what their headers tell, within limits, and their texels. No image is decoded before its header is
//! checked.

use std::io::Read as _;

use glam::{DVec3, Vec3};
use image::{DynamicImage, ImageDecoder, ImageError};

use crate::surface::{Channels, Encoding, TextureRef};
use crate::texture_source::TextureSource;
use wavecrest_base::error::{Error, Result};
use wavecrest_base::memory::Activity;
use wavecrest_core::kernels::texture::{Image, Texels};
use wavecrest_core::math::srgb::srgb_decode;
use wavecrest_image::decoder;

/// Decoded size in bytes up to which an image is looked at before rays need it: some milliseconds.
const LOOKED_AT: u64 = 1 << 20;

/// The file content of an image, for fingerprints: nothing if it cannot be read.
pub(crate) fn content(source: &TextureSource) -> Vec<u8> {
    let mut bytes = Vec::new();
    let read = source.open().and_then(|mut content| content.read_to_end(&mut bytes));
    read.map_or(Vec::new(), |_| bytes)
}

/// Properties of an image from its header.
#[derive(Clone, Copy)]
pub(crate) struct Head {
    /// Whether its values are bytes.
    pub(crate) is_bytes: bool,
    pub(crate) has_alpha: bool,
    /// Decoded size in bytes.
    decoded: u64,
}

impl Head {
    /// The header of an image, if the image can be decoded as far as its header tells and is not too large.
    pub(crate) fn of(source: &TextureSource) -> Result<Self> {
        decoding(source, |decoder, _| {
            let color = decoder.color_type();
            Ok(Self {
                is_bytes: color.bytes_per_pixel() == color.channel_count(),
                has_alpha: color.has_alpha(),
                decoded: decoder.total_bytes(),
            })
        })
    }

    /// Whether decoding it takes next to no time.
    pub(crate) fn is_small(&self) -> bool {
        self.decoded <= LOOKED_AT
    }
}

/// Says that an image is read, while it is decoded and what is looked up is made of it.
pub(crate) fn reading(source: &TextureSource) -> Activity {
    Activity::new(format!("reading {}", source.name()))
}

/// Decodes an image, in any format of the `image` crate.
pub(crate) fn decoded(source: &TextureSource) -> Result<DynamicImage> {
    decoding(source, |decoder, fail| DynamicImage::from_decoder(decoder).map_err(fail))
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

/// Runs `work` with the decoder of an image: see [`decoder::decode`].
fn decoding<R>(
    source: &TextureSource,
    work: impl FnOnce(Box<dyn ImageDecoder + '_>, &dyn Fn(ImageError) -> Error) -> Result<R>,
) -> Result<R> {
    let what = format!("the texture {}", source.name());
    decoder::decode(&what, source.file(), || Ok((source.open()?, source.length())), work)
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
