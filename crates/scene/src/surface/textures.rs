//! Textures of a surface, and their look-up keys.

use std::path::PathBuf;

use glam::DVec3;
use serde_json::json;

use super::source::TextureSource;
use crate::folder::translated;
use crate::format::{Cursor, Declaration, Declared, Key, Kind, Object, Range, Writer, keys, words};
use wavecrest_base::error::{ErrorKind, Result};

pub use wavecrest_core::kernels::texture::{Filter, Wrap};

words!(Filter, Wrap, Encoding, Channels);

/// What a path of an image is.
const IMAGE: &str = "the path of an image";

/// A texture that replaces the diffuse colour.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureRef {
    /// The image.
    pub look_up: LookUp,
    /// The encoding of its values.
    pub encoding: Encoding,
    /// A linear factor on every texel.
    pub tint: DVec3,
    /// The channels that are looked up.
    pub channels: Channels,
}

wavecrest_base::choices! {
    /// The channels of an image that are looked up.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Channels {
        /// Red, green and blue.
        #[default]
        Color = "color",
        /// Alpha in place of each of them, 1 without alpha.
        Alpha = "alpha",
    }
}

/// An image, and how it is looked up.
#[derive(Clone, Debug, PartialEq)]
pub struct LookUp {
    /// The image.
    pub source: TextureSource,
    /// Filtering between texels.
    pub filter: Filter,
    /// Wrap mode of coordinates outside 0 to 1.
    pub wrap: Wrap,
    /// A change of the coordinates before the look-up, if any.
    pub placing: Option<Placing>,
}

/// Two rows of a matrix that acts on texture coordinates [u, v, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing(pub [[f64; 3]; 2]);

/// The keys of [`Maps`].
pub(crate) const EMISSION_MAP: &str = "emissionmap";
pub(crate) const METAL_MAP: &str = "metalmap";
pub(crate) const OCCLUSION_MAP: &str = "occlusionmap";
pub(crate) const NORMAL_MAP: &str = "normalmap";
pub(crate) const OPACITY_MAP: &str = "opacitymap";

/// Textures of properties other than the diffuse colour. None is tinted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Maps {
    /// Multiplies the material's emission.
    pub emission: Option<TextureRef>,
    /// Metalness and roughness, which determine the rest of the material together with the colour.
    pub metal: Option<MetalMap>,
    /// The share of ambient light that arrives, in the red channel.
    pub occlusion: Option<StrengthMap>,
    /// Normals: red along u, green along v, blue along the surface normal; a value x stands for 2 x
    /// - 1.
    pub normal: Option<StrengthMap>,
    /// Multiplies the opacity, in the red channel.
    pub opacity: Option<TextureRef>,
}

impl Maps {
    pub(crate) const NONE: Self =
        Self { emission: None, metal: None, occlusion: None, normal: None, opacity: None };

    /// The maps that are set, with their keys in a scene file.
    pub fn all(&self) -> impl Iterator<Item = (&'static str, &TextureRef)> {
        let all = [
            (EMISSION_MAP, self.emission.as_ref()),
            (METAL_MAP, self.metal.as_ref().map(|map| &map.texture)),
            (OCCLUSION_MAP, self.occlusion.as_ref().map(|map| &map.texture)),
            (NORMAL_MAP, self.normal.as_ref().map(|map| &map.texture)),
            (OPACITY_MAP, self.opacity.as_ref()),
        ];
        all.into_iter().filter_map(|(key, texture)| Some((key, texture?)))
    }

    /// As [`Maps::all`], mutable.
    pub fn all_mut(&mut self) -> impl Iterator<Item = &mut TextureRef> {
        let metal = self.metal.as_mut().map(|map| &mut map.texture);
        let occlusion = self.occlusion.as_mut().map(|map| &mut map.texture);
        let normal = self.normal.as_mut().map(|map| &mut map.texture);
        let plain = [self.emission.as_mut(), self.opacity.as_mut()];
        plain.into_iter().chain([metal, occlusion, normal]).flatten()
    }
}

/// A texture of metalness, in blue, and of roughness, in green.
#[derive(Clone, Debug, PartialEq)]
pub struct MetalMap {
    /// The texture.
    pub texture: TextureRef,
    /// Factor on the metalness, 0 to 1.
    pub metallic: f64,
    /// Factor on the roughness, 0 to 1.
    pub roughness: f64,
}

