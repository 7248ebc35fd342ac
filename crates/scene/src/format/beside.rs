//! The files beside a scene file: meshes and images.

use std::path::{Path, PathBuf};

use hecs::Entity;

use crate::components::TextureSource;

/// The files beside a scene file, with its name as prefix.
#[derive(Default)]
pub(crate) struct Beside {
    scene: PathBuf,
    /// The entities whose meshes are to be written.
    pub(crate) meshes: Vec<(PathBuf, Entity)>,
    pub(crate) images: Vec<(PathBuf, TextureSource)>,
}

impl Beside {
    pub(crate) fn new(scene: &Path) -> Self {
        Self { scene: scene.to_owned(), ..Self::default() }
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
    pub(super) fn image(&mut self, source: &TextureSource) -> String {
        if let Some((path, _)) = self.images.iter().find(|(_, known)| known == source) {
            return path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        }
        let extension = match source {
            TextureSource::File(path) => path.extension().unwrap_or_default().to_string_lossy(),
            TextureSource::Embedded { bytes, .. } => {
                let format = image::guess_format(bytes).ok();
                let extension = format.and_then(|format| format.extensions_str().first().copied());
                extension.unwrap_or("image").into()
            }
        };
        let (name, path) = self.name(&format!("image{}.{extension}", self.images.len()));
        self.images.push((path, source.clone()));
        name
    }
}
