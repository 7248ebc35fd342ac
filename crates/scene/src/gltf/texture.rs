//! Textures: which image, how it is looked up, and where on it a corner lies.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2};

use crate::components::{Encoding, Filter, TextureRef, TextureSource, Wrap};
use crate::reader::Range;
use wavecrest_base::error::Result;

use super::accessor::Storage;
use super::fields::Fields;
use super::uri::{self, Target};

/// An element of `images`.
#[derive(Clone, Debug)]
struct Image(TextureSource);

impl Image {
    /// Reads an element of `images`; no image is decoded here.
    fn read(fields: &Fields<'_>, storage: Storage<'_>) -> Result<Self> {
        let embedded = |bytes: &[u8]| TextureSource::Embedded {
            place: fields.path(),
            bytes: Arc::from(bytes),
        };
        let view = fields.index("bufferView", "bufferViews", storage.views.len())?;
        if let Some(view) = view {
            return Ok(Self(embedded(storage.views[view].bytes(storage.buffers))));
        }
        let uri = fields.need("uri", "the name of an image, or give a bufferView")?;
        Ok(Self(match uri::target(&uri)? {
            Target::Bytes(bytes) => embedded(&bytes),
            Target::File(path) => TextureSource::File(path),
        }))
    }
}

/// An element of `samplers`.
#[derive(Clone, Copy, Debug, Default)]
struct Sampler {
    filter: Filter,
    wrap: Wrap,
}

/// The numbers of wrapping: `None` for one that there is nothing like here.
const WRAPS: [(u64, Option<Wrap>); 3] =
    [(10_497, Some(Wrap::Repeat)), (33_071, Some(Wrap::Clamp)), (33_648, None)];
/// The filter that looks at one texel, and at no other level.
const NEAREST: u64 = 9728;
/// Those that look at smaller copies of the image.
const MIPMAPPED: std::ops::RangeInclusive<u64> = 9984..=9987;

impl Sampler {
    /// Reads an element of `samplers`.
    fn read(fields: &Fields<'_>) -> Result<Self> {
        let magnified = fields.count("magFilter")?;
        let minified = fields.count("minFilter")?;
        let filter = match (magnified, minified) {
            (Some(NEAREST), _) => Filter::Nearest,
            (_, Some(filter)) if MIPMAPPED.contains(&filter) => Filter::Trilinear,
            _ => Filter::Bilinear,
        };
        let wraps = [wrap(fields, "wrapS")?, wrap(fields, "wrapT")?];
        if wraps[0] != wraps[1] {
            let message = "a texture is wrapped alike in both directions";
            fields.once(message, "wrapS holds for both");
        }
        Ok(Self { filter, wrap: wraps[0] })
    }
}

fn wrap(fields: &Fields<'_>, key: &str) -> Result<Wrap> {
    let Some(cursor) = fields.get(key) else { return Ok(Wrap::Repeat) };
    let number = cursor.value().as_u64();
    match WRAPS.iter().find(|(known, _)| number == Some(*known)) {
        Some((_, Some(wrap))) => Ok(*wrap),
        Some((_, None)) => {
            cursor.notes().once(&cursor.path(), "a texture is not mirrored", "it repeats");
            Ok(Wrap::Repeat)
        }
        None => Err(cursor.error("must be 10497 (repeat), 33071 (clamp) or 33648 (mirrored)")),
    }
}

/// An element of `textures`.
#[derive(Clone, Copy, Debug)]
struct Texture {
    image: Option<usize>,
    sampler: Option<usize>,
}

impl Texture {
    /// Reads an element of `textures`, of a file with so many images and samplers.
    fn read(fields: &Fields<'_>, images: usize, samplers: usize) -> Result<Self> {
        Ok(Self {
            // Extensions that are not read may have images of their own, of which this is the number.
            image: fields.index("source", "images", images).unwrap_or_else(|error| {
                fields.cursor().notes().warn(&error);
                None
            }),
            sampler: fields.index("sampler", "samplers", samplers)?,
        })
    }
}

/// What a material says of its texture.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextureInfo {
    texture: usize,
    /// Which of the sets of coordinates it goes by.
    pub(super) set: u32,
    pub(super) placing: Placing,
}

/// How coordinates are changed before the look-up: the extension `KHR_texture_transform`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placing {
    offset: DVec2,
    /// In radians.
    rotation: f64,
    scale: DVec2,
}

/// The most sets of texture coordinates that are distinguished.
const MOST_SETS: f64 = 1024.0;

