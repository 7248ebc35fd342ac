//! From a world of entities to a scene file, with its meshes and images beside it.
//!
//! A scene that is written and read again is the same to the last bit: numbers are written as the shortest
//! text that reads back as the same, meshes as binary PLY, images as the bytes that they were. It has what
//! glTF files and meshes alone are made into, and no more: spheres, planes and lenses come from scene files
//! alone, which need no conversion.

mod json;
mod mesh;

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use serde_json::Value;

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{check_replaceable, replace_file, write_error};

use super::components::{TextureRef, TextureSource};
use super::load::LoadedScene;
use super::mesh::MeshData;

/// Writes `scene` to the scene file `path`, with its meshes and images beside it. Returns the files, the
/// scene last. Files that are there already are replaced only where `replaces` says so.
///
/// # Errors
/// When a file is there already, or cannot be written.
pub fn write(scene: LoadedScene, path: &Path, replaces: bool) -> Result<Vec<PathBuf>> {
    let mut beside = Beside::new(path);
    let mut world = scene.world;
    let value = json::scene(&mut world, scene.encoding, &mut beside)?;
    let Beside { meshes, images, .. } = beside;
    let names = meshes.iter().map(|(name, _)| name).chain(images.iter().map(|(name, _)| name));
    let mut all: Vec<PathBuf> = names.cloned().collect();
    all.push(path.to_owned());
    for file in &all {
        check_free(file, replaces)?;
    }
    for (file, data) in meshes {
        replace_file(&file, |sink| mesh::write(&data, sink).map_err(|e| write_error(&file, e)))?;
    }
    for (file, source) in images {
        replace_file(&file, |sink| copy(&source, sink).map_err(|e| copy_error(&source, &file, e)))?;
    }
    // Last, so that a scene file that is there names files that are there.
    write_json(&value, path)?;
    Ok(all)
}

fn check_free(file: &Path, replaces: bool) -> Result<()> {
    if !replaces && file.symlink_metadata().is_ok() {
        let error = Error::new(ErrorKind::Usage, "the file is there already").in_file(file);
        return Err(
            error.remedy("write to another name, or allow that it is replaced with --force")
        );
    }
    check_replaceable(file)
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

fn copy(source: &TextureSource, sink: &mut impl io::Write) -> io::Result<()> {
    match source {
        TextureSource::Embedded { bytes, .. } => sink.write_all(bytes),
        TextureSource::File(path) => io::copy(&mut File::open(path)?, sink).map(drop),
    }
}

fn copy_error(source: &TextureSource, file: &Path, error: io::Error) -> Error {
    match source {
        TextureSource::Embedded { .. } => write_error(file, error),
        TextureSource::File(path) => {
            let message = format!("cannot copy {}: {error}", path.display());
            Error::new(ErrorKind::Io, message).in_file(file).because(error)
        }
    }
}

/// The files beside a scene file, which bear its name.
struct Beside<'a> {
    scene: &'a Path,
    meshes: Vec<(PathBuf, MeshData)>,
    images: Vec<(PathBuf, TextureSource)>,
    /// The names of images, by their own path or place.
    known: HashMap<(PathBuf, bool), String>,
}

impl<'a> Beside<'a> {
    fn new(scene: &'a Path) -> Self {
        Self { scene, meshes: Vec::new(), images: Vec::new(), known: HashMap::new() }
    }

    /// A name beside the scene file, and the path that it leads to.
    fn name(&self, ending: &str) -> (String, PathBuf) {
        let stem = self.scene.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!("{stem}-{ending}");
        let path = self.scene.with_file_name(&name);
        (name, path)
    }

    /// Has a mesh written; returns its name.
    fn mesh(&mut self, data: MeshData) -> String {
        let (name, path) = self.name(&format!("mesh{}.ply", self.meshes.len()));
        self.meshes.push((path, data));
        name
    }

    /// Has an image written, once; returns its name.
    fn image(&mut self, texture: &TextureRef) -> Result<String> {
        let (key, extension) = match &texture.source {
            TextureSource::File(path) => {
                let extension = path.extension().unwrap_or_default().to_string_lossy();
                ((path.clone(), false), extension.into_owned())
            }
            TextureSource::Embedded { place, bytes } => {
                let format = image::guess_format(bytes).map_err(|e| {
                    let message = format!("cannot tell the format of the image: {e}");
                    Error::new(ErrorKind::Texture, message).at(place).because(e)
                })?;
                let extension = format.extensions_str().first().copied().unwrap_or("image");
                ((place.into(), true), extension.to_owned())
            }
        };
        if let Some(name) = self.known.get(&key) {
            return Ok(name.clone());
        }
        let (name, path) = self.name(&format!("image{}.{extension}", self.images.len()));
        self.images.push((path, texture.source.clone()));
        self.known.insert(key, name.clone());
        Ok(name)
    }
}
