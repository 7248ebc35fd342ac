//! The memory of a file's images, from their headers: they are read in turn, and none is kept.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use serde_json::Value;

use super::container::{GLB_START, binary_start};
use super::survey::items;
use super::texture::is_mipmapped;
use super::uri::{self, Target};
use crate::components::{Filter, TextureSource};
use crate::format::{Cursor, Notes, Place};
use crate::systems::textures;

/// The textures of a material, with the key of the factor on their colours.
const TEXTURES: [(&str, &str); 5] = [
    ("/pbrMetallicRoughness/baseColorTexture", "/pbrMetallicRoughness/baseColorFactor"),
    ("/pbrMetallicRoughness/metallicRoughnessTexture", ""),
    ("/emissiveTexture", "/emissiveFactor"),
    ("/normalTexture", ""),
    ("/occlusionTexture", ""),
];

/// A decoded image: its number, and its use.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Use {
    /// A texture, with its factor.
    Texture(u64, String),
    /// The alpha of an image.
    Mask(u64),
}

/// For each image in use its bytes, and the additional bytes while it is decoded. Unreadable images
/// count as 0: the error is reported when the file is loaded.
pub(super) fn survey(value: &Value, notes: &Notes<'_>) -> Vec<[u64; 2]> {
    let mut uses: BTreeMap<Use, Filter> = BTreeMap::new();
    let primitives = items(value, "meshes").iter().flat_map(|mesh| items(mesh, "primitives"));
    for material in primitives.filter_map(|primitive| primitive["material"].as_u64()) {
        add(value, &value["materials"][material as usize], &mut uses);
    }
    let bytes = |(part, filter): (Use, Filter)| match part {
        Use::Texture(image, _) => Some(textures::survey(&source(value, image, notes)?, filter)),
        Use::Mask(image) => Some(textures::survey_mask(&source(value, image, notes)?)),
    };
    uses.into_iter().filter_map(bytes).collect()
}

/// Adds the visible images of a material.
fn add(value: &Value, material: &Value, uses: &mut BTreeMap<Use, Filter>) {
    let is_cut = material["alphaMode"].as_str().is_some_and(|mode| mode != "OPAQUE");
    for (slot, (texture, factor)) in TEXTURES.iter().enumerate() {
        let index = material.pointer(texture).and_then(|info| info["index"].as_u64());
        let Some(texture) = index.and_then(|index| value["textures"].get(index as usize)) else {
            continue;
        };
        let Some(image) = texture["source"].as_u64() else { continue };
        let sampler = texture["sampler"].as_u64();
        let sampler = sampler.and_then(|index| value["samplers"].get(index as usize));
        let filter = match sampler.is_some_and(is_mipmapped) {
            true => Filter::Trilinear,
            false => Filter::Bilinear,
        };
        let factor = material.pointer(factor).filter(|_| !factor.is_empty());
        let factor = factor.map_or_else(String::new, Value::to_string);
        let known = uses.entry(Use::Texture(image, factor)).or_insert(filter);
        if filter == Filter::Trilinear {
            *known = filter;
        }
        if slot == 0 && is_cut {
            uses.insert(Use::Mask(image), Filter::Bilinear);
        }
    }
}

/// The source of an image, with its bytes if it is in the file or in a buffer.
fn source(value: &Value, image: u64, notes: &Notes<'_>) -> Option<TextureSource> {
    let image = value["images"].get(image as usize)?;
    let embedded = |bytes: Vec<u8>| TextureSource::Embedded {
        place: "an image".to_owned(),
        bytes: bytes.into(),
    };
    match image["bufferView"].as_u64() {
        Some(view) => Some(embedded(view_bytes(value, view, notes)?)),
        None => Some(match target(&image["uri"], notes)? {
            Target::Bytes(bytes) => embedded(bytes),
            Target::File(path) => TextureSource::File(path),
        }),
    }
}

fn target(uri: &Value, notes: &Notes<'_>) -> Option<Target> {
    uri::target(&Cursor::new(uri, Place::Top, notes)).ok()
}

/// The bytes of a buffer view.
fn view_bytes(value: &Value, view: u64, notes: &Notes<'_>) -> Option<Vec<u8>> {
    let view = value["bufferViews"].get(view as usize)?;
    let buffer = value["buffers"].get(view["buffer"].as_u64()? as usize)?;
    let (start, length) = (view["byteOffset"].as_u64().unwrap_or(0), view["byteLength"].as_u64()?);
    match buffer.get("uri") {
        None => {
            let mut head = [0; GLB_START];
            File::open(notes.file()).ok()?.read_exact(&mut head).ok()?;
            part(notes.file(), binary_start(&head)?.checked_add(start)?, length)
        }
        Some(uri) => match target(uri, notes)? {
            Target::File(path) => part(&path, start, length),
            Target::Bytes(bytes) => {
                let end = start.checked_add(length)?;
                Some(bytes.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?)?.to_vec())
            }
        },
    }
}

/// `length` bytes of a regular file, or fewer at its end.
fn part(path: &Path, start: u64, length: u64) -> Option<Vec<u8>> {
    let mut file = path.is_file().then(|| File::open(path).ok())??;
    file.seek(SeekFrom::Start(start)).ok()?;
    let mut bytes = Vec::new();
    file.take(length).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}
