//! Textures: images, samplers and texture coordinates.

use std::cell::RefCell;
use std::collections::HashMap;

use glam::{DVec3, Vec2};

use crate::components::{
    Channels, Encoding, Filter, LookUp, Placing, TextureRef, TextureSource, Wrap,
};
use crate::format::{Notes, Range};
use crate::image_file::Head;
use wavecrest_base::error::{Error, Result};

use super::accessor::Storage;
use super::fields::Fields;
use super::uri::{self, UriTarget};

/// Reads an element of `images`; no image is decoded here.
fn image(fields: &Fields<'_>, storage: &Storage) -> Result<TextureSource> {
    let place = fields.path();
    if let Some(view) = fields.index("bufferView", "bufferViews")? {
        return Ok(TextureSource::Embedded { place, bytes: storage.bytes(view).into() });
    }
    let uri = fields.need("uri", "the name of an image, or give a bufferView")?;
    Ok(match uri::target(&uri)? {
        UriTarget::Bytes(bytes) => TextureSource::Embedded { place, bytes: bytes.into() },
        UriTarget::File(path) => TextureSource::File(path),
    })
}

/// An element of `samplers`.
#[derive(Clone, Copy, Debug, Default)]
struct Sampler {
    filter: Filter,
    wrap: Wrap,
}

/// The format's codes of wrap modes.
const WRAPS: [(u64, Wrap); 3] =
    [(10_497, Wrap::Repeat), (33_071, Wrap::Clamp), (33_648, Wrap::Mirror)];
/// The code of the filter that reads one texel, at the finest level.
const NEAREST: u64 = 9728;
/// The codes of the filters that read smaller copies of the image.
const MIPMAPPED: std::ops::RangeInclusive<u64> = 9984..=9987;

impl Sampler {
    /// Reads an element of `samplers`.
    fn read(fields: &Fields<'_>) -> Result<Self> {
        let filter = match (fields.count("magFilter")?, fields.count("minFilter")?) {
            (Some(NEAREST), _) => Filter::Nearest,
            (_, Some(filter)) if MIPMAPPED.contains(&filter) => Filter::Trilinear,
            _ => Filter::Bilinear,
        };
        let wrap = |key| -> Result<Wrap> {
            let must_be = "10497 (repeat), 33071 (clamp) or 33648 (mirrored)";
            Ok(fields.code(key, &WRAPS, must_be)?.unwrap_or(Wrap::Repeat))
        };
        let (s, t) = (wrap("wrapS")?, wrap("wrapT")?);
        if s != t {
            fields.warn("wrapT differs from wrapS", "wrapS is used for both");
        }
        Ok(Self { filter, wrap: s })
    }
}

/// An element of `textures`.
#[derive(Clone, Copy, Debug)]
struct TextureElement {
    image: Option<usize>,
    sampler: Option<usize>,
}

impl TextureElement {
    /// Reads an element of `textures`.
    fn read(fields: &Fields<'_>) -> Result<Self> {
        Ok(Self {
            // Unsupported extensions may have lists of images of their own, to which this number
            // may refer.
            image: source(fields).unwrap_or_else(|error| {
                fields.cursor.notes().warn(&error);
                None
            }),
            sampler: fields.index("sampler", "samplers")?,
        })
    }
}

/// The extensions with images of other formats; those of the second are not decoded.
pub(super) const WEBP: &str = "EXT_texture_webp";
pub(super) const BASIS: &str = "KHR_texture_basisu";

/// The image of a texture.
fn source(fields: &Fields<'_>) -> Result<Option<usize>> {
    let own = |fields: &Fields<'_>| fields.index("source", "images");
    let others = [WEBP, BASIS].map(|name| Ok(fields.extension(name, own)?.flatten()));
    let [webp, basis]: [Result<Option<usize>>; 2] = others;
    Ok(own(fields)?.or(webp?).or(basis?))
}

/// A material's reference to a texture.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextureInfo {
    texture: usize,
    /// The set of texture coordinates.
    pub(super) set: u32,
    /// A change of the coordinates before the look-up: the extension `KHR_texture_transform`.
    placing: Option<Placing>,
    /// The strength of a map of occlusion or of normals.
    pub(super) strength: f64,
}

/// Largest number of sets of texture coordinates.
const MOST_SETS: f64 = 1024.0;

impl TextureInfo {
    /// Reads a reference to a texture, whose strength has this key, if any.
    pub(super) fn read(fields: &Fields<'_>, scale: Option<&str>) -> Result<Self> {
        let strength =
            scale.map_or(Ok(1.0), |key| fields.number_or(key, Range::COORDINATE, 1.0))?;
        let texture = fields.need_index("index", "textures")?;
        let own_set = set(fields)?.unwrap_or(0);
        let changed = fields
            .extension("KHR_texture_transform", |found| Ok((set(found)?, placing(found)?)))?;
        let (other_set, placing) = changed.unwrap_or((None, None));
        Ok(Self { texture, set: other_set.unwrap_or(own_set), placing, strength })
    }
}

