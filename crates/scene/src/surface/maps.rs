//! Maps: textures of properties other than the diffuse colour.

use super::textures::{Channels, Encoding, IMAGE, LOOK_UP, TextureRef, blends, existing_file};
use crate::format::{Declaration, Declared, Key, Kind, Object, Range, Writer, keys};
use wavecrest_base::error::Result;

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

    /// Warns of images that something else keeps from having an effect.
    fn warn_of_idle(&self, object: &Object<'_>) {
        if self.opacity.is_some() && blends(object) && object.has(OPACITY_MAP) {
            object.warn("alpha", "has no effect with an opacity map", "remove one of them");
        }
        let material = self.emission.as_ref().and_then(|_| object.get("material"));
        if material.is_some_and(|material| material.value().get("emission").is_none()) {
            let remedy = "add \"emission\" to the material, or remove it";
            object.warn(EMISSION_MAP, "has no effect without emission", remedy);
        }
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

/// The alpha of the object's texture.
fn alpha_of_texture(object: &Object<'_>) -> Result<Option<TextureRef>> {
    let Some(cursor) = object.get("texture") else {
        object.warn("alpha", "has no effect without a texture", "add \"texture\", or remove it");
        return Ok(None);
    };
    let texture = TextureRef::plain(object, existing_file(&cursor, IMAGE)?)?;
    Ok(Some(TextureRef { encoding: Encoding::Linear, channels: Channels::Alpha, ..texture }))
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
        maps.warn_of_idle(object);
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
    Ok(Some(read(TextureRef::plain(&map, path)?, &map)))
}
