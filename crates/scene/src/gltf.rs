//! glTF 2.0, as text (`.gltf`) and as one binary file (`.glb`), read into the same entities as a
//! scene file.
//!
//! Source: the Khronos Group's *glTF 2.0 Specification*, with the extensions that [`document`]
//! lists. The file's JSON is read member by member with the readers of scene files instead of a
//! crate's typed model, so that every error has its file, path, value and remedy. Every index and
//! every range of bytes is checked before it is used.
//!
//! A mesh that several nodes use is stored once for each pose: as a hidden shape with an instance for
//! each node. [`pose`] states where vertices are at rest.
//! A mesh that emits light is an area light, with a copy for each node. [`material`] and [`light`]
//! state how materials and units are converted; [`staging`](super::staging) adds a camera and
//! lights to files without them.

mod accessor;
mod buffer;
mod camera;
mod container;
mod document;
mod fields;
mod light;
mod material;
mod mesh;
mod node;
mod pose;
mod primitive;
mod scene;
mod spawn;
mod texture;
mod uri;

use std::path::Path;
use std::sync::Arc;

use hecs::World;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::read::open;

use super::format::{Notes, json};
use super::options::LoadOptions;
use buffer::Buffer;
use document::Document;
use fields::Fields;

/// Whether these first bytes of a file are those of a GLB file.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(&container::MAGIC)
}

/// The bytes of the file at `path`.
///
/// # Errors
/// If it is not a regular file, or cannot be read.
pub(super) fn read(path: &Path) -> Result<Vec<u8>> {
    let bytes = open(path).and_then(|_| std::fs::read(path));
    bytes.map_err(|error| Error::io("cannot read the scene", path, error))
}

/// The scene in the `bytes` of a file, whose buffers are read, and a description of the choices made
/// for the user.
///
/// # Errors
/// As [`super::load::load`].
pub(super) fn world(
    bytes: Vec<u8>,
    options: &LoadOptions,
    notes: &Notes<'_>,
) -> Result<(World, String)> {
    let path = notes.file();
    let (json, binary) = container::parts(&bytes).map_err(|e| e.in_file(path))?;
    let bytes = Arc::new(bytes);
    let binary = binary.map(|range| Buffer::part(bytes.clone(), range));
    let value = json::parse(text(&bytes[json], path)?, path)?;
    let top = Fields::top(&value, notes)?;
    let mut document = notes.whole(|| Document::read(&top, binary.as_ref()))?;
    if options.like_meshes {
        document.usual = document.usual.of_meshes();
    }
    document::remark(&top);
    // Data in the text is many times larger there than as bytes.
    drop(value);
    scene::world(&document, options, notes)
}

fn text<'b>(bytes: &'b [u8], path: &Path) -> Result<&'b str> {
    std::str::from_utf8(bytes).map_err(|e| {
        let message = format!("the JSON is not UTF-8 text from byte {} on", e.valid_up_to());
        let error = Error::new(ErrorKind::Syntax, message).in_file(path);
        error.remedy("export the file again").because(e)
    })
}