impl MetalMap {
    /// Whether all texels give the same material.
    pub(crate) fn is_constant(&self) -> bool {
        [self.metallic, self.roughness].iter().all(|&factor| factor as f32 == 0.0)
    }
}

/// A texture with a strength.
#[derive(Clone, Debug, PartialEq)]
pub struct StrengthMap {
    /// The texture.
    pub texture: TextureRef,
    /// 0 for no effect, 1 for the full effect.
    pub strength: f64,
}

impl StrengthMap {
    /// Whether the texture changes anything.
    pub(crate) fn has_effect(&self) -> bool {
        self.strength as f32 != 0.0
    }
}

/// Holes in a surface, where the alpha of an image is low.
#[derive(Clone, Debug, PartialEq)]
pub struct CutOut {
    /// The image.
    pub look_up: LookUp,
    /// Whether brightness replaces a missing alpha channel; otherwise an image without alpha has no
    /// holes.
    pub is_mask: bool,
    /// The lowest alpha that is opaque, above 0.
    pub threshold: f64,
}

wavecrest_base::choices! {
    /// The encoding of an image's values.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Encoding {
        /// Linear.
        #[default]
        Linear = "linear",
        /// sRGB-encoded, as in most photographs and painted textures.
        Srgb = "srgb",
    }
}

/// The look-up keys, which a shape's texture and its cut-out share.
pub(crate) const LOOK_UP: Declaration = Declaration::of_keys(keys! {
    /// Filtering between texels.
    "filter": word::<Filter>(), Says("bilinear");
    /// How the image continues outside of coordinates 0 to 1; `mirror` mirrors every second copy.
    "wrap": word::<Wrap>(), Says("repeat");
    /// Encoding of the image's values; `srgb` is decoded.
    "encoding": word::<Encoding>(), Says("linear");
    /// Transform of the texture coordinates before the look-up: two rows that act on [u, v, 1].
    "uvtransform": Exactly(2, &Exactly(3, &Number(Range::COORDINATE)));
});

impl Declared for TextureRef {
    const KEYS: &'static [Key] = keys! {
        /// An image that replaces the diffuse colour: a path from the scene's folder.
        "texture": Text;
        /// Colour that multiplies each decoded texel.
        "tint": Color, Are([1.0; 3]);
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let tint = object.read("tint");
        let Some(cursor) = object.get("texture") else {
            warn_without_texture(object);
            return Ok(None);
        };
        let (encoding, look_up) = LookUp::read(object, existing_file(&cursor, IMAGE)?)?;
        Ok(Some(Self { look_up, encoding, tint, channels: Channels::Color }))
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.image("texture", &self.look_up.source);
        to.put("tint", self.tint);
        to.put("encoding", self.encoding);
        self.look_up.write(to);
    }
}

impl LookUp {
    /// The image at the path of a key, bilinear.
    pub(crate) fn plain(cursor: &Cursor<'_>) -> Result<Self> {
        let source = TextureSource::File(existing_file(cursor, IMAGE)?);
        let (filter, wrap) = (Filter::Bilinear, Wrap::Repeat);
        Ok(Self { source, filter, wrap, placing: None })
    }

    /// The image at `path`, with the keys of the object. The encoding is checked for cut-outs too.
    fn read(object: &Object<'_>, path: PathBuf) -> Result<(Encoding, Self)> {
        let (encoding, source) = (object.read("encoding"), TextureSource::File(path));
        let (filter, wrap) = (object.read("filter"), object.read("wrap"));
        Ok((encoding, Self { source, filter, wrap, placing: placing(object)? }))
    }

    /// Writes all but the image.
    fn write(&self, to: &mut Writer<'_>) {
        to.put("filter", self.filter);
        to.put("wrap", self.wrap);
        if let Some(Placing(rows)) = self.placing {
            to.set("uvtransform", json!(rows));
        }
    }
}

fn warn_without_texture(object: &Object<'_>) {
    // Alpha is looked up like a texture.
    let of_both: &[&str] =
        if object.get("alpha").is_some() { &[] } else { &["filter", "wrap", "uvtransform"] };
    for cursor in ["encoding", "tint"].iter().chain(of_both).filter_map(|key| object.get(key)) {
        cursor.warn("has no effect without a texture", "add \"texture\", or remove it");
    }
}

