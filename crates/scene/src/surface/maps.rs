//! Maps: textures of properties other than the diffuse colour.

use super::textures::{Channels, Encoding, IMAGE, LOOK_UP, TextureRef, blends, existing_image};
use crate::format::{Declaration, Declared, Key, Kind, Object, Range, Writer, keys};
use wavecrest_base::error::Result;

/// The keys of [`Maps`].
pub(crate) const EMISSION_MAP: &str = "emissionmap";
pub(crate) const METAL_MAP: &str = "metalmap";
pub(crate) const OCCLUSION_MAP: &str = "occlusionmap";
const NORMAL_MAP: &str = "normalmap";
pub(crate) const OPACITY_MAP: &str = "opacitymap";

/// Textures of properties other than the diffuse colour. None is tinted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Maps {
    /// Multiplies the material's emission.
    pub emission: Option<Map>,
    /// Metalness, in blue, and roughness, in green, which determine the rest of the material together
    /// with the colour.
    pub metal: Option<Map>,
    /// The share of ambient light that arrives, in the red channel.
    pub occlusion: Option<Map>,
    /// Normals: red along u, green along v, blue along the surface normal; a value x stands for 2 x
    /// - 1.
    pub normal: Option<Map>,
    /// Multiplies the opacity, in the red channel.
    pub opacity: Option<Map>,
}

impl Maps {
    pub(crate) const NONE: Self =
        Self { emission: None, metal: None, occlusion: None, normal: None, opacity: None };

    /// The maps that are set, with their keys in a scene file.
    pub fn all(&self) -> impl Iterator<Item = (&'static str, &Map)> {
        let Self { emission, metal, occlusion, normal, opacity } = self;
        let all = [
            (EMISSION_MAP, emission),
            (METAL_MAP, metal),
            (OCCLUSION_MAP, occlusion),
            (NORMAL_MAP, normal),
            (OPACITY_MAP, opacity),
        ];
        all.into_iter().filter_map(|(key, map)| Some((key, map.as_ref()?)))
    }

    /// As [`Maps::all`], mutable.
    pub fn all_mut(&mut self) -> impl Iterator<Item = &mut Map> {
        let Self { emission, metal, occlusion, normal, opacity } = self;
        [emission, metal, occlusion, normal, opacity].into_iter().flatten()
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

/// A texture with factors, of which each kind of map has its own; the others are 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The texture; `None` if every texel is 1, for metal alone.
    pub texture: Option<TextureRef>,
    /// Of ambient light and of normals: 0 for no effect, 1 for the full effect.
    pub strength: f64,
    /// Factor on the metalness, 0 to 1.
    pub metallic: f64,
    /// Factor on the roughness, 0 to 1.
    pub roughness: f64,
}

impl From<TextureRef> for Map {
    fn from(texture: TextureRef) -> Self {
        Self { texture: Some(texture), strength: 1.0, metallic: 1.0, roughness: 1.0 }
    }
}

impl Map {
    /// Whether all texels give the same material.
    pub(crate) fn is_constant(&self) -> bool {
        [self.metallic, self.roughness].iter().all(|&factor| factor as f32 == 0.0)
    }

    /// Whether the texture changes anything.
    pub(crate) fn has_effect(&self) -> bool {
        self.strength as f32 != 0.0
    }

    /// The map under a key, if it is given.
    fn read(object: &Object<'_>, key: &'static str) -> Result<Option<Self>> {
        let Some(cursor) = object.get(key) else { return Ok(None) };
        let map = cursor.object(*kind(key))?;
        let channels = map.read_or("channels", Some(Channels::Color));
        let texture = |file| Ok(TextureRef { channels, ..TextureRef::plain(&map, file)? });
        let texture = match map.get("file") {
            None if key == METAL_MAP => None,
            _ => existing_image(&map.need("file", IMAGE)?)?.map(texture).transpose()?,
        };
        if texture.is_none() && key != METAL_MAP {
            return Ok(None);
        }
        let factor = |key| map.read_or(key, Some(1.0));
        Ok(Some(Self {
            texture,
            strength: factor("strength"),
            metallic: factor("metallic"),
            roughness: factor("roughness"),
        }))
    }

    /// Writes the map under a key.
    fn write(&self, key: &'static str, to: &mut Writer<'_>) {
        let Self { texture, strength, metallic, roughness } = self;
        to.object(key, |to| {
            if let Some(TextureRef { look_up, encoding, channels, .. }) = texture {
                to.image("file", &look_up.source);
                to.put("encoding", *encoding);
                look_up.write(to);
                if *channels != Channels::Color {
                    to.put("channels", *channels);
                }
            }
            let factors =
                [("metallic", metallic), ("roughness", roughness), ("strength", strength)];
            for (name, factor) in factors {
                if kind(key).key(name).is_some() {
                    to.put(name, *factor);
                }
            }
        });
    }
}

/// The kind of the map under a key.
fn kind(key: &str) -> &'static Kind {
    match key {
        METAL_MAP => &OF_METAL,
        OCCLUSION_MAP | NORMAL_MAP => &WITH_STRENGTH,
        OPACITY_MAP => &OF_OPACITY,
        _ => &OF_COLORS,
    }
}

fn alpha_of_texture(object: &Object<'_>) -> Result<Option<Map>> {
    let Some(cursor) = object.get("texture") else {
        object.warn("alpha", "has no effect without a texture", "add \"texture\", or remove it");
        return Ok(None);
    };
    let Some(image) = existing_image(&cursor)? else { return Ok(None) };
    let texture = TextureRef::plain(object, image)?;
    let (encoding, channels) = (Encoding::Linear, Channels::Alpha);
    Ok(Some(TextureRef { encoding, channels, ..texture }.into()))
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

const OF_METAL: Kind = Kind {
    keys: keys! {
        /// The image: a path from the scene's folder. Without one the factors alone count.
        "file": Text;
    },
    ..map(
        "a metal map",
        "An image with roughness in green and metalness in blue, which set the material.",
        &[Declaration::of_keys(keys! {
            /// Factor on the metallic share.
            "metallic": Number(Range::UNIT), Is(1.0);
            /// Factor on the roughness.
            "roughness": Number(Range::UNIT), Is(1.0);
        })],
    )
};

impl Declared for Maps {
    const KEYS: &'static [Key] = keys! {
        /// Colours that multiply the material's emission.
        EMISSION_MAP: Object(&OF_COLORS);
        /// Green is the roughness and blue the metallic share. With the colour they determine
        /// `ks`, `kd`, `kr`, `ka`, `specularexponent` and `specularcolor` at each point.
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
        let map = |key| Map::read(object, key);
        let maps = Self {
            emission: map(EMISSION_MAP)?,
            metal: map(METAL_MAP)?,
            occlusion: map(OCCLUSION_MAP)?,
            normal: map(NORMAL_MAP)?,
            opacity: match map(OPACITY_MAP)? {
                None if blends(object) => alpha_of_texture(object)?,
                own => own,
            },
        };
        maps.warn_of_idle(object);
        Ok((maps != Self::default()).then_some(maps))
    }

    fn write(&self, to: &mut Writer<'_>) {
        self.all().for_each(|(key, map)| map.write(key, to));
    }
}
