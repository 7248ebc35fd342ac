//! The files beside a scene file: meshes and images.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::components::TextureSource;
use crate::folder::Folder;
use crate::mesh::MeshData;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The files beside a scene file, with its name as prefix.
pub(super) struct Beside<'a> {
    scene: &'a Path,
    /// The folder from which images may be copied.
    folder: Folder,
    pub(super) meshes: Vec<(PathBuf, MeshData)>,
    pub(super) images: Vec<(PathBuf, TextureSource)>,
    /// The names of images, by their original path or place.
    known: HashMap<(PathBuf, bool), String>,
}

impl<'a> Beside<'a> {
    pub(super) fn new(scene: &'a Path, folder: Folder) -> Self {
        Self { scene, folder, meshes: Vec::new(), images: Vec::new(), known: HashMap::new() }
    }

    /// A file name beside the scene file, and its path.
    fn name(&self, ending: &str) -> (String, PathBuf) {
        let stem = self.scene.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!("{stem}-{ending}");
        let path = self.scene.with_file_name(&name);
        (name, path)
    }

    /// Queues a mesh to be written; returns its name.
    pub(super) fn mesh(&mut self, data: MeshData) -> String {
        let (name, path) = self.name(&format!("mesh{}.ply", self.meshes.len()));
        self.meshes.push((path, data));
        name
    }

    /// Queues an image to be written, once; returns its name.
    pub(super) fn image(&mut self, source: &TextureSource) -> Result<String> {
        let (key, extension) = match source {
            TextureSource::File(path) => {
                if path.exists() && !self.folder.holds(path) {
                    return Err(outside(path));
                }
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
        self.images.push((path, source.clone()));
        self.known.insert(key, name.clone());
        Ok(name)
    }
}

fn outside(image: &Path) -> Error {
    let message = "the image is outside the folder of the file that is converted";
    let error = Error::new(ErrorKind::Usage, message).value(image.display());
    error.remedy("copy it there, or allow others with --allow-outside")
}