/// The textures of a file, with their images and samplers.
pub(super) struct Textures {
    images: Vec<TextureSource>,
    samplers: Vec<Sampler>,
    textures: Vec<TextureElement>,
    /// Whether images can be decoded, as far as that is known.
    can_decode: RefCell<HashMap<usize, bool>>,
}

impl Textures {
    /// Reads the lists of a file. Without `storage`, images are left out.
    pub(super) fn read(top: &Fields<'_>, storage: Option<&Storage>) -> Result<Self> {
        let all = |storage| top.list("images", "an image", |f| image(f, storage));
        let images = storage.map_or(Ok(Vec::new()), all);
        let samplers = top.list("samplers", "a sampler", Sampler::read);
        let textures = top.list("textures", "a texture", TextureElement::read)?;
        let can_decode = RefCell::default();
        Ok(Self { images: images?, samplers: samplers?, textures, can_decode })
    }

    /// The texture of a material, tinted; `None`, with a warning, if its image is missing.
    pub(super) fn reference(
        &self,
        info: &TextureInfo,
        encoding: Encoding,
        tint: DVec3,
        notes: &Notes<'_>,
    ) -> Option<TextureRef> {
        let left_out = "the texture is left out";
        let element = self.textures.get(info.texture);
        let Some(image) = element.and_then(|element| element.image) else {
            notes.note("textures", "the image of a texture cannot be read", left_out);
            return None;
        };
        let source = self.images.get(image)?;
        if let Some(path) = source.file().filter(|path| !path.is_file()) {
            let message = format!("the image {} is missing", path.display());
            notes.note(&format!("images[{image}]"), &message, left_out);
            return None;
        }
        if !self.can_decode(image, source, notes) {
            return None;
        }
        let sampler = element.and_then(|element| self.samplers.get(element.sampler?));
        let Sampler { filter, wrap } = sampler.copied().unwrap_or_default();
        let (source, placing) = (source.clone(), info.placing);
        let look_up = LookUp { source, filter, wrap, placing };
        Some(TextureRef { look_up, encoding, tint, channels: Channels::Color })
    }

    /// Whether the image's header can be read; a warning, once, if not.
    fn can_decode(&self, image: usize, source: &TextureSource, notes: &Notes<'_>) -> bool {
        *self.can_decode.borrow_mut().entry(image).or_insert_with(|| {
            let told = |error: Error| {
                notes.warn(&error.in_file(notes.file()).at(format!("images[{image}]")));
            };
            Head::of(source).map_err(told).is_ok()
        })
    }
}

fn set(fields: &Fields<'_>) -> Result<Option<u32>> {
    let range = Range::new(0.0, MOST_SETS);
    let found = fields.get("texCoord").map(|cursor| cursor.number(range)).transpose()?;
    // A set that is not an integer has no attribute.
    Ok(found.map(|set| set as u32))
}

/// A change of coordinates, if any.
fn placing(fields: &Fields<'_>) -> Result<Option<Placing>> {
    let pair = |key: &str| fields.numbers::<2>(key, Range::COORDINATE);
    let offset = pair("offset")?.unwrap_or([0.0; 2]);
    let scale = pair("scale")?.unwrap_or([1.0; 2]);
    let turned = fields.number_or("rotation", Range::COORDINATE, 0.0)?;
    if (offset, scale, turned) == ([0.0; 2], [1.0; 2], 0.0) {
        return Ok(None);
    }
    Ok(Some(upward(offset, turned, scale)))
}

/// A scaling, rotation in radians and translation in the format's coordinates, whose v runs down,
/// converted to ours, whose v runs up.
fn upward(offset: [f64; 2], turned: f64, scale: [f64; 2]) -> Placing {
    let (sin, cos) = libm::sincos(turned);
    let ([u, v], [x, y]) = (scale, offset);
    Placing([[cos * u, -sin * v, sin * v + x], [sin * u, cos * v, 1.0 - cos * v - y]])
}

/// Coordinates of the file as ours.
pub(super) fn coordinates([u, v]: [f64; 2]) -> Vec2 {
    Vec2::new(u as f32, (1.0 - v) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_scaled_then_turned_then_moved_in_the_space_of_the_file() {
        let near = |placing: Placing, uv: [f64; 2], expected: [f64; 2]| {
            let own = coordinates(uv).as_dvec2();
            let [u, v] = placing.0.map(|[a, b, c]| a * own.x + b * own.y + c);
            let found = [u, 1.0 - v];
            let is_near = found.iter().zip(expected).all(|(found, x)| (found - x).abs() < 1e-12);
            assert!(is_near, "{found:?}");
        };
        let quarter = std::f64::consts::FRAC_PI_2;
        near(upward([0.0; 2], 0.0, [1.0; 2]), [0.25, 0.75], [0.25, 0.75]);
        near(upward([0.0; 2], 0.0, [2.0, 4.0]), [0.25, 0.75], [0.5, 3.0]);
        near(upward([0.0; 2], quarter, [1.0; 2]), [1.0, 0.0], [0.0, -1.0]);
        near(upward([0.5, 0.25], quarter, [2.0, 4.0]), [1.0, 1.0], [4.5, -1.75]);
    }
}