fn placing(object: &Object<'_>) -> Result<Option<Placing>> {
    let what = "two rows of three numbers, [[a, b, c], [d, e, f]]";
    let Some(cursor) = object.get("uvtransform") else { return Ok(None) };
    let rows = cursor.each(what, |row| row.numbers::<3>(what, Range::COORDINATE))?;
    let rows = rows.try_into().map_err(|_| cursor.error(format!("must be {what}")))?;
    Ok(Some(Placing(rows)))
}

/// The default threshold with an `alpha`.
pub(crate) const THRESHOLD: f64 = 0.5;

impl Declared for CutOut {
    const KEYS: &'static [Key] = keys! {
        /// Parts of the shape where the alpha of the texture, or of the image `alpha`, is lower are
        /// cut out; 0.5 by default with an `alpha`.
        "alphacutoff": Number(Range::NOT_NEGATIVE);
        /// An image whose alpha, or brightness if it has none, cuts out the shape; or "blend", for
        /// the alpha of the texture as opacity.
        "alpha": Text;
    };

    /// A threshold of 0 cuts nothing out.
    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let threshold = object.read_or("alphacutoff", Some(THRESHOLD));
        if blends(object) {
            return Ok(None);
        }
        let image = |key| object.get(key).map(|cursor| existing_file(&cursor, IMAGE)).transpose();
        let mask = image("alpha")?;
        let is_mask = mask.is_some();
        let path = match (mask, object.get("alphacutoff")) {
            (Some(mask), _) => Some(mask),
            (None, None) => None,
            (None, Some(cursor)) => {
                let texture = image("texture")?;
                if texture.is_none() {
                    let remedy = "add \"texture\" or \"alpha\", or remove it";
                    cursor.warn("has no effect without an image with alpha", remedy);
                }
                texture
            }
        };
        let Some(path) = path else { return Ok(None) };
        let (_, look_up) = LookUp::read(object, path)?;
        Ok((threshold > 0.0).then_some(Self { look_up, is_mask, threshold }))
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.put("alphacutoff", self.threshold);
        let texture = to.get("texture").cloned();
        to.image("alpha", &self.look_up.source);
        if !self.is_mask && texture.as_ref() == to.get("alpha") {
            to.remove("alpha");
        }
        if texture.is_none() {
            self.look_up.write(to);
        }
    }
}

/// Whether the alpha of the texture is the shape's opacity.
fn blends(object: &Object<'_>) -> bool {
    object.get("alpha").is_some_and(|alpha| alpha.value().as_str() == Some("blend"))
}

/// The alpha of the object's texture.
fn alpha_of_texture(object: &Object<'_>) -> Result<Option<TextureRef>> {
    let Some(cursor) = object.get("texture") else {
        if let Some(alpha) = object.get("alpha") {
            alpha.warn("has no effect without a texture", "add \"texture\", or remove it");
        }
        return Ok(None);
    };
    let (_, look_up) = LookUp::read(object, existing_file(&cursor, IMAGE)?)?;
    let (encoding, channels) = (Encoding::Linear, Channels::Alpha);
    Ok(Some(TextureRef { look_up, encoding, tint: DVec3::ONE, channels }))
}

const FILE: &[Key] = keys! {
    /// The image: a path from the scene's folder.
    "file": Text, Required;
};

/// A kind of map with more keys.
const fn map(name: &'static str, about: &'static str, components: &'static [Declaration]) -> Kind {
    Kind { components, more: &[&[LOOK_UP]], ..Kind::new(name, about, FILE) }
}

const OF_COLORS: Kind = map("a map", "An image of colours.", &[]);

const WITH_STRENGTH: Kind = map(
    "a map",
    "An image of numbers, and its strength.",
    &[Declaration::of_keys(keys! {
        /// Strength s: the share of ambient light is 1 + s (red - 1), and red and green of a normal
        /// are multiplied by s.
        "strength": Number(Range::COORDINATE), Is(1.0);
    })],
);

const OF_OPACITY: Kind = map(
    "a map",
    "An image of opacity.",
    &[Declaration::of_keys(keys! {
        /// `color` for the red channel, or `alpha`.
        "channels": word::<Channels>(), Says("color");
    })],
);

const OF_METAL: Kind = map(
    "a metal map",
    "An image with roughness in green and metalness in blue, which set the material.",
    &[Declaration::of_keys(keys! {
        /// Factor on the metallic share.
        "metallic": Number(Range::UNIT), Is(1.0);
        /// Factor on the roughness.
        "roughness": Number(Range::UNIT), Is(1.0);
    })],
);

