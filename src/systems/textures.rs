//! Textures: decodes each image once and ties shapes to them. A scene without textures opens none.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::Mat3;
use hecs::World;
use image::ImageDecoder as _;

use super::geometry::ShapeOutput;
use crate::error::{Error, ErrorKind, Result};
use crate::kernels::texture::{Filter, Image, Texels};
use crate::plan::schedule::{Schedule, Step};
use crate::prepared::{Texture, UvMap};
use crate::scene::components::{JsonPath, TextureRef};

/// The largest image that is decoded, in texels on a side.
const MAX_SIDE: u32 = 1 << 16;
/// The largest image that is decoded, in bytes.
const MAX_BYTES: u64 = 4 << 30;

/// Decodes the images that `shapes` wear and notes in each shape which it is; those that a shape wears
/// with trilinear filter get a pyramid. Of those that are not `shown` none is opened, unless the schedule
/// has it so.
pub fn run(
    world: &World,
    schedule: Schedule,
    shown: &[bool],
    shapes: &mut [ShapeOutput],
) -> Result<Vec<Image>> {
    let mut images = Vec::new();
    if !schedule.runs(Step::Texels) {
        return Ok(images);
    }
    let all = schedule.is_needless(Step::Texels);
    let mut numbers: HashMap<PathBuf, u32> = HashMap::new();
    for (shape, _) in shapes.iter_mut().zip(shown).filter(|(_, shown)| **shown || all) {
        if shape.shape.emission.is_some() {
            continue;
        }
        let Ok(reference) = world.get::<&TextureRef>(shape.entity) else { continue };
        let number = match numbers.get(&reference.path) {
            Some(&number) => number,
            None => {
                images.push(decode(&reference.path).map_err(|e| at_shape(world, shape, e))?);
                let number = images.len() as u32 - 1;
                numbers.insert(reference.path.clone(), number);
                number
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

/// Bytes of a texture, and what more there is while it is decoded, told by the head of its file; none where
/// that cannot be read, which is said when it is decoded.
pub fn survey(texture: &TextureRef) -> [u64; 2] {
    let decoder = image::ImageReader::open(&texture.path)
        .and_then(image::ImageReader::with_guessed_format)
        .ok()
        .and_then(|reader| reader.into_decoder().ok());
    let Some(decoder) = decoder else { return [0; 2] };
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    let is_bytes = color.bytes_per_pixel() == color.channel_count();
    let texel = if is_bytes { size_of::<[u8; 4]>() } else { size_of::<[f32; 3]>() };
    let texels = u64::from(width).saturating_mul(u64::from(height));
    let finest = texels.saturating_mul(texel as u64);
    // Each level of a pyramid has a quarter of the texels of the one before.
    let coarser = if texture.filter == Filter::Trilinear { finest / 3 } else { 0 };
    [finest.saturating_add(coarser), finest.saturating_add(decoder.total_bytes())]
}

fn at_shape(world: &World, shape: &ShapeOutput, error: Error) -> Error {
    match world.get::<&JsonPath>(shape.entity) {
        Ok(path) => error.in_file(super::scene_file(world)).at(format!("{}.texture", path.0)),
        Err(_) => error,
    }
}

/// Decodes an image of any format that the `image` crate reads, without transfer curve.
pub fn decode(path: &Path) -> Result<Image> {
    let failed = |e: image::ImageError| {
        let remedy = match &e {
            image::ImageError::Limits(_) => format!(
                "images of up to {MAX_SIDE} texels on a side and {MAX_BYTES} bytes are allowed"
            ),
            image::ImageError::Unsupported(_) => {
                "use an image in one of the usual formats, such as PNG or JPEG".to_owned()
            }
            _ => "check that the file is whole and is an image".to_owned(),
        };
        Error::new(ErrorKind::Texture, format!("cannot read the texture {}: {e}", path.display()))
            .remedy(remedy)
            .because(e)
    };
    let open = |e: std::io::Error| failed(image::ImageError::IoError(e));
    let mut reader =
        image::ImageReader::open(path).map_err(open)?.with_guessed_format().map_err(open)?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let decoded = reader.decode().map_err(failed)?;
    let (width, height) = (decoded.width(), decoded.height());
    if width == 0 || height == 0 {
        let message = format!("the texture {} has no texels", path.display());
        return Err(Error::new(ErrorKind::Texture, message).value(format!("{width} x {height}")));
    }
    Ok(Image::new(width, height, texels(decoded)))
}

fn texels(decoded: image::DynamicImage) -> Texels {
    let bytes = decoded.color().bytes_per_pixel() / decoded.color().channel_count();
    if bytes == 1 {
        Texels::Bytes(decoded.into_rgba8().pixels().map(|p| p.0).collect())
    } else {
        let finite = |x: f32| if x.is_finite() { x } else { 0.0 };
        Texels::Floats(decoded.into_rgb32f().pixels().map(|p| p.0.map(finite)).collect())
    }
}
