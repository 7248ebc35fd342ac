//! Materials and textures.

use std::path::PathBuf;

use glam::DVec3;

use crate::components::{Encoding, Filter, Material, TextureRef, TextureSource, Wrap};
use crate::reader::{Cursor, Object, Range};
use wavecrest_base::error::{ErrorKind, Result};

pub(super) const KEYS: [&str; 5] = ["ks", "kd", "specularexponent", "diffusecolor", "kr"];

/// Exponents of the highlight. At a million it is a fraction of a pixel wide.
pub(super) const EXPONENT: Range = Range::new(0.0, 1e6);

pub(super) const FILTERS: [(&str, Filter); 3] = [
    ("nearest", Filter::Nearest),
    ("bilinear", Filter::Bilinear),
    ("trilinear", Filter::Trilinear),
];
pub(super) const WRAPS: [(&str, Wrap); 2] = [("repeat", Wrap::Repeat), ("clamp", Wrap::Clamp)];
/// What numbers of colours stand for, by name.
pub(super) const ENCODINGS: [(&str, Encoding); 2] =
    [("linear", Encoding::Linear), ("srgb", Encoding::Srgb)];

/// Reads the `material` of a shape.
pub(super) fn material(cursor: &Cursor<'_>) -> Result<Material> {
    let object = cursor.object("a material", KEYS.into())?;
    warn_above_1(&object);
    Ok(Material {
        ks: object.number("ks", Range::NOT_NEGATIVE)?,
        kd: object.number("kd", Range::NOT_NEGATIVE)?,
        specular_exponent: object.number("specularexponent", EXPONENT)?,
        diffuse_color: object.color("diffusecolor")?,
        kr: object.number_or("kr", Range::NOT_NEGATIVE, 0.0)?,
    })
}

/// Weights above 1 are allowed, but they are seldom meant. What is no number is left to the reading.
fn warn_above_1(object: &Object<'_>) {
    let remedy = "it should be from 0 to 1";
    let message = "is above 1, so that the surface can return more light than it receives";
    for key in ["ks", "kd", "kr"] {
        if let Some(cursor) =
            object.get(key).filter(|c| c.value().as_f64().is_some_and(|x| x > 1.0))
        {
            cursor.warn(message, remedy);
        }
    }
    if let Some(cursor) = object.get("diffusecolor")
        && cursor.color().is_ok_and(|color| color.max_element() > 1.0)
    {
        cursor.warn(message, remedy);
    }
}

/// Reads the texture of a shape, with the keys that say how it is looked up.
pub(super) fn texture(object: &Object<'_>) -> Result<Option<TextureRef>> {
    let filter = object.choice_or("filter", &FILTERS, Filter::default())?;
    let wrap = object.choice_or("wrap", &WRAPS, Wrap::default())?;
    let encoding = object.choice_or("encoding", &ENCODINGS, Encoding::default())?;
    let tint = object.get("tint").map_or(Ok(DVec3::ONE), |cursor| cursor.color())?;
    let Some(cursor) = object.get("texture") else {
        warn_without_texture(object);
        return Ok(None);
    };
    let path = existing_file(&cursor, "the path of an image")?;
    Ok(Some(TextureRef { source: TextureSource::File(path), encoding, tint, filter, wrap }))
}

fn warn_without_texture(object: &Object<'_>) {
    for cursor in
        ["filter", "wrap", "encoding", "tint"].into_iter().filter_map(|key| object.get(key))
    {
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