impl Declared for Maps {
    const KEYS: &'static [Key] = keys! {
        /// Colours that multiply the material's emission.
        EMISSION_MAP: Object(&OF_COLORS);
        /// Green is the roughness and blue the metallic share. With the colour they determine
        /// `ks`, `kd`, `kr`, `specularexponent` and `specularcolor`.
        METAL_MAP: Object(&OF_METAL);
        /// The share of ambient light that arrives, in the red channel.
        OCCLUSION_MAP: Object(&WITH_STRENGTH);
        /// Normals in tangent space: red along u, green along v, blue along the surface normal; a
        /// value x stands for 2 x - 1.
        NORMAL_MAP: Object(&WITH_STRENGTH);
        /// The opacity, in the red channel or in alpha, which multiplies the material's.
        OPACITY_MAP: Object(&OF_OPACITY);
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let maps = Self {
            emission: texture_of(object, EMISSION_MAP, OF_COLORS, |texture, _| texture)?,
            metal: texture_of(object, METAL_MAP, OF_METAL, |texture, map| MetalMap {
                texture,
                metallic: map.read("metallic"),
                roughness: map.read("roughness"),
            })?,
            occlusion: texture_of(object, OCCLUSION_MAP, WITH_STRENGTH, StrengthMap::read)?,
            normal: texture_of(object, NORMAL_MAP, WITH_STRENGTH, StrengthMap::read)?,
            opacity: match texture_of(object, OPACITY_MAP, OF_OPACITY, |texture, map| TextureRef {
                channels: map.read("channels"),
                ..texture
            })? {
                None if blends(object) => alpha_of_texture(object)?,
                own => own,
            },
        };
        Ok((maps != Self::default()).then_some(maps))
    }

    fn write(&self, to: &mut Writer<'_>) {
        for (key, texture) in self.all() {
            to.object(key, |to| {
                to.image("file", &texture.look_up.source);
                to.put("encoding", texture.encoding);
                texture.look_up.write(to);
                if texture.channels != Channels::Color {
                    to.put("channels", texture.channels);
                }
                match (key, &self.metal, &self.occlusion, &self.normal) {
                    (METAL_MAP, Some(map), ..) => {
                        to.put("metallic", map.metallic);
                        to.put("roughness", map.roughness);
                    }
                    (OCCLUSION_MAP, _, Some(map), _) | (NORMAL_MAP, .., Some(map)) => {
                        to.put("strength", map.strength);
                    }
                    _ => {}
                }
            });
        }
    }
}

impl StrengthMap {
    fn read(texture: TextureRef, map: &Object<'_>) -> Self {
        Self { texture, strength: map.read("strength") }
    }
}

/// The map under a key, if it is given, with its own keys read by `read`.
fn texture_of<T>(
    object: &Object<'_>,
    key: &'static str,
    kind: Kind,
    read: impl FnOnce(TextureRef, &Object<'_>) -> T,
) -> Result<Option<T>> {
    let Some(cursor) = object.get(key) else { return Ok(None) };
    let map = cursor.object(kind)?;
    let path = existing_file(&map.need("file", IMAGE)?, IMAGE)?;
    let (encoding, look_up) = LookUp::read(&map, path)?;
    let (tint, channels) = (DVec3::ONE, Channels::Color);
    Ok(Some(read(TextureRef { look_up, encoding, tint, channels }, &map)))
}

/// The path of an existing file, joined to the scene file's folder; `what` describes it. Instead of
/// a file of another machine, the one of the same name beside the scene is taken.
pub(crate) fn existing_file(cursor: &Cursor<'_>, what: &str) -> Result<PathBuf> {
    let notes = cursor.notes();
    let text = cursor.text(what)?;
    let path = notes.resolve(text);
    if path.is_file() {
        return Ok(path);
    }
    let here = notes.resolve(&translated(text));
    if here.is_file() {
        cursor.warn("there is no such file here", &format!("{} is used", here.display()));
        return Ok(here);
    }
    let there = if path.is_dir() { "a folder, not a file," } else { "no file" };
    let message = format!("there is {there} at {}", path.display());
    let error = cursor.error_of(ErrorKind::Io, message);
    Err(error.remedy("relative paths start at the scene file's folder"))
}
