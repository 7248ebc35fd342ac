//! Textures and their look-up keys.

use std::path::PathBuf;

use glam::DVec3;

use crate::components::{CutOut, Maps, MetalMap, Placing, StrengthMap, TextureRef, TextureSource};
use crate::folder::translated;
use crate::reader::{Cursor, Key, Kind, Object, Range, keys};
use wavecrest_base::error::{ErrorKind, Result};

/// A texture of the light that a surface gives off.
pub(crate) const COLOR_MAP: Kind = Kind::new("a map", "An image of colours.", &[KEYS]);

/// A texture with a strength.
pub(crate) const STRENGTH_MAP: Kind =
    Kind::new("a map", "An image of numbers, and its strength.", &[KEYS, STRENGTH_KEYS]);

/// A texture of metal and roughness.
pub(crate) const METAL_MAP: Kind = Kind::new(
    "a metal map",
    "An image with roughness in green and metalness in blue, which set the material.",
    &[KEYS, METAL_KEYS],
);

const KEYS: &[Key] = keys! {
    /// The image: a path from the scene's folder.
    "file": Text, Required;
    /// Filtering between texels.
    "filter": word::<crate::components::Filter>(), Says("bilinear");
    /// Wrap mode of coordinates outside 0 to 1.
    "wrap": word::<crate::components::Wrap>(), Says("repeat");
    /// Encoding of the image's values.
    "encoding": word::<crate::components::Encoding>(), Says("linear");
    /// Transform of the texture coordinates before the look-up: two rows that act on [u, v, 1].
    "uvtransform": Definition("uvtransform");
};

const STRENGTH_KEYS: &[Key] = keys! {
    /// Strength of the map.
    "strength": Number(Range::COORDINATE), Is(1.0);
};

const METAL_KEYS: &[Key] = keys! {
    /// Factor on the metalness.
    "metallic": Number(Range::UNIT), Is(1.0);
    /// Factor on the roughness.
    "roughness": Number(Range::UNIT), Is(1.0);
};

/// Reads the texture of a shape, with its look-up keys.
pub(super) fn texture(object: &Object<'_>) -> Result<Option<TextureRef>> {
    let tint = object.color("tint");
    let Some(cursor) = object.get("texture") else {
        warn_without_texture(object);
        return Ok(None);
    };
    let path = existing_file(&cursor, "the path of an image")?;
    Ok(Some(TextureRef { tint, ..reference(object, path)? }))
}

/// The image at `path`, with the look-up keys of the object.
fn reference(object: &Object<'_>, path: PathBuf) -> Result<TextureRef> {
    Ok(TextureRef {
        source: TextureSource::File(path),
        encoding: object.word("encoding"),
        tint: DVec3::ONE,
        filter: object.word("filter"),
        wrap: object.word("wrap"),
        placing: object.get("uvtransform").map(|cursor| placing(&cursor)).transpose()?,
    })
}

/// The default threshold with an `alpha`.
pub(crate) const THRESHOLD: f64 = 0.5;

/// Reads the cut-out of a shape. A threshold of 0 cuts nothing out.
pub(super) fn cutout(object: &Object<'_>, texture: Option<&TextureRef>) -> Result<Option<CutOut>> {
    let threshold = object.number_or("alphacutoff", THRESHOLD);
    let (filter, wrap) = (object.word("filter"), object.word("wrap"));
    let placing = object.get("uvtransform").map(|cursor| placing(&cursor)).transpose()?;
    let mask = match object.get("alpha") {
        Some(cursor) => Some(TextureSource::File(existing_file(&cursor, "the path of an image")?)),
        None => None,
    };
    let is_mask = mask.is_some();
    let given = object.get("alphacutoff");
    let source = match (mask, texture, given) {
        (Some(mask), ..) => mask,
        (None, _, None) => return Ok(None),
        (None, Some(texture), Some(_)) => texture.source.clone(),
        (None, None, Some(cursor)) => {
            let remedy = "add \"texture\" or \"alpha\", or remove it";
            cursor.warn("has no effect without an image with alpha", remedy);
            return Ok(None);
        }
    };
    Ok((threshold > 0.0).then_some(CutOut { source, is_mask, threshold, filter, wrap, placing }))
}

fn warn_without_texture(object: &Object<'_>) {
    // Alpha is looked up like a texture.
    let of_both: &[&str] =
        if object.get("alpha").is_some() { &[] } else { &["filter", "wrap", "uvtransform"] };
    for cursor in ["encoding", "tint"].iter().chain(of_both).filter_map(|key| object.get(key)) {
        cursor.warn("has no effect without a texture", "add \"texture\", or remove it");
    }
}

fn placing(cursor: &Cursor<'_>) -> Result<Placing> {
    let what = "two rows of three numbers, [[a, b, c], [d, e, f]]";
    let rows = cursor.each(what, |row| row.numbers::<3>(what, Range::COORDINATE))?;
    let rows = rows.try_into().map_err(|_| cursor.error(format!("must be {what}")))?;
    Ok(Placing(rows))
}

/// Reads the maps of a shape.
pub(super) fn maps(object: &Object<'_>) -> Result<Maps> {
    let read = |key: &'static str, kind: Kind| -> Result<Option<(Object<'_>, TextureRef)>> {
        let Some(cursor) = object.get(key) else { return Ok(None) };
        let map = cursor.object(kind)?;
        let file =
            existing_file(&map.need("file", "the path of an image")?, "the path of an image")?;
        let texture = reference(&map, file)?;
        Ok(Some((map, texture)))
    };
    let with_strength = |key| {
        let Some((map, texture)) = read(key, STRENGTH_MAP)? else { return Ok(None) };
        Ok(Some(StrengthMap { texture, strength: map.number("strength") }))
    };
    let metal = |(map, texture): (Object<'_>, TextureRef)| -> Result<MetalMap> {
        let (metallic, roughness) = (map.number("metallic"), map.number("roughness"));
        Ok(MetalMap { texture, metallic, roughness })
    };
    Ok(Maps {
        emission: read("emissionmap", COLOR_MAP)?.map(|(_, texture)| texture),
        metal: read("metalmap", METAL_MAP)?.map(metal).transpose()?,
        occlusion: with_strength("occlusionmap")?,
        normal: with_strength("normalmap")?,
    })
}

/// The path of an existing file, joined to the scene file's folder; `what` describes it. Instead of
/// a file of another machine, the one of the same name beside the scene is taken.
pub(super) fn existing_file(cursor: &Cursor<'_>, what: &str) -> Result<PathBuf> {
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