impl TextureInfo {
    /// Reads a reference to one of so many textures.
    pub(super) fn read(fields: &Fields<'_>, textures: usize) -> Result<Self> {
        let texture = fields.need_index("index", "textures", textures)?;
        let own_set = set(fields)?.unwrap_or(0);
        let changed = fields
            .extension("KHR_texture_transform", |found| Ok((set(found)?, Placing::read(found)?)))?;
        let (other_set, placing) = changed.unwrap_or((None, Placing::NONE));
        Ok(Self { texture, set: other_set.unwrap_or(own_set), placing })
    }
}

/// The textures of a file, and what they are made of.
pub(super) struct Textures {
    images: Vec<Image>,
    samplers: Vec<Sampler>,
    textures: Vec<Texture>,
}

impl Textures {
    /// Reads the lists of a file.
    pub(super) fn read(top: &Fields<'_>, storage: Storage<'_>) -> Result<Self> {
        let images = top.list("images", "an image", |f| Image::read(f, storage))?;
        let samplers = top.list("samplers", "a sampler", Sampler::read)?;
        let texture = |f: &Fields<'_>| Texture::read(f, images.len(), samplers.len());
        let textures = top.list("textures", "a texture", texture)?;
        Ok(Self { images, samplers, textures })
    }

    /// How many textures there are.
    pub(super) fn len(&self) -> usize {
        self.textures.len()
    }

    /// The texture of a material, tinted; `None` where the file does not say which image it is of.
    pub(super) fn reference(&self, info: &TextureInfo, tint: DVec3) -> Option<TextureRef> {
        let Image(source) = self.images.get(self.image(info)?)?;
        let sampler = self.textures.get(info.texture)?.sampler;
        let sampler = sampler.and_then(|i| self.samplers.get(i)).copied().unwrap_or_default();
        Some(TextureRef {
            source: source.clone(),
            encoding: Encoding::Srgb,
            tint,
            filter: sampler.filter,
            wrap: sampler.wrap,
        })
    }

    /// Which image the texture of a material is of.
    pub(super) fn image(&self, info: &TextureInfo) -> Option<usize> {
        self.textures.get(info.texture)?.image
    }

    /// The file that an image is in, where that is not there.
    pub(super) fn missing(&self, image: usize) -> Option<&PathBuf> {
        match &self.images.get(image)?.0 {
            TextureSource::File(path) if !path.is_file() => Some(path),
            _ => None,
        }
    }
}

fn set(fields: &Fields<'_>) -> Result<Option<u32>> {
    let range = Range::new(0.0, MOST_SETS);
    let found = fields.get("texCoord").map(|cursor| cursor.number(range)).transpose()?;
    // A set that is no whole number has no attribute.
    Ok(found.map(|set| set as u32))
}

impl Placing {
    /// No change.
    pub(super) const NONE: Self = Self { offset: DVec2::ZERO, rotation: 0.0, scale: DVec2::ONE };

    fn read(fields: &Fields<'_>) -> Result<Self> {
        let pair = |key: &str| fields.numbers::<2>(key, Range::COORDINATE);
        Ok(Self {
            offset: pair("offset")?.map_or(DVec2::ZERO, DVec2::from_array),
            rotation: fields.number_or("rotation", Range::COORDINATE, 0.0)?,
            scale: pair("scale")?.map_or(DVec2::ONE, DVec2::from_array),
        })
    }

    /// Coordinates of the file as ours: scaled, turned and moved; then v upward. The format's runs down.
    pub(super) fn apply(&self, [u, v]: [f64; 2]) -> Vec2 {
        let (sin, cos) = libm::sincos(self.rotation);
        let DVec2 { x, y } = DVec2::new(u, v) * self.scale;
        let turned = DVec2::new(cos * x + sin * y, cos * y - sin * x) + self.offset;
        Vec2::new(turned.x as f32, (1.0 - turned.y) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_scaled_then_turned_then_moved_then_turned_upward() {
        let near = |placing: Placing, uv: [f64; 2], expected: [f32; 2]| {
            let found = placing.apply(uv);
            assert!(found.distance(Vec2::from(expected)) < 1e-6, "{found}");
        };
        near(Placing::NONE, [0.25, 0.75], [0.25, 0.25]);
        let scale = DVec2::new(2.0, 4.0);
        near(Placing { scale, ..Placing::NONE }, [0.25, 0.75], [0.5, -2.0]);
        let turned = Placing { rotation: std::f64::consts::FRAC_PI_2, ..Placing::NONE };
        near(turned, [1.0, 0.0], [0.0, 2.0]);
        let offset = DVec2::new(0.5, 0.25);
        near(Placing { scale, offset, ..turned }, [1.0, 1.0], [4.5, 2.75]);
    }
}
