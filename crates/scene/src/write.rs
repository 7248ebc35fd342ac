//! Writes a world of entities as a scene file, with its meshes and images beside it.
//!
//! A scene that is written and read again is the same to the last bit: numbers are written as the
//! shortest text that reads back to the same value, meshes as binary PLY, images as their original
//! bytes. A mesh without a file is written into the scene file itself.

mod mesh;

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use serde_json::Value;

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{check_replaceable, replace_file, write_error};

use crate::components::{Mesh, TextureSource};
use crate::folder::Folder;
use crate::format::Beside;
use crate::load::LoadedScene;
use crate::{query, scene_file};
pub(crate) use mesh::ply_header;
pub use mesh::write_ply;

/// Writes `scene` to the scene file `path`, with its meshes and images beside it. Returns the
/// files, the scene last. Existing files are replaced only if `replaces`.
///
/// # Errors
/// If a file exists already, is a file that the scene was read from, or cannot be written; or if an image is outside the folder of the file that the scene was
/// read from, unless it was read with [`allow_outside`](crate::load::LoadOptions::allow_outside).
pub fn write(scene: &LoadedScene, path: &Path, replaces: bool) -> Result<Vec<PathBuf>> {
    let mut beside = Beside::new(path);
    let value = scene_file::write(&scene.world, &mut beside)?;
    let Beside { meshes, images, .. } = beside;
    let names = meshes.iter().map(|(name, _)| name).chain(images.iter().map(|(name, _)| name));
    let mut all: Vec<PathBuf> = names.cloned().collect();
    all.push(path.to_owned());
    for file in &all {
        scene.check_apart(file)?;
        check_free(file, replaces)?;
    }
    images.iter().try_for_each(|(_, source)| check_source(source, &scene.folder))?;
    for (file, entity) in meshes {
        let mesh = scene.world.get::<&Mesh>(entity).map_err(|_| query::missing("Mesh"))?;
        replace_file(&file, |sink| write_ply(&mesh.data, sink).map_err(|e| write_error(&file, e)))?;
    }
    for (file, source) in images {
        replace_file(&file, |sink| {
            let copied = source.open().and_then(|mut content| io::copy(&mut content, sink));
            copied.map(drop).map_err(|e| copy_error(&source, &file, e))
        })?;
    }
    // Last, so that an existing scene file refers to existing files.
    write_json(&value, path)?;
    Ok(all)
}

/// Checks whether the file could currently be written, and exists only if it `replaces` another.
///
/// # Errors
/// If it cannot.
pub fn check_free(file: &Path, replaces: bool) -> Result<()> {
    if !replaces && file.symlink_metadata().is_ok() {
        let error = Error::new(ErrorKind::Usage, "the file exists already").in_file(file);
        return Err(error.remedy("choose another name, or use --force to replace it"));
    }
    check_replaceable(file)
}

/// Checks that an image may be copied, and is one.
fn check_source(source: &TextureSource, folder: &Folder) -> Result<()> {
    match source {
        TextureSource::File(path) if path.exists() && !folder.holds(path) => {
            let message = "the image is outside the folder of the file that is converted";
            let error = Error::new(ErrorKind::Usage, message).value(path.display());
            Err(error.remedy("copy it there, or allow others with --allow-outside"))
        }
        TextureSource::File(_) => Ok(()),
        TextureSource::Embedded { place, bytes } => match image::guess_format(bytes) {
            Ok(_) => Ok(()),
            Err(e) => {
                let message = format!("cannot tell the format of the image: {e}");
                Err(Error::new(ErrorKind::Texture, message).at(place).because(e))
            }
        },
    }
}

fn write_json(value: &Value, path: &Path) -> Result<()> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Error::new(ErrorKind::Io, format!("cannot write JSON: {e}")).because(e))?;
    replace_file(path, |sink| {
        sink.write_all(text.as_bytes())
            .and_then(|()| sink.write_all(b"\n"))
            .map_err(|e| write_error(path, e))
    })
}

fn copy_error(source: &TextureSource, file: &Path, error: io::Error) -> Error {
    match source.file() {
        None => write_error(file, error),
        Some(path) => {
            let message = format!("cannot copy {}: {error}", path.display());
            Error::new(ErrorKind::Io, message).in_file(file).because(error)
        }
    }
}
