//! The textures of a surface that exist in the file.

use glam::DVec3;

use crate::components::{Encoding, Maps, TextureRef};
use crate::format::Notes;

use super::document::Document;
use super::material::Surface;
use super::texture::TextureInfo;

/// The textures of a surface whose images exist, and the one set of coordinates that they use.
pub(super) fn textures(
    document: &Document,
    surface: &Surface,
    notes: &Notes<'_>,
) -> (Option<TextureRef>, Maps, Option<u32>) {
    let mut set = None;
    let (color, maps) = surface.textures(|info, encoding, tint| {
        let texture = texture(document, info, encoding, tint, notes)?;
        if *set.get_or_insert(info.set) == info.set {
            return Some(texture);
        }
        let message = "a texture with another set of coordinates is left out";
        notes.note(
            "materials",
            message,
            "use one set of coordinates for all textures of a material",
        );
        None
    });
    (color, maps, set)
}

/// A texture of a surface, if its image exists.
fn texture(
    document: &Document,
    info: &TextureInfo,
    encoding: Encoding,
    tint: DVec3,
    notes: &Notes<'_>,
) -> Option<TextureRef> {
    let textures = &document.textures;
    let Some(image) = textures.image(info) else {
        let message = "the image of a texture cannot be read";
        notes.note("textures", message, "the texture is left out");
        return None;
    };
    if let Some(path) = textures.missing(image) {
        let message = format!("the image {} is missing", path.display());
        notes.note(&format!("images[{image}]"), &message, "the texture is left out");
        return None;
    }
    textures.reference(info, encoding, tint)
}
