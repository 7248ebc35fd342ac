//! Materials and textures.

use std::path::PathBuf;

use crate::components::{CutOut, Material, TextureRef, TextureSource};
use crate::reader::{Cursor, Key, Kind, Object, Range, keys};
use wavecrest_base::error::{ErrorKind, Result};

/// Exponents of the highlight. At a million it is a fraction of a pixel wide.
const EXPONENT: Range = Range::new(0.0, 1e6);

pub(crate) const MATERIAL: Kind =
    Kind::new("a material", "What a shape is made of, after Blinn and Phong.", &[KEYS]);

const KEYS: &[Key] = keys! {
    /// Weight of the highlight, 0 to 1.
    "ks": Number(Range::NOT_NEGATIVE), Required;
    /// Weight of the diffuse part, 0 to 1.
    "kd": Number(Range::NOT_NEGATIVE), Required;
    /// Sharpness of the highlight.
    "specularexponent": Number(EXPONENT), Required;
    /// Colour of the diffuse part, where no texture replaces it.
    "diffusecolor": Color, Required;
    /// Weight of the mirror ray, 0 to 1.
    "kr": Number(Range::NOT_NEGATIVE), Is(0.0);
    /// Light of its own, added where the surface is seen; it falls on nothing else.
    "emission": Color, Are([0.0; 3]);
};

/// Reads the `material` of a shape.
pub(super) fn material(cursor: &Cursor<'_>) -> Result<Material> {
    let object = cursor.object(MATERIAL)?;
    warn_of_gain(&object);
    Ok(Material {
        ks: object.number("ks")?,
        kd: object.number("kd")?,
        specular_exponent: object.number("specularexponent")?,
        diffuse_color: object.color("diffusecolor")?,
        kr: object.number("kr")?,
        emission: object.color("emission")?,
    })
}

/// Weights above 1 are allowed, but they are seldom meant. What is no number is left to the reading.
fn warn_of_gain(object: &Object<'_>) {
    let remedy = "it should be from 0 to 1";
    let message = "is above 1, so that the surface can return more light than it receives";
    for key in ["ks", "kd", "kr"] {
        if let Some(cursor) =
            object.get(key).filter(|c| c.value().as_f64().is_some_and(|x| x > 1.0))
        {
            cursor.warn(message, remedy);
        }
    }
    super::warn_above_1(object, "diffusecolor", message, remedy);
}

/// Reads the texture of a shape, with the keys that say how it is looked up.
pub(super) fn texture(object: &Object<'_>) -> Result<Option<TextureRef>> {
    let filter = object.word("filter")?;
    let wrap = object.word("wrap")?;
    let encoding = object.word("encoding")?;
    let tint = object.color("tint")?;
    let Some(cursor) = object.get("texture") else {
        warn_without_texture(object);
        return Ok(None);
    };
    let path = existing_file(&cursor, "the path of an image")?;
    Ok(Some(TextureRef { source: TextureSource::File(path), encoding, tint, filter, wrap }))
}

/// The threshold of an `alpha` for which none is given.
pub(crate) const THRESHOLD: f64 = 0.5;

/// Reads where a shape is cut out. An alpha of 0 and more is all there is.
pub(super) fn cutout(object: &Object<'_>, texture: Option<&TextureRef>) -> Result<Option<CutOut>> {
    let threshold = object.number_or("alphacutoff", THRESHOLD)?;
    let (filter, wrap) = (object.word("filter")?, object.word("wrap")?);
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
            cursor.warn("does nothing without an image that has alpha", remedy);
            return Ok(None);
        }
    };
    Ok((threshold > 0.0).then_some(CutOut { source, is_mask, threshold, filter, wrap }))
}

fn warn_without_texture(object: &Object<'_>) {
    // Alpha is looked up as a texture is.
    let of_both: &[&str] = if object.get("alpha").is_some() { &[] } else { &["filter", "wrap"] };
    for cursor in ["encoding", "tint"].iter().chain(of_both).filter_map(|key| object.get(key)) {
        cursor.warn("does nothing without a texture", "add \"texture\", or remove it");
    }
}

/// The path of a file that is there, joined to the scene file's folder; `what` describes it.
pub(super) fn existing_file(cursor: &Cursor<'_>, what: &str) -> Result<PathBuf> {
    let path = cursor.notes().resolve(cursor.text(what)?);
    if path.is_file() {
        return Ok(path);
    }
    let there = if path.is_dir() { "a folder, not a file," } else { "no file" };
    let message = format!("there is {there} at {}", path.display());
    let error = cursor.error_of(ErrorKind::Io, message);
    Err(error.remedy("a relative path starts from the scene file's folder"))
}
