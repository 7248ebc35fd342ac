//! glTF 2.0, as text (`.gltf`) and as one binary file (`.glb`), read into the same entities as a
//! scene file.
//!
//! Source: the Khronos Group's *glTF 2.0 Specification*, with the extensions that [`document`]
//! lists. The file's JSON is read member by member with the readers of scene files instead of a
//! crate's typed model, so that every error has its file, path, value and remedy. Every index and
//! every range of bytes is checked before it is used.
//!
//! A mesh that several nodes use is stored once: as a hidden shape with an instance for each node.
//! A mesh that emits light is an area light, with a copy for each node. [`material`] and [`light`]
//! state how materials and units are converted; [`staging`](super::load::staging) adds a camera and
//! lights to files without them.

mod accessor;
mod buffer;
mod camera;
mod container;
mod document;
mod fields;
mod images;
mod instancing;
mod light;
mod material;
mod mesh;
mod node;
mod primitive;
mod scene;
mod spawn;
mod survey;
mod texture;
mod textured;
mod uri;

use std::path::Path;
use std::sync::Arc;

use wavecrest_base::error::{Error, ErrorKind, Result};

use super::format::{Cursor, Place, json};
use super::load::{LoadOptions, LoadedScene, loaded, notes};
use buffer::Buffer;
use document::Document;
use fields::Fields;

pub(super) use survey::survey;

/// Whether these first bytes of a file are those of a GLB file.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(&container::MAGIC)
}

/// Reads the file at `path` and its buffers.
///
/// # Errors
/// As [`super::load::load`].
pub(super) fn load(path: &Path, options: &LoadOptions) -> Result<LoadedScene> {
    let metadata = path.metadata().map_err(|e| Error::io("cannot read the scene", path, e))?;
    if !metadata.is_file() {
        let error = Error::new(ErrorKind::Io, "not a regular file").in_file(path);
        return Err(error.remedy("use a glTF file"));
    }
    let bytes = std::fs::read(path).map_err(|e| Error::io("cannot read the scene", path, e))?;
    load_bytes(bytes, path, options)
}

/// As [`load`], for a file with these `bytes`. Relative names start from the folder of `path`.
///
/// # Errors
/// As [`load`].
#[doc(hidden)]
pub fn load_bytes(bytes: Vec<u8>, path: &Path, options: &LoadOptions) -> Result<LoadedScene> {
    let parts = container::parts(&bytes).map_err(|e| e.in_file(path))?;
    let bytes = Arc::new(bytes);
    let binary = parts.binary.map(|range| Buffer::part(bytes.clone(), range));
    let value = json::parse(text(&bytes[parts.json], path)?, path)?;
    let notes = notes(path, options);
    let top = Fields::new(Cursor::new(&value, Place::Top, &notes), "a glTF file")?;
    let document = notes.whole(|| Document::read(&top, binary.as_ref()))?;
    document::remark(&top);
    // Data in the text is many times larger there than as bytes.
    drop(value);
    let (world, told) = scene::world(&document, options, &notes)?;
    drop(document);
    loaded(world, notes, Some(told), crate::mesh::load)
}

fn text<'b>(bytes: &'b [u8], path: &Path) -> Result<&'b str> {
    std::str::from_utf8(bytes).map_err(|e| {
        let message = format!("the JSON is not UTF-8 text from byte {} on", e.valid_up_to());
        let error = Error::new(ErrorKind::Syntax, message).in_file(path);
        error.remedy("export the file again").because(e)
    })
}
