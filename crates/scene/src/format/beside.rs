//! The files beside a scene file: meshes and images.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use hecs::Entity;

use crate::components::TextureSource;
use crate::folder::Folder;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The files beside a scene file, with its name as prefix.
pub(crate) struct Beside {
    scene: PathBuf,
    /// The folder from which images may be copied.
    folder: Folder,
    pub(crate) meshes: Vec<(PathBuf, Entity)>,
    pub(crate) images: Vec<(PathBuf, TextureSource)>,
    /// The names of images, by their original path or place.
    known: HashMap<(PathBuf, bool), String>,
}

impl Beside {
    pub(crate) fn new(scene: &Path, folder: Folder) -> Self {
        Self {
            scene: scene.to_owned(),
            folder,
            meshes: Vec::new(),
            images: Vec::new(),
            known: HashMap::new(),
        }
    }

    /// A file name beside the scene file, and its path.
    fn name(&self, ending: &str) -> (String, PathBuf) {
        let stem = self.scene.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!("{stem}-{ending}");
        let path = self.scene.with_file_name(&name);
        (name, path)
    }

    /// Queues the mesh of an entity to be written; returns its name.
    pub(super) fn mesh(&mut self, entity: Entity) -> String {
        let (name, path) = self.name(&format!("mesh{}.ply", self.meshes.len()));
        self.meshes.push((path, entity));
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
