//! Textures: decodes each image once and ties shapes to them. A scene without textures opens none.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use glam::{DVec3, Mat3, Vec3};
use hecs::World;
use image::{DynamicImage, ImageDecoder as _, ImageError, ImageFormat, ImageReader};

use super::geometry::ShapeOutput;
use crate::components::{Encoding, TextureRef, TextureSource};
use crate::query::json_path;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::texture::{Filter, Image, Texels};
use wavecrest_core::math::srgb::srgb_decode;
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{Texture, UvMap};

/// The largest image that is decoded, in texels on a side.
const MAX_SIDE: u32 = 1 << 16;
/// The largest image that is decoded, in bytes.
const MAX_BYTES: u64 = 4 << 30;

/// Decodes the images that `shapes` wear and notes in each shape which it is; those that a shape wears
/// with trilinear filter get a pyramid. Of those that are not `needed` none is opened, unless the schedule
/// requires it. `file` is the scene's, for messages.
pub fn run(
    world: &World,
    file: &Path,
    schedule: Schedule,
    needed: &[bool],
    shapes: &mut [ShapeOutput],
) -> Result<Vec<Image>> {
    let mut images = Vec::new();
    if !schedule.runs(Step::Texels) {
        return Ok(images);
    }
    let all = schedule.is_needless(Step::Texels);
    let mut numbers: HashMap<Key, u32> = HashMap::new();
    for (shape, _) in shapes.iter_mut().zip(needed).filter(|(_, needed)| **needed || all) {
        if shape.shape.emission.is_some() {
            continue;
        }
        let Ok(reference) = world.get::<&TextureRef>(shape.entity) else { continue };
        let number = match numbers.entry(Key::of(&reference)) {
            Entry::Occupied(entry) => *entry.get(),
            Entry::Vacant(entry) => {
                let place = format!("{}.texture", json_path(world, shape.entity));
                images.push(decode(&reference).map_err(|e| e.in_file(file).at(place))?);
                *entry.insert(images.len() as u32 - 1)
            }
        };
        if reference.filter == Filter::Trilinear {
            images[number as usize].build_pyramid();
        }
        shape.shape.texture = Some(Texture {
            image: number,
            filter: reference.filter,
            wrap: reference.wrap,
            map: shape.uv_map.unwrap_or(UvMap::Sphere(Mat3::IDENTITY)),
        });
    }
    Ok(images)
}

/// Bytes of a texture, and what more there is while it is decoded, by the head of its file; none where
/// that cannot be read, which is said when it is decoded.
pub fn survey(texture: &TextureRef) -> [u64; 2] {
    let head = match &texture.source {
        TextureSource::File(path) => {
            File::open(path).ok().and_then(|file| head(BufReader::new(file)))
        }
        TextureSource::Embedded { bytes, .. } => head(Cursor::new(bytes)),
    };
    let Some((width, height, is_bytes, decoded)) = head else { return [0; 2] };
    let texel = if is_bytes { size_of::<[u8; 4]>() } else { size_of::<[f32; 3]>() };
    let texels = u64::from(width).saturating_mul(u64::from(height));
    let finest = texels.saturating_mul(texel as u64);
    // Each level of a pyramid has a quarter of the texels of the one before.
    let coarser = if texture.filter == Filter::Trilinear { finest / 3 } else { 0 };
    [finest.saturating_add(coarser), finest.saturating_add(decoded)]
}

/// The size of an image, whether its numbers are bytes, and how many bytes it has when it is decoded.
fn head(file: impl BufRead + Seek) -> Option<(u32, u32, bool, u64)> {
    let decoder = ImageReader::new(file).with_guessed_format().ok()?.into_decoder().ok()?;
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    let is_bytes = color.bytes_per_pixel() == color.channel_count();
    Some((width, height, is_bytes, decoder.total_bytes()))
}

/// What distinguishes images.
#[derive(PartialEq, Eq, Hash)]
struct Key {
    /// A path, or a place in the scene file.
    name: PathBuf,
    is_embedded: bool,
    encoding: Encoding,
    tint: [u64; 3],
}

impl Key {
    fn of(texture: &TextureRef) -> Self {
        let (name, is_embedded) = match &texture.source {
            TextureSource::File(path) => (path.clone(), false),
            TextureSource::Embedded { place, .. } => (place.into(), true),
        };
        let tint = texture.tint.to_array().map(f64::to_bits);
        Self { name, is_embedded, encoding: texture.encoding, tint }
    }
}

/// Decodes the image of a texture, of any format that the `image` crate reads.
pub fn decode(texture: &TextureRef) -> Result<Image> {
    let name = match &texture.source {
        TextureSource::File(path) => path.display().to_string(),
        TextureSource::Embedded { place, .. } => place.clone(),
    };
    let decoded = read(&texture.source).map_err(|e| cannot_read(&name, e))?;
    let (width, height) = (decoded.width(), decoded.height());
    if width == 0 || height == 0 {
        let message = format!("the texture {name} has no texels");
        return Err(Error::new(ErrorKind::Texture, message).value(format!("{width} x {height}")));
    }
    Ok(Image::new(width, height, texels(decoded, texture.encoding, texture.tint)))
}

fn cannot_read(name: &str, error: ImageError) -> Error {
    let remedy = match &error {
        ImageError::Limits(_) => {
            format!("images of up to {MAX_SIDE} texels on a side and {MAX_BYTES} bytes are allowed")
        }
        ImageError::Unsupported(_) => {
            "use an image in one of the usual formats, such as PNG or JPEG".to_owned()
        }
        _ => "check that the file is whole and is an image".to_owned(),
    };
    Error::new(ErrorKind::Texture, format!("cannot read the texture {name}: {error}"))
        .remedy(remedy)
        .because(error)
}

fn read(source: &TextureSource) -> image::ImageResult<DynamicImage> {
    match source {
        TextureSource::File(path) => {
            let format = ImageFormat::from_path(path).ok();
            read_from(BufReader::new(open(path)?), format)
        }
        TextureSource::Embedded { bytes, .. } => read_from(Cursor::new(&bytes[..]), None),
    }
}

/// Opens a regular file: to open a pipe can wait for ever.
fn open(path: &Path) -> std::io::Result<File> {
    if path.metadata()?.is_file() {
        return File::open(path);
    }
    Err(std::io::Error::other("not a regular file"))
}

/// Decodes the format that the first bytes show, or else `format`.
fn read_from(
    bytes: impl BufRead + Seek,
    format: Option<ImageFormat>,
) -> image::ImageResult<DynamicImage> {
    let mut reader = ImageReader::new(bytes);
    if let Some(format) = format {
        reader.set_format(format);
    }
    let mut reader = reader.with_guessed_format()?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    // The decoders are meant not to panic, but a damaged file must not end the program.
    catch_unwind(AssertUnwindSafe(|| reader.decode()))
        .unwrap_or_else(|_| Err(ImageError::IoError(std::io::Error::other("the decoder gave up"))))
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
